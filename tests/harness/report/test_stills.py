"""A picture in the page's own address is the picture that was drawn."""

import re
from collections.abc import Sequence
from urllib.parse import unquote
from xml.etree.ElementTree import Element, fromstring

import pytest

from harness.core.report_model import Artefact, Figure
from harness.report.matplotlib_renderer import address, render
from harness.report.style import palette

SVG = "{http://www.w3.org/2000/svg}"
LINK = "{http://www.w3.org/1999/xlink}href"


def drawn(figure: Figure) -> str:
    kinds = [series.kind for panel in figure.panels for series in panel.series]
    return render(figure, palette(kinds)).svg


def told(root: Element) -> list[tuple[str, dict[str, object], str]]:
    """Return every element with what it looks like, but for names, and the style of a tick."""
    ticks = {
        f"#{one.get('id')}"
        for one in root.iter(f"{SVG}path")
        if len(steps(one.get("d", ""))) == len("MxyLxy") and "fill" not in one.get("style", "")
    }
    rules = "".join(one.text or "" for one in root.iter(f"{SVG}style"))
    classes = dict(re.findall(r"\.(c\d+)\{([^}]*)\}", rules))
    return [
        (one.tag, dict(look(*pair, classes) for pair in said(one, ticks)), text)
        for one in root.iter()
        if one.tag.startswith(SVG) and one.tag not in {f"{SVG}metadata", f"{SVG}style"}
        for text in [(one.text or "").strip()]
    ]


def said(one: Element, ticks: set[str]) -> list[tuple[str, str]]:
    left_out = {"id", "clip-path", LINK} | ({"style", "class"} if one.get(LINK) in ticks else set())
    return [(name, value) for name, value in one.attrib.items() if name not in left_out]


def look(name: str, value: str, classes: dict[str, str]) -> tuple[str, object]:
    """Return an attribute without the freedom of how to write it."""
    if name in {"style", "class"}:
        parts = (classes[value] if name == "class" else value).split(";")
        return "style", [re.sub(r":\s+", ":", part.strip()) for part in parts if part.strip()]
    return name, steps(value) if name == "d" else value


def steps(path: str) -> Sequence[str]:
    found: Sequence[str] = re.findall(r"[A-Za-z]|-?[\d.]+", path)
    return found


@pytest.mark.slow
def test_nothing_is_lost_and_it_is_shorter_than_in_base64(
    artefacts: tuple[Artefact, ...], hostile_artefacts: tuple[Artefact, ...]
) -> None:
    figures = [a for a in (*artefacts, *hostile_artefacts) if isinstance(a, Figure)]
    assert figures
    for figure in figures:
        svg = drawn(figure)
        kind, comma, picture = address(svg).partition(",")
        assert (kind, comma) == ("data:image/svg+xml", ",")
        assert told(fromstring(unquote(picture))) == told(fromstring(svg))  # noqa: S314 # our own
        assert len(picture) < len(svg)  # base64 makes it 1.33 times as long


@pytest.mark.slow
def test_every_reference_leads_somewhere(artefacts: tuple[Artefact, ...]) -> None:
    for figure in (a for a in artefacts if isinstance(a, Figure)):
        picture = unquote(address(drawn(figure)))
        meant = set(re.findall(r'(?:href="|url\()#([\w-]+)', picture))
        assert meant
        assert meant <= set(re.findall(r' id="([^"]+)"', picture))


def test_no_sign_ends_an_attribute_or_an_address() -> None:
    picture = address('<svg d="M 1 2 \nL 3 4">\'&#%"<text>a\nL 1</text></svg>')
    assert set(picture).isdisjoint("<>\"'&#\n")
    assert "M1 2L3 4" in picture
    assert unquote(picture).endswith("<text>a\nL 1</text></svg>")


def test_words_that_look_like_attributes_stay_as_they_are() -> None:
    words = ' id="a" style="b" style="b" d="M 1 L 2" url(#c)'
    assert unquote(address(f"<svg><text>{words}</text></svg>")).endswith(
        f"<svg><text>{words}</text></svg>"
    )
