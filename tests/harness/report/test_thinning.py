"""A thinned curve cannot be told from the whole one."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from harness.core.report_model import Figure, Panel, Series
from harness.core.trajectory import Floats
from harness.report.simplify_curves import PAPER, SCREEN, kept_points, simplify

EPS = np.finfo(np.float64).eps


def one_curve(series: Series, *, log: bool = False, equal: bool = False) -> Figure:
    panel = Panel(
        title="", x_label="", y_label="", series=(series,), log_x=log, log_y=log, equal=equal
    )
    return Figure(name="one", title="", seen="", panels=(panel,))


def curve(figure: Figure) -> Series:
    return figure.panels[0].series[0]


def distance(points: Floats, line: Floats) -> Floats:
    """Return the distance of each point from a broken line, by brute force."""
    start, along = line[:-1], np.diff(line, axis=0)
    squared = np.maximum((along**2).sum(axis=1), np.finfo(float).tiny)
    share = ((points[:, None] - start) * along).sum(axis=2) / squared
    foot = start + np.clip(share, 0.0, 1.0)[:, :, None] * along
    return np.asarray(np.linalg.norm(points[:, None] - foot, axis=2).min(axis=1))


POINTS = st.lists(st.tuples(st.floats(-1.0, 1.0), st.floats(-1.0, 1.0)), min_size=2, max_size=60)


def kept_of_one(points: Floats, tolerance: float) -> NDArray[np.bool_]:
    return kept_points(points, np.array([0]), np.array([len(points) - 1]), tolerance)


@given(st.lists(POINTS, min_size=2, max_size=4), st.sampled_from([0.0, 1e-3, 0.1]))
def test_lines_beside_each_other_are_thinned_as_each_on_its_own(
    lines: list[list[tuple[float, float]]], tolerance: float
) -> None:
    ends = np.cumsum([len(line) for line in lines])
    firsts = np.append(0, ends[:-1])
    together = kept_points(np.concatenate(lines), firsts, ends - 1, tolerance)
    alone = [kept_of_one(np.array(line), tolerance) for line in lines]
    assert np.array_equal(together, np.concatenate(alone))


def test_each_line_of_a_panel_is_thinned_on_its_own() -> None:
    x = np.arange(9.0)
    bent = Series(label="", kind="", x=x, y=np.abs(x - 4.0))
    marked = replace(bent, mark="points")
    empty = replace(bent, x=x[:0], y=x[:0])
    gap = replace(bent, y=np.where(x == 5.0, np.nan, 0.0))
    figure = one_curve(bent)
    panel = replace(figure.panels[0], series=(bent, empty, marked, gap, bent))
    found = simplify(replace(figure, panels=(panel,)), SCREEN).panels[0].series
    kept = [0.0, 4.0, 8.0]
    assert [list(series.x) for series in found] == [kept, [], list(x), [0, 4, 5, 6, 8], kept]


@given(POINTS, st.sampled_from([0.0, 1e-3, 0.1]))
def test_what_is_left_out_is_within_the_tolerance(
    points: list[tuple[float, float]], tolerance: float
) -> None:
    given_points = np.array(points)
    stays = kept_of_one(given_points, tolerance)
    assert stays[0]
    assert stays[-1]
    # the brute force and the thinning round a few products of numbers of order 1 differently
    assert (
        distance(given_points, given_points[stays]).max()
        <= tolerance + 64 * EPS**0.5 * (tolerance == 0.0) + 64 * EPS
    )


def test_a_bounce_between_straight_lines_keeps_its_points() -> None:
    time = np.linspace(-1.0, 1.0, 200_001)
    phi = np.hypot(1e-4, time)
    found = curve(simplify(one_curve(Series(label="", kind="", x=time, y=phi)), SCREEN))
    assert len(found.x) < 200
    whole = np.column_stack(((time + 1.0) / 2.0, phi))[::37]
    line = np.column_stack(((found.x + 1.0) / 2.0, found.y))
    # the panel is 1 high to one part in ten thousand
    assert distance(whole, line).max() <= SCREEN.tolerance * 1.001


def test_noise_keeps_its_envelope() -> None:
    time = np.linspace(0.0, 1.0, 60_000)
    noise = np.random.default_rng(7).normal(size=time.size)
    found = curve(simplify(one_curve(Series(label="", kind="", x=time, y=noise)), PAPER))
    assert len(found.x) <= 4 * PAPER.columns
    assert found.y.min() == noise.min()
    assert found.y.max() == noise.max()
    assert np.all(np.diff(found.x) > 0.0)


def test_on_logarithmic_axes_a_power_law_is_a_straight_line() -> None:
    step = np.logspace(-8.0, -2.0, 500)
    found = curve(
        simplify(one_curve(Series(label="", kind="", x=step, y=step**2), log=True), SCREEN)
    )
    assert list(found.x) == [step[0], step[-1]]


def test_gaps_stay_gaps() -> None:
    x = np.arange(100.0)
    y = x.copy()
    y[40:60] = np.nan
    found = curve(simplify(one_curve(Series(label="", kind="", x=x, y=y)), SCREEN))
    assert list(found.x) == [0.0, 39.0, 40.0, 60.0, 99.0]
    assert np.isnan(found.y).sum() == 1


@pytest.mark.parametrize("mark", ["points", "both"])
def test_points_with_marks_all_stay(mark: Any) -> None:
    x = np.arange(50.0)
    series = replace(Series(label="", kind="", x=x, y=x), mark=mark)
    assert len(curve(simplify(one_curve(series), SCREEN)).x) == 50


def test_hover_texts_stay_with_their_points() -> None:
    x = np.arange(5.0)
    series = Series(label="", kind="", x=x, y=np.array([0.0, 1, 2, 1, 0]), hover=tuple("abcde"))
    assert curve(simplify(one_curve(series), SCREEN)).hover == ("a", "c", "e")


@pytest.mark.parametrize("length", [0, 1, 2])
def test_short_and_empty_curves_are_left_alone(length: int) -> None:
    x = np.arange(float(length))
    figure = one_curve(Series(label="", kind="", x=x, y=x), equal=True)
    assert len(curve(simplify(figure, SCREEN)).x) == length
