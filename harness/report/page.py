"""The page: one file that opens from disk, with everything in it and nothing fetched.

Pictures for paper stand in the page beside the data of the interactive graphs; a reader without
scripts, and a printer, sees the pictures. Every text is escaped by the template engine; the page's
own content policy forbids it to load anything.

A replay as the page plays it: arrays as coarse as a screen, as many as there are frames.

A picture for paper as an address that holds all of it, without what only makes it longer.

Percent signs take the place of base64, which makes a text a third longer. Of the picture itself
nothing is lost: line ends, names that nothing refers to, and what is said several times of how
things look are not seen.
"""

import base64
import json
import re
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any
from urllib.parse import quote

import numpy as np
from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from harness.core.provenance import Provenance
from harness.core.report_model import Replay
from harness.core.trajectory import Floats
from harness.report.layout import Report, Section
from harness.report.number_format import slug, slugs
from harness.report.plotly_renderer import description, packed, plotly_packed
from harness.report.style import PAPER_DARK, PAPER_LIGHT, LineStyle, entries
from harness.report.tables import grid


def frames(replay: Replay) -> dict[str, Any]:
    """Return a replay in what JSON can hold.

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
        "time": _packed(replay.time, "f8"),
        "bodies": [
            {
                "kind": body.kind,
                "phi": _packed(body.phi, "f4"),
                "psi": _stepped(body.psi),
                "theta": _stepped(body.theta),
                "x": _stepped((body.contact[:, 0] - middle[0]) / replay.radius),
                "y": _stepped((body.contact[:, 1] - middle[1]) / replay.radius),
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
        return _packed(values, "f4")
    low, width = float(values.min()), float(np.ptp(values))
    step = width / _STEPS if width > 0.0 else 1.0
    return {**_packed(np.rint((values - low) / step), "u2"), "low": low, "step": step}


def _packed(values: Floats, kind: str) -> dict[str, Any]:
    data = base64.b64encode(np.asarray(values).astype(f"<{kind}").tobytes()).decode("ascii")
    return {"dtype": kind, "bdata": data}


_HEADER = re.compile(r"<\?xml.*?\?>|<!DOCTYPE.*?>|<metadata>.*?</metadata>|<!--.*?-->", re.DOTALL)
_TAG = re.compile("<[^<>]*>")
_BETWEEN = re.compile(r">\s*\n\s*<")
_PATH = re.compile(r'(?<= d=")[^"]*')
_LETTER = re.compile(r"\s*([A-Za-z])\s*")
_STYLE = re.compile(r'(?<= style=")[^"]*')
_STYLE_SIGN = re.compile(r"([:;])\s+")
_NAME = re.compile(r' id="([^"]*)"')
_TICK = re.compile(r'<path id="([\w-]+)" d="M[-\d. ]+L[-\d. ]+" style="stroke:[^"]*"/>')
"""A line of two points, which has nothing to fill, with a colour and a width of its own."""

_LINK = re.compile(r'((?:href="|url\()#)([\w-]+)')
_WHOLE_STYLE = re.compile(r' style="([^"<>&]*)"')
_USE = re.compile(r'(<use xlink:href="#([\w-]+)"[^>]*?) style="[^"]*"')

_PLAIN = " !$()*+,-./:;=?@[]_|~"
"""Signs that need no escape, neither in an address nor in an attribute of HTML."""


def address(svg: str) -> str:
    """Return an SVG picture as the address of an image."""
    return f"data:image/svg+xml,{quote(_short(svg), safe=_PLAIN)}"


def _short(svg: str) -> str:
    """Return the same picture in fewer letters."""
    text = _BETWEEN.sub("><", _HEADER.sub("", svg).strip())
    text = _in_tags(_PATH, lambda found: _LETTER.sub(r"\1", found[0]).strip(), text)
    text = _in_tags(_STYLE, lambda found: _STYLE_SIGN.sub(r"\1", found[0]), text)
    named = {name for _, name in _LINK.findall(text)}
    text = _in_tags(_NAME, lambda found: found[0] if found[1] in named else "", text)
    ticks = set(_TICK.findall(text))
    text = _in_tags(_USE, lambda found: found[1] if found[2] in ticks else found[0], text)
    return _classed(_renamed(text, sorted(named)))


def _in_tags(pattern: re.Pattern[str], change: Callable[[re.Match[str]], str], text: str) -> str:
    """Return a text with its tags changed: the words of a figure may look like attributes."""
    return _TAG.sub(lambda tag: pattern.sub(change, tag[0]), text)


def _renamed(text: str, names: Sequence[str]) -> str:
    """Return a picture with names of a few letters."""
    brief = {name: f"n{number}" for number, name in enumerate(names)}
    text = _in_tags(_NAME, lambda found: f' id="{brief[found[1]]}"', text)
    return _in_tags(_LINK, lambda found: f"{found[1]}{brief[found[2]]}", text)


def _classed(text: str) -> str:
    """Return a picture that says only once what several of its elements look like."""
    styles = Counter(_WHOLE_STYLE.findall("".join(_TAG.findall(text))))
    classes = {style: f"c{n}" for n, style in enumerate(s for s, k in styles.items() if k > 1)}
    rules = "".join(f".{name}{{{style}}}" for style, name in classes.items())
    text = _in_tags(
        _WHOLE_STYLE,
        lambda found: f' class="{classes[found[1]]}"' if found[1] in classes else found[0],
        text,
    )
    return text.replace("</style>", f"{rules}</style>", 1)


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
        "packed": lambda told: packed(json.dumps(told, separators=(",", ":"))),
        "kind": lambda artefact: type(artefact).__name__.lower(),
    }
    digests = {str(case["digest"]) for case in report.cases if "digest" in case}
    environment.globals |= {
        "digests": digests,
        "kinds": {kind: f"--kind-{number}" for number, kind in enumerate(report.inks)},
        "grid": lambda name, table: grid(name, table, digests),
        "entries": entries,
        "description": lambda figure: description(figure, report.inks),
        "still": lambda name: address(report.pictures[name].svg),
        "frames": frames,
    }
    replays = any(isinstance(a, Replay) for part in report.parts for a in part.rest.values())
    return environment.get_template("index.html").render(
        title=report.title,
        opening=report.opening,
        anchors=[f"part-{anchor}" for anchor in slugs(part.title for part in report.parts)],
        sections=report.parts,
        cases=report.cases,
        provenance=_made(report.chapters, report.provenance),
        written=report.provenance.written,
        face=_face(report.inks),
        style=_asset("report.css"),
        script=_asset("report.js"),
        replays=_asset("replay.js") if replays else "",
        plotly=plotly_packed() if report.pictures else "",
    )


def _made(chapters: Sequence[Section], made: Provenance) -> list[tuple[str, list[tuple[str, str]]]]:
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
