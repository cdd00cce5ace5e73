"""Pictures of any numbers at all: a report is written whatever an engine has returned."""

import re
from typing import Any
from xml.etree.ElementTree import fromstring

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from harness.core.report_model import Figure, Heatmap, Panel, Series
from harness.report.plotly_renderer import description
from harness.report.simplify_curves import SCREEN, simplify
from harness.report.style import palette, span
from harness.report.svg_renderer import stills

LARGEST, LEAST = float(np.finfo(np.float64).max), 5e-324

POSITIVE = st.one_of(
    st.sampled_from((LEAST, 1e-310, 1e-300, 1e-16, 1.0, np.nextafter(1.0, 2.0), 7e20, 1e300)),
    st.sampled_from((1.7e308, LARGEST)),
    st.floats(min_value=0.0, exclude_min=True, allow_nan=False, allow_infinity=False),
)
FINITE = st.one_of(POSITIVE, POSITIVE.map(lambda number: -number), st.just(0.0))
ANY = st.one_of(FINITE, st.sampled_from((np.nan, np.inf, -np.inf)))


def numbers(count: int) -> st.SearchStrategy[Any]:
    """Return numbers of one axis, all alike or each of its own."""
    alike = FINITE.map(lambda number: np.full(count, number))
    return st.one_of(alike, arrays(np.float64, count, elements=ANY, fill=st.nothing()))


def increasing(count: int, *, log: bool) -> st.SearchStrategy[Any]:
    """Return ends of an axis, or edges of cells."""
    return st.lists(POSITIVE if log else FINITE, min_size=count, max_size=count, unique=True).map(
        sorted
    )


@st.composite
def series(draw: st.DrawFn, number: int, marks: tuple[str, ...]) -> Series:
    count = draw(st.integers(0, 5))
    return Series(
        label=f"s{number}",
        kind=draw(st.sampled_from(("reference", "mujoco"))),
        x=draw(numbers(count)),
        y=draw(numbers(count)),
        mark=draw(st.sampled_from(marks)),
        base=draw(st.none() | numbers(count)),
    )


@st.composite
def heatmaps(draw: st.DrawFn, *, log_x: bool, log_y: bool) -> Heatmap:
    columns, rows = draw(st.integers(1, 3)), draw(st.integers(1, 3))
    return Heatmap(
        label="h",
        x=np.array(draw(increasing(columns + 1, log=log_x))),
        y=np.array(draw(increasing(rows + 1, log=log_y))),
        z=draw(numbers(rows * columns)).reshape(rows, columns),
        signed=draw(st.booleans()),
    )


@st.composite
def panels(draw: st.DrawFn) -> Panel:
    names = draw(st.sampled_from(((), (), ("a", "b"))))
    log_x, log_y = draw(st.booleans()) and not names, draw(st.booleans())
    marks = ("line", "points", "both", "bars")
    ranges = [draw(st.none() | increasing(2, log=log).map(tuple)) for log in (log_x, log_y)]
    return Panel(
        title="p",
        x_label="x",
        y_label="y",
        series=tuple(draw(series(number, marks)) for number in range(draw(st.integers(0, 2)))),
        log_x=log_x,
        log_y=log_y,
        equal=draw(st.booleans()) and not log_x and not log_y and not names,
        x_names=names,
        x_range=ranges[0],
        y_range=ranges[1],
        heat=draw(st.none() | heatmaps(log_x=log_x, log_y=log_y)),
    )


def figure_of(panel: Panel) -> Figure:
    return Figure(name="f", title="f", seen="", panels=(panel,))


INKS = palette(("reference", "mujoco"))


@given(panels())
def test_every_panel_has_a_still_picture_of_finite_places(panel: Panel) -> None:
    (text,) = stills(figure_of(panel), INKS, {kind: f"--{kind}" for kind in INKS})
    root = fromstring(text)  # noqa: S314 - our own
    said = [one.text or "" for one in root.iter("text")]
    for one in root.iter():
        said += [value for name, value in one.attrib.items() if name != "href"]
    assert not [words for words in said if re.search("nan|inf", words)]


@given(panels())
def test_every_panel_is_described_for_the_screen(panel: Panel) -> None:
    description(simplify(figure_of(panel), SCREEN), INKS)


@given(numbers(6), st.booleans())
def test_the_scale_of_a_map_holds_numbers_apart(z: Any, signed: bool) -> None:  # noqa: FBT001
    edges = np.arange(7.0)
    low, high = span(Heatmap(label="h", x=edges, y=edges[:2], z=z[None, :], signed=signed))
    assert low + 1e-13 * abs(low) < high
    assert np.isfinite(high - low)
