"""Observed order: how fast an error falls with the timestep."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.stats import t as student

from harness.trajectory import Floats


@dataclass(frozen=True, slots=True, kw_only=True)
class Order:
    """Slope of log error against log timestep.

    Parameters
    ----------
    order : float
        By least squares; NaN with fewer than two errors.
    spread : float
        Half the range of the slopes between neighbouring timesteps; NaN with fewer than three.
    points : int
        Errors that went into it.
    """

    order: float
    spread: float
    points: int


def observed_order(timesteps: Sequence[float], errors: Sequence[float]) -> Order:
    """Return the observed order of a ladder of timesteps.

    Parameters
    ----------
    timesteps : sequence of float, length n
        s.
    errors : sequence of float, length n
        Their magnitude counts; those that are zero or no number are left out.
    """
    pairs = sorted(
        (math.log(step), math.log(abs(error)))
        for step, error in zip(timesteps, errors, strict=True)
        if error != 0.0 and math.isfinite(error)
    )
    if len(pairs) < 2:  # noqa: PLR2004 - a slope needs two points
        return Order(order=math.nan, spread=math.nan, points=len(pairs))
    x, y = np.array(pairs).T
    slopes = np.diff(y) / np.diff(x)
    spread = float(np.ptp(slopes) / 2.0) if len(slopes) > 1 else math.nan
    return Order(order=float(np.polyfit(x, y, 1)[0]), spread=spread, points=len(pairs))


_FEWEST = 3
"""Rungs of an asymptotic range: two slopes that can agree."""

_STRAIGHT = 0.2
"""By which each slope may be off the one of the whole range."""

_LEAST = 0.25
"""Below it an error does not fall with the timestep in any sense that helps."""


@dataclass(frozen=True, slots=True, kw_only=True)
class AsymptoticOrder:
    """The order over the rungs where the error is a power of the timestep.

    Parameters
    ----------
    order : float
    confidence : float
        Half-width of the 95 % interval of the slope, from the scatter about the line.
    coarsest, finest : float
        Of the range, s.
    points : int
    """

    order: float
    confidence: float
    coarsest: float
    finest: float
    points: int


def asymptotic_order(
    timesteps: Sequence[float], errors: Sequence[float | None], level: float = 0.0
) -> AsymptoticOrder | None:
    """Return the order over the longest range of neighbouring rungs whose slopes agree.

    Of ranges equally long the finest counts. Rungs without an error break a range, and so do those
    where what is left above the level is less than a fifth of it: that is the level's own error.

    Parameters
    ----------
    timesteps : sequence of float, length n
        s.
    errors : sequence of float or None, length n
    level : float
        Of the plateau, with the sign of the errors.

    Returns
    -------
    AsymptoticOrder or None
        None if no three neighbouring rungs have an order.
    """
    pairs = sorted(zip(timesteps, errors, strict=True))
    clear = [
        (math.log(step), math.log(abs(error - level)))
        if error is not None and math.isfinite(error) and abs(error - level) > abs(level) / 5.0
        else None
        for step, error in pairs
    ]
    for count in range(len(clear), _FEWEST - 1, -1):
        for first in range(len(clear) - count + 1):
            window = [pair for pair in clear[first : first + count] if pair is not None]
            if len(window) == count:
                found = _straight(*np.array(window).T)
                if found is not None:
                    return found
    return None


def _straight(x: Floats, y: Floats) -> AsymptoticOrder | None:
    """Return the order of a range, or None if its slopes do not agree."""
    order, offset = (float(number) for number in np.polyfit(x, y, 1))
    slopes = np.diff(y) / np.diff(x)
    if order < _LEAST or float(np.abs(slopes - order).max()) > _STRAIGHT:
        return None
    rest = y - order * x - offset
    freedom = len(x) - 2
    error = math.sqrt(float(rest @ rest) / freedom / float(np.sum((x - x.mean()) ** 2)))
    return AsymptoticOrder(
        order=order,
        confidence=float(student.ppf(0.975, freedom)) * error,
        coarsest=math.exp(float(x[-1])),
        finest=math.exp(float(x[0])),
        points=len(x),
    )
