"""Curves made of solutions, and their kinds."""

import numpy as np
from numpy.typing import NDArray

from harness.core.report_model import Series
from harness.core.trajectory import Floats
from reference import Solution, States

TIME = "t [sqrt(R/g)]"
OURS, SECOND_CURVE, THIRD_CURVE = "reference", "curve 2", "curve 3"
FOURTH_CURVE, FIFTH_CURVE = "curve 4", "curve 5"
"""Which curve of a figure it is; the exact motion is the first."""


def sampled(solution: Solution) -> tuple[Floats, States]:
    """Return times dense in every angle and on the page, and the states there."""
    even = np.linspace(0.0, solution.t_end, 1000)
    times = np.union1d(solution.grid(), even)
    return times, solution.at(times)


def line(label: str, x: Floats, y: Floats, kind: str = OURS, *, dashed: bool = False) -> Series:
    """Return a curve."""
    return Series(label=label, kind=kind, x=np.asarray(x), y=np.asarray(y), dashed=dashed)


def points(label: str, x: Floats, y: Floats, kind: str) -> Series:
    """Return a cloud of points."""
    return Series(label=label, kind=kind, x=np.asarray(x), y=np.asarray(y), mark="points")


def where(mask: NDArray[np.bool_], values: Floats) -> Floats:
    """Return values with NaN outside a mask, one sample beyond its ends so that pieces meet."""
    wide = mask.copy()
    wide[1:] |= mask[:-1]
    wide[:-1] |= mask[1:]
    return np.asarray(np.where(wide, values, np.nan))
