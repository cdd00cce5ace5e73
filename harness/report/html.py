"""The page: one file that opens from disk, with everything in it and nothing fetched.

Pictures for paper stand in the page beside the data of the interactive graphs; a reader without
scripts, and a printer, sees the pictures. Every text is escaped by the template engine; the page's
own content policy forbids it to load anything.
"""

import base64
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from harness.artefact import Prose
from harness.provenance import Provenance
from harness.report.cells import Grid, grid
from harness.report.contents import Part, Picture, Report, headline, parts
from harness.report.interactive import description, plotly_packed
from harness.report.legend import Entry, entries
from harness.report.naming import slug, slugs
from harness.report.palette import PAPER_DARK, PAPER_LIGHT, Ink

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


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Section:
    """A section of the page with its anchor."""

    anchor: str
    title: str
    drawings: tuple[Drawing, ...]
    grids: tuple[Grid, ...]
    texts: Mapping[str, Prose]


def page(report: Report) -> str:
    """Return the whole page as HTML."""
    found = parts(report)
    anchors = slugs(part.scene or "all-scenes" for part in found)
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
    return environment.get_template("index.html").render(
        title=report.title,
        opening=_section(report, headline(report), anchor="summary", title="Summary"),
        sections=[
            _section(report, part, anchor=f"part-{anchor}", title=part.scene or "Over all scenes")
            for part, anchor in zip(found, anchors, strict=True)
        ],
        cases=report.cases,
        provenance=_told(report.provenance),
        written=report.provenance.written,
        face=_face(report.inks),
        style=_asset("report.css"),
        script=_asset("report.js"),
        plotly=plotly_packed() if report.figures else "",
        kinds={kind: f"--kind-{number}" for number, kind in enumerate(report.inks)},
    )


def _section(report: Report, part: Part, *, anchor: str, title: str) -> Section:
    digests = {str(case["digest"]) for case in report.cases if "digest" in case}
    return Section(
        anchor=anchor,
        title=title,
        drawings=tuple(_drawing(n, picture, report.inks) for n, picture in part.figures.items()),
        grids=tuple(grid(n, table, digests) for n, table in part.tables.items()),
        texts=part.texts,
    )


def _drawing(name: str, picture: Picture, inks: Mapping[str, Ink]) -> Drawing:
    figure = picture.figure
    still = base64.b64encode(picture.printed.svg.encode("utf-8")).decode("ascii")
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
        still=f"data:image/svg+xml;base64,{still}",
    )


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
