"""The page: one file that opens from disk, with everything in it and nothing fetched.

Pictures for paper stand in the page beside the data of the interactive graphs; a reader without
scripts, and a printer, sees the pictures. Every text is escaped by the template engine; the page's
own content policy forbids it to load anything.
"""

import json
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from harness.artefact import Prose, Replay
from harness.provenance import Provenance
from harness.report.cells import Grid, grid
from harness.report.chapter import Chapter
from harness.report.contents import Part, Picture, Report
from harness.report.interactive import description, packed, plotly_packed
from harness.report.legend import Entry, entries
from harness.report.naming import slug, slugs
from harness.report.palette import PAPER_DARK, PAPER_LIGHT, Ink
from harness.report.replaying import frames
from harness.report.stills import address

_TEMPLATES = Path(__file__).parent / "templates"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Drawing:
    """A figure as the template needs it."""

    name: str
    title: str
    seen: str
    columns: int
    panels: tuple[Mapping[str, Any], ...]
    described: tuple[Mapping[str, Any], ...]
    legend: tuple[Entry, ...]
    still: str
    cases: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Screen:
    """A replay as the template needs it."""

    name: str
    title: str
    seen: str
    bodies: tuple[tuple[str, str], ...]
    frames: int
    told: str
    described: Mapping[str, Any]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Section:
    """A section of the page with its anchor; what leads comes first."""

    anchor: str
    title: str
    leading_texts: Mapping[str, Prose]
    leading_grids: tuple[Grid, ...]
    screens: tuple[Screen, ...]
    drawings: tuple[Drawing, ...]
    grids: tuple[Grid, ...]
    texts: Mapping[str, Prose]


def page(report: Report) -> str:
    """Return the whole page as HTML."""
    anchors = slugs(part.title for part in report.parts)
    environment = Environment(
        loader=FileSystemLoader(_TEMPLATES),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.filters["paragraphs"] = _paragraphs
    environment.filters["slug"] = slug
    environment.filters["packed"] = lambda told: packed(json.dumps(told, separators=(",", ":")))
    return environment.get_template("index.html").render(
        title=report.title,
        opening=_section(report, report.opening, anchor="summary"),
        sections=[
            _section(report, part, anchor=f"part-{anchor}")
            for part, anchor in zip(report.parts, anchors, strict=True)
        ],
        cases=report.cases,
        provenance=_made(report.chapters, report.provenance),
        written=report.provenance.written,
        face=_face(report.inks),
        style=_asset("report.css"),
        script=_asset("report.js"),
        replays=_asset("replay.js") if any(part.replays for part in report.parts) else "",
        plotly=plotly_packed() if report.pictures else "",
        kinds={kind: f"--kind-{number}" for number, kind in enumerate(report.inks)},
    )


def _section(report: Report, part: Part, *, anchor: str) -> Section:
    digests = {str(case["digest"]) for case in report.cases if "digest" in case}
    return Section(
        anchor=anchor,
        title=part.title,
        leading_texts=part.leading_texts,
        leading_grids=tuple(grid(n, table, digests) for n, table in part.leading_tables.items()),
        screens=tuple(_screen(n, replay) for n, replay in part.replays.items()),
        drawings=tuple(
            replace(_drawing(n, report.pictures[n], report.inks, digests), title=figure.title)
            for n, figure in part.figures.items()
        ),
        grids=tuple(grid(n, table, digests) for n, table in part.tables.items()),
        texts=part.texts,
    )


def _screen(name: str, replay: Replay) -> Screen:
    names = ", ".join(body.label for body in replay.bodies)
    return Screen(
        name=name,
        title=replay.title,
        seen=replay.seen,
        bodies=tuple((body.label, body.kind) for body in replay.bodies),
        frames=len(replay.time),
        told=f"The can rolling, seen from above at a slant: {names}",
        described=frames(replay),
    )


def _drawing(
    name: str, picture: Picture, inks: Mapping[str, Ink], digests: Collection[str]
) -> Drawing:
    figure = picture.figure
    return Drawing(
        name=name,
        title=figure.title,
        seen=figure.seen,
        columns=max(1, min(figure.columns, len(figure.panels))),
        panels=tuple(
            {
                "title": panel.title,
                "told": f"{panel.title}: {panel.y_label} against {panel.x_label}",
                "equal": panel.equal,
            }
            for panel in figure.panels
        ),
        described=tuple(description(figure, inks)),
        legend=entries(figure),
        still=address(picture.printed.svg),
        cases=tuple(digest for digest in figure.cases if digest in digests),
    )


def _made(chapters: Sequence[Chapter], made: Provenance) -> list[tuple[str, list[tuple[str, str]]]]:
    """Return what made the page, and of each study what was another then."""
    own = _told(made)
    others = [
        (chapter.title, [term for term in _told(chapter.provenance) if term not in own])
        for chapter in chapters
    ]
    return [("This page", own), *((title, terms) for title, terms in others if terms)]


def _told(made: Provenance) -> list[tuple[str, str]]:
    """Return provenance as terms and what they are."""
    commit = "not run from a checkout"
    if made.commit is not None:
        commit = f"{made.commit.digest}{', with local changes' if made.commit.changed else ''}"
    return [
        ("written", made.written),
        ("rockingcan", made.rockingcan),
        ("commit", commit),
        ("python", made.python),
        *made.packages.items(),
        ("platform", made.platform),
        ("processor", f"{made.processor}, {made.cores} cores"),
    ]


def _paragraphs(text: str) -> list[str]:
    return [part.strip() for part in text.split("\n\n") if part.strip()]


def _face(inks: Mapping[str, Ink]) -> Markup:
    """Return the colours as style variables: for the light face, and for the dark one."""
    light = f"--paper:{PAPER_LIGHT};" + _variables(ink.light for ink in inks.values())
    dark = f"--paper:{PAPER_DARK};" + _variables(ink.dark for ink in inks.values())
    return Markup(  # noqa: S704 # colours of this package, no text of a user
        f":root{{{light}}}@media screen and (prefers-color-scheme:dark){{:root{{{dark}}}}}"
    )


def _variables(colours: Iterable[str]) -> str:
    return "".join(f"--kind-{number}:{colour};" for number, colour in enumerate(colours))


def _asset(name: str) -> Markup:
    """Return a script or a style of this package, for its element as it is."""
    return Markup((_TEMPLATES / name).read_text(encoding="utf-8"))  # noqa: S704
