"""No curve of a real run is off by a pixel of its panel, whatever thinning left out."""

from collections.abc import Iterator

import numpy as np
import pytest
from scipy.spatial import KDTree

from harness.core.case import Case
from harness.core.report_model import Figure, Panel, Series
from harness.core.trajectory import Floats
from harness.evaluation.run_cases import run_cases
from harness.report.simplify_curves import PAPER, SCREEN, Detail, plottable, simplify
from harness.studies.comparison.study import comparison_report
from models.catalogue import load

PIXELS = 1_000  # a panel as wide and as high as a screen shows it
FINE = 0.1  # of a pixel: how far apart a drawn line is looked at


@pytest.fixture(scope="module", params=["paper-release", "wobble"])
def figures(request: pytest.FixtureRequest) -> list[Figure]:
    """Return the figures of a scene: one bounces in microseconds, one chatters."""
    scene = load(request.param)
    cases = [
        Case(scene=scene, engine=engine, profile=profile)
        for engine in ("mujoco", "pybullet")
        for profile in ("default", "adaptive")
    ]
    return [
        artefact for artefact in comparison_report(run_cases(cases)) if isinstance(artefact, Figure)
    ]


def pixels(series: Series, panel: Panel, ends: Floats) -> Iterator[Floats]:
    """Yield each unbroken piece of a curve in pixels of its panel."""
    x, y = plottable(series, panel)
    low, high = ends
    points = (axes(x, y, panel) - low) / np.where(high > low, high - low, 1.0) * PIXELS
    finite = np.isfinite(points).all(axis=1)
    for piece in np.split(np.arange(len(x)), np.flatnonzero(np.diff(finite)) + 1):
        if len(piece) and finite[piece[0]]:
            yield points[piece]


def axes(x: Floats, y: Floats, panel: Panel) -> Floats:
    return np.column_stack((np.log10(x) if panel.log_x else x, np.log10(y) if panel.log_y else y))


def reach(panel: Panel) -> Floats:
    """Return the lowest and the highest of all that a panel shows, shape (2, 2)."""
    points = np.concatenate([axes(*plottable(s, panel), panel) for s in panel.series])
    return np.stack((np.nanmin(points, axis=0), np.nanmax(points, axis=0)))


def drawn(points: Floats) -> Floats:
    """Return the line through points as a row of points a tenth of a pixel apart."""
    lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)
    along = np.concatenate(([0.0], lengths.cumsum()))
    places = np.linspace(0.0, along[-1], int(along[-1] / FINE) + 2)
    return np.column_stack([np.interp(places, along, points[:, axis]) for axis in range(2)])


@pytest.mark.slow
@pytest.mark.parametrize("detail", [SCREEN, PAPER], ids=["screen", "paper"])
def test_no_curve_is_off_by_a_pixel(figures: list[Figure], detail: Detail) -> None:
    left_out = 0
    for figure in figures:
        for before, after in zip(figure.panels, simplify(figure, detail).panels, strict=True):
            ends = reach(before)
            for whole, thin in zip(before.series, after.series, strict=True):
                left_out += len(whole.x) - len(thin.x)
                pieces = zip(pixels(whole, before, ends), pixels(thin, before, ends), strict=True)
                for real, shown in pieces:
                    distance, _ = KDTree(drawn(shown)).query(real)
                    name = (figure.name, before.title, whole.label)
                    assert distance.max() <= 1.0 + FINE, name
    assert left_out > 10_000  # or nothing was tried
