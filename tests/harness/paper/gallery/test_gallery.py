"""The figures are there, finite where drawn, and say what the paper's figures say."""

from functools import cache

import numpy as np
import pytest

from harness.core.report_model import Figure, Panel
from harness.paper.gallery import FIGURES
from harness.report.matplotlib_renderer import render
from harness.report.style import palette

PAPERS = {
    "can_fall",
    "non_dim_solution",
    "eqm_comparison",
    "frob_comp",
    "conserved",
    "eq_comparison",
    "sing_perturb",
    "inner_outer_comp",
    "left_or_right",
    "contact_pt_motion",
    "friction",
    "hamiltonian_3D",
    "hamiltonian_contours",
}


DRAWING = {draw.__name__: draw for draw in FIGURES}
DEAR = {"exact_and_reduced", "family"}
"""Figures that solve for seconds."""
EACH = pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks=pytest.mark.slow if name in DEAR else ()) for name in DRAWING],
)


@cache
def drawn(name: str) -> Figure:
    """Return a figure of the gallery."""
    return DRAWING[name]()


def panel(figure: Figure, title: str) -> Panel:
    return next(p for p in figure.panels if p.title.startswith(title))


@pytest.mark.slow
def test_every_figure_of_the_paper_is_there() -> None:
    names = [drawn(name).name.removeprefix("fig01-") for name in DRAWING]
    assert set(names) == PAPERS | {"wells"}
    assert len(FIGURES) == len(DRAWING) == len(set(names))


@EACH
def test_every_curve_has_something_to_show(name: str) -> None:
    for each in drawn(name).panels:
        for series in each.series:
            assert series.x.shape == series.y.shape
            assert np.isfinite(series.x + series.y).any(), series.label


@pytest.mark.slow
@EACH
def test_every_figure_can_be_printed(name: str) -> None:
    figure = drawn(name)
    files = render(figure, palette(s.kind for p in figure.panels for s in p.series))
    assert files.png.startswith(b"\x89PNG")
    assert files.svg.rstrip().endswith("</svg>")


def test_psi_is_a_staircase_of_209_degrees() -> None:
    (curve,) = panel(drawn("time_series"), "psi").series
    # four bounces of 209.36 degrees, printed to five digits in the project's facts
    assert curve.y[-1] == pytest.approx(4 * 209.3634, abs=1e-3)


def test_the_hypergeometric_solution_lies_on_the_motion() -> None:
    motion, exact = drawn("hypergeometric").panels[0].series
    order = np.argsort(motion.x)
    there = np.interp(np.log(exact.x), np.log(motion.x[order]), np.log(motion.y[order]))
    # interpolation between samples 0.02 rad of turn apart
    assert np.abs(np.log(exact.y) - there).max() < 1e-3


def test_the_matched_curve_lies_on_the_reduced_one() -> None:
    for each in drawn("inner_and_outer").panels:
        curves = {series.label: series.y for series in each.series}
        # the composite's error is of order eps log eps, 1e-9 here, over phi_min
        assert np.abs(curves["matched"] - curves["reduced equation"]).max() < 1e-6


def test_the_two_signs_lie_on_either_side_of_the_line() -> None:
    grows, falls, line = drawn("sign_map").panels[0].series
    slope = line.y[1] / line.x[1]
    right = np.concatenate([grows.y < slope * grows.x, falls.y > slope * falls.x])
    # the line is the boundary to leading order: the slope is 1 % off at phi = pi/100
    assert right.mean() > 0.99


def test_contours_close() -> None:
    orbits = [s for s in drawn("contours").panels[0].series if s.label == "orbits"]
    assert len(orbits) == 6
    for orbit in orbits:
        assert orbit.x[0] == orbit.x[-1]
        # the speed at a turning point is the square root of round-off
        assert np.abs(orbit.y[[0, -1]]).max() < 1e-6


def test_a_release_lies_in_the_upper_of_two_wells() -> None:
    """On it the energy of the release is shown between the barrier and the other turning point."""
    well = panel(drawn("wells"), "two wells: the well of the release")
    curves = {series.label: series for series in well.series}
    reached = np.isfinite(curves["energy of the release"].y)
    inside = curves["energy of the release"].x[reached]
    assert curves["unstable steady motion"].x[0] < inside[0] < curves["stable steady motion"].x[0]
    # the turning point that forty digits give, to a sample
    assert inside[0] == pytest.approx(1.4638669, abs=1e-4)
    assert inside[-1] == pytest.approx(curves["release"].x[0], abs=1e-4)
    counted = panel(drawn("wells"), "two wells: wells and folds").heat
    assert counted is not None
    column = np.searchsorted(counted.x, 0.4719) - 1
    row = np.searchsorted(counted.y, -0.0559) - 1
    assert counted.z[row, column] == 2
    assert set(np.unique(counted.z)) == {0.0, 1.0, 2.0}
