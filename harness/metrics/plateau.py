"""A plateau: the error that is left when the timestep goes to zero.

The model is e(h) = L + C h^p. For each p the two constants follow by least squares of the relative
residuals; p is the one that fits best. The rungs too coarse for the model are left out, the
coarsest first, until it fits. There is a plateau where L outweighs C h^p at the finest rung: a
limit that the ladder has not come near is no observation but an extrapolation.

A ladder too erratic for the model may still be flat: the last three errors then say its level.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize_scalar

from harness.trajectory import Floats

_FEWEST = 4
"""Rungs for three constants and one residual."""

_FITS = 0.02
"""Relative residual, root mean square, up to which the model is believed."""

_POWERS = np.linspace(0.4, 5.0, 47)
"""Orders tried before the best is refined: below the first a power looks like a constant."""

_FLAT = 1.5
"""Largest over smallest of the last three errors of a ladder that is called flat."""

_FLAT_RUNGS, _FLAT_SPAN = 3, 4.0
"""Rungs that must agree, and the least ratio of their timesteps: of first order 4 times as far."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Plateau:
    """Where a ladder of timesteps levels off.

    Parameters
    ----------
    level : float
        Of the error, with its sign if the errors had theirs.
    timestep : float
        Below which the level outweighs what goes with the timestep, s.
    rungs : int
        That went into it.
    erratic : bool
        True if the ladder is flat but follows no power of the timestep.
    """

    level: float
    timestep: float
    rungs: int
    erratic: bool = False


def plateau(timesteps: Sequence[float], errors: Sequence[float | None]) -> Plateau | None:
    """Return the plateau of a ladder, or None if the error still falls at its finest rung.

    Parameters
    ----------
    timesteps : sequence of float, length n
        s, in any order.
    errors : sequence of float or None, length n
        Signed or magnitudes; None, zero and what is no number are left out.
    """
    pairs = sorted(
        (step, error)
        for step, error in zip(timesteps, errors, strict=True)
        if error is not None and error != 0.0 and math.isfinite(error)
    )
    h = np.array([step for step, _ in pairs])
    e = np.array([error for _, error in pairs])
    for count in range(len(h), _FEWEST - 1, -1):
        level, constant, power, residual = _fit(h[:count], e[:count])
        if residual > _FITS:
            continue
        moving = abs(constant) * h[0] ** power
        if moving >= abs(level):
            return None
        reach = (abs(level) / abs(constant)) ** (1.0 / power) if constant else h[count - 1]
        return Plateau(level=level, timestep=float(min(reach, h[count - 1])), rungs=count)
    return _flat(h, e)


def _fit(h: Floats, e: Floats) -> tuple[float, float, float, float]:
    """Return L, C, p and the relative residual of the best fit, rms."""
    scaled = h / h.max()

    def residual(power: float) -> float:
        return _constants(scaled, e, power)[2]

    best = _POWERS[int(np.argmin([residual(power) for power in _POWERS]))]
    step = _POWERS[1] - _POWERS[0]
    found = minimize_scalar(
        residual,
        bounds=(best - step, best + step),
        method="bounded",
        options={"xatol": 1e-9},  # the square of the residual is flat to about 1e-8
    )
    power = float(found.x) if found.fun < residual(best) else float(best)
    level, constant, rest = _constants(scaled, e, power)
    return level, constant / h.max() ** power, power, rest


def _constants(h: Floats, e: Floats, power: float) -> tuple[float, float, float]:
    """Return L, C and the relative residual, rms, for a given power."""
    matrix = np.stack((1.0 / e, h**power / e), axis=-1)
    (level, constant), *_ = np.linalg.lstsq(matrix, np.ones(len(e)), rcond=None)
    rest = matrix @ np.array((level, constant)) - 1.0
    return float(level), float(constant), float(np.sqrt(np.mean(rest**2)))


def _flat(h: Floats, e: Floats) -> Plateau | None:
    """Return the plateau of a ladder whose last three errors agree, in any fashion."""
    if len(h) < _FLAT_RUNGS or h[_FLAT_RUNGS - 1] / h[0] < _FLAT_SPAN:
        return None
    last = e[:_FLAT_RUNGS]
    sizes = np.abs(last)
    if sizes.max() > _FLAT * sizes.min() or np.ptp(np.sign(last)) != 0.0:
        return None
    level = float(np.sign(last[0]) * np.exp(np.mean(np.log(sizes))))
    return Plateau(level=level, timestep=float(h[_FLAT_RUNGS - 1]), rungs=_FLAT_RUNGS, erratic=True)
