"""Observed order: how fast an error falls with the timestep."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np


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
