"""Curves made of solutions, and the panels and figures that show them."""

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.core.report_model import Figure, Panel, Series
from harness.core.trajectory import Floats
from reference import Solution, States

TIME = "t [sqrt(R/g)]"
KINDS = ("reference", "curve 2", "curve 3", "curve 4", "curve 5")
"""Kinds of the curves of a figure, by number from 1; the exact motion is the first."""


def sampled(solution: Solution) -> tuple[Floats, States]:
    """Return times dense in every angle and on the page, and the states there."""
    even = np.linspace(0.0, solution.t_end, 1000)
    times = np.union1d(solution.grid(), even)
    return times, solution.at(times)


def line(label: str, x: Floats, y: Floats, number: int = 1, *, dashed: bool = False) -> Series:
    """Return a curve."""
    return Series(label=label, kind=KINDS[number - 1], x=x, y=y, dashed=dashed)


def points(label: str, x: Floats, y: Floats, number: int, *, dashed: bool = False) -> Series:
    """Return a cloud of points."""
    return replace(line(label, x, y, number, dashed=dashed), mark="points")


def panel(title: str, x_label: str, y_label: str, *series: Series, **axes: Any) -> Panel:  # noqa: ANN401 - options of `Panel`
    """Return a pair of axes with curves."""
    return Panel(title=title, x_label=x_label, y_label=y_label, series=series, **axes)


def figure(name: str, title: str, seen: str, *panels: Panel) -> Figure:
    """Return a figure: three panels in one row, other numbers in rows of at most two."""
    columns = 3 if len(panels) == 3 else min(2, len(panels))  # noqa: PLR2004
    return Figure(name=name, title=title, seen=seen, panels=panels, columns=columns)


def where(mask: NDArray[np.bool_], values: Floats) -> Floats:
    """Return values with NaN outside a mask, one sample beyond its ends so that pieces meet."""
    wide = mask.copy()
    wide[1:] |= mask[:-1]
    wide[:-1] |= mask[1:]
    return np.asarray(np.where(wide, values, np.nan))
