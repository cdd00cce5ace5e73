"""Figures on paper: real files, the same each time, with texts as they are."""

import struct
from dataclasses import replace
from xml.etree import ElementTree as ET

import matplotlib as mpl
import numpy as np
import pytest

from harness.core.report_model import Artefact, Figure, Panel, Series
from harness.report.matplotlib_renderer import PIXELS, RenderedFigure, render
from harness.report.style import palette

SVG = "{http://www.w3.org/2000/svg}"


def draw(figure: Figure) -> RenderedFigure:
    return render(figure, palette(s.kind for panel in figure.panels for s in panel.series))


def figures(artefacts: tuple[Artefact, ...]) -> list[Figure]:
    return [artefact for artefact in artefacts if isinstance(artefact, Figure)]


@pytest.fixture(scope="module")
def printed(artefacts: tuple[Artefact, ...]) -> list[RenderedFigure]:
    """Return every figure on paper."""
    return [draw(figure) for figure in figures(artefacts)]


@pytest.mark.slow
def test_png_is_a_picture_of_the_stated_width(printed: list[RenderedFigure]) -> None:
    for one in printed:
        png = one.png
        assert png.startswith(b"\x89PNG\r\n\x1a\n")
        assert png.endswith(b"IEND\xaeB`\x82")
        width, height = struct.unpack(">II", png[16:24])
        assert width == PIXELS
        assert 300 < height < 2 * PIXELS


@pytest.mark.slow
def test_the_same_figure_gives_the_same_bytes(
    artefacts: tuple[Artefact, ...], printed: list[RenderedFigure]
) -> None:
    figure, once = figures(artefacts)[0], printed[0]
    with mpl.rc_context({"font.size": 30.0, "lines.linewidth": 9.0}):  # what a user may have set
        assert draw(figure) == once
    assert "date" not in once.svg.lower()


@pytest.mark.slow
def test_svg_is_well_formed_and_says_what_the_figure_says(
    artefacts: tuple[Artefact, ...], printed: list[RenderedFigure]
) -> None:
    figure = figures(artefacts)[0]
    root = ET.fromstring(printed[0].svg)  # noqa: S314 # written by this test
    texts = {"".join(element.itertext()) for element in root.iter(f"{SVG}text")}
    for panel in figure.panels:
        assert {panel.title, panel.x_label, panel.y_label} <= texts
        assert {series.label for series in panel.series} <= texts


@pytest.mark.slow
def test_no_text_becomes_an_element_or_a_formula(hostile_artefacts: tuple[Artefact, ...]) -> None:
    for figure in figures(hostile_artefacts):
        root = ET.fromstring(draw(figure).svg)  # noqa: S314 # written by this test
        names = {element.tag.removeprefix(SVG) for element in root.iter()}
        assert not names & {"script", "img", "image", "foreignObject", "a"}
        texts = {"".join(element.itertext()) for element in root.iter(f"{SVG}text")}
        assert figure.panels[0].title in texts


@pytest.mark.parametrize("label", ["$\\frac{1}{", "_hidden", "", "日本語"])
def test_odd_labels_are_drawn(label: str) -> None:
    x = np.arange(3.0)
    series = Series(label=label, kind="reference", x=x, y=x)
    panel = Panel(title=label, x_label=label, y_label=label, series=(series,))
    assert draw(Figure(name="odd", title=label, seen="", panels=(panel,))).png


@pytest.mark.parametrize("log", [False, True])
@pytest.mark.parametrize("y", [[], [np.nan, np.nan], [-1.0, -2.0]])
def test_a_panel_with_nothing_to_draw_says_so(y: list[float], log: bool) -> None:  # noqa: FBT001 # a parameter of the test
    series = Series(
        label="a", kind="a", x=np.arange(1.0, 1.0 + len(y)), y=np.array(y, dtype=np.float64)
    )
    panel = Panel(title="", x_label="", y_label="", series=(series,), log_x=log, log_y=log)
    figure = Figure(name="empty", title="", seen="", panels=(panel,))
    drawable = bool(y) and not log and not np.isnan(y).any()
    assert ("nothing to draw" in draw(figure).svg) != drawable


@pytest.mark.slow
def test_rounding_moves_nothing_visible(artefacts: tuple[Artefact, ...]) -> None:
    figure = replace(figures(artefacts)[0], columns=3)
    numbers = [
        len(word.partition(".")[2])
        for element in ET.fromstring(draw(figure).svg).iter(f"{SVG}path")  # noqa: S314
        for word in element.attrib["d"].split()
        if "." in word
    ]
    assert numbers
    assert max(numbers) <= 2  # a hundredth of a point
