"""The page: one file that opens from disk, with everything in it and nothing fetched.

A still picture of each panel stands beside the data of its interactive graph; a reader without
scripts, and a printer, sees the pictures. Every text is escaped by the template engine; the page's
own content policy forbids it to load anything.

A replay as the page plays it: arrays as coarse as a screen, as many as there are frames.
"""

import json
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from harness.core.provenance import Provenance
from harness.core.report_model import Replay
from harness.core.trajectory import Floats
from harness.report.layout import Report, Section
from harness.report.number_format import slug, slugs
from harness.report.plotly_renderer import description, packed, packed_array, plotly_packed
from harness.report.style import PAPER_DARK, PAPER_LIGHT, LineStyle, entries
from harness.report.svg_renderer import MARKS, stills
from harness.report.tables import grid


def frames(replay: Replay) -> dict[str, Any]:
    """Return a replay in JSON's own types.

    Returns
    -------
    dict
        Lengths in radii; angles and places in steps of 1/65535 of their range, a tenth of a pixel
        at most. phi in single precision, as its least value is where the bounce is; times in s, as
        doubles: frames in a bounce are nanoseconds apart.
    """
    middle = _middle(replay)
    return {
        "radius": replay.radius,
        "height": replay.height / replay.radius,
        "tilt": replay.tilt,
        "time": packed_array(replay.time, "f8"),
        "bodies": [
            {
                "kind": body.kind,
                "phi": packed_array(body.phi, "f4"),
                "psi": _stepped(body.psi),
                "theta": _stepped(body.theta),
                "x": _stepped((body.contact[:, 0] - middle[0]) / replay.radius),
                "y": _stepped((body.contact[:, 1] - middle[1]) / replay.radius),
                # of a can that stays on the plane it would be zeros
                **({"z": _stepped(body.height / replay.radius)} if body.height.any() else {}),
            }
            for body in replay.bodies
        ],
    }


def _middle(replay: Replay) -> Floats:
    """Return the middle of the first can's locus, from which positions are measured."""
    contact = replay.bodies[0].contact
    middle: Floats = (np.nanmin(contact, axis=0) + np.nanmax(contact, axis=0)) / 2.0
    return middle


_STEPS = 65535


def _stepped(values: Floats) -> dict[str, Any]:
    """Return numbers in two bytes each, of a range that has no gap; else in four."""
    if not np.isfinite(values).all():
        return packed_array(values, "f4")
    low, width = float(values.min()), float(np.ptp(values))
    step = width / _STEPS if width > 0.0 else 1.0
    return {**packed_array(np.rint((values - low) / step), "u2"), "low": low, "step": step}


_TEMPLATES = Path(__file__).parent / "templates"


def page(report: Report) -> str:
    """Return the whole page as HTML."""
    environment = Environment(
        loader=FileSystemLoader(_TEMPLATES),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.filters |= {
        "paragraphs": _paragraphs,
        "slug": slug,
        "packed": lambda value: packed(json.dumps(value, separators=(",", ":"))),
        "kind": lambda artefact: type(artefact).__name__.lower(),
    }
    digests = {str(case["digest"]) for case in report.cases if "digest" in case}
    colours = {kind: f"--kind-{number}" for number, kind in enumerate(report.inks)}
    environment.globals |= {
        "digests": digests,
        "kinds": colours,
        "marks": MARKS,
        "on_paper": report.on_paper,
        "undrawn": report.undrawn,
        "grid": lambda name, table: grid(name, table, digests),
        "entries": entries,
        "description": lambda figure: description(figure, report.inks),
        "stills": lambda figure: map(Markup, stills(figure, report.inks, colours)),
        "frames": frames,
    }
    replays = any(isinstance(a, Replay) for part in report.parts for a in part.rest.values())
    return environment.get_template("index.html").render(
        title=report.title,
        opening=report.opening,
        anchors=[f"part-{anchor}" for anchor in slugs(part.title for part in report.parts)],
        sections=report.parts,
        cases=report.cases,
        provenance=_provenance_terms(report.chapters, report.provenance),
        written=report.provenance.written,
        face=_face(report.inks),
        style=_asset("report.css"),
        script=_asset("report.js"),
        replays=_asset("replay.js") if replays else "",
        plotly=plotly_packed() if report.figures else "",
    )


Terms = list[tuple[str, str]]
"""Provenance as pairs of a term and its text."""


def _provenance_terms(
    chapters: Sequence[Section], provenance: Provenance
) -> list[tuple[str, Terms]]:
    """Return the provenance of the page, and of each study the terms in which it differs."""
    own = _terms(provenance)
    others = [
        (chapter.title, [term for term in _terms(chapter.provenance) if term not in own])
        for chapter in chapters
    ]
    return [("This page", own), *((title, terms) for title, terms in others if terms)]


def _terms(provenance: Provenance) -> Terms:
    """Return provenance as pairs of a term and its text."""
    commit = provenance.commit
    digest = "not run from a checkout"
    if commit is not None:
        digest = f"{commit.digest}{', with local changes' if commit.changed else ''}"
    return [
        ("written", provenance.written),
        ("rockingcan", provenance.rockingcan),
        ("commit", digest),
        ("python", provenance.python),
        *provenance.packages.items(),
        *((f"engine {name}", words) for name, words in provenance.environments.items()),
        ("platform", provenance.platform),
        ("processor", f"{provenance.processor}, {provenance.cores} cores"),
        ("exact bounce", provenance.reference),
    ]


def _paragraphs(text: str) -> list[str]:
    return [part.strip() for part in text.split("\n\n") if part.strip()]


def _face(inks: Mapping[str, LineStyle]) -> Markup:
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
