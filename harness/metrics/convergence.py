"""Observed order: how fast an error falls with the timestep.

A plateau: the error that is left when the timestep goes to zero.

The model is e(h) = L + C h^p. For each p the two constants follow by least squares of the relative
residuals; p is the one that fits best. The rungs too coarse for the model are left out, the
coarsest first, until it fits. There is a plateau where L outweighs C h^p at the finest rung: a
limit that the ladder has not come near is no observation but an extrapolation.

A ladder too erratic for the model may still be flat: the last three errors then say its level.

The Pareto front: what nothing else beats in both cost and error.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from harness.core.trajectory import Floats


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
                order = _straight(*np.array(window).T)
                if order is not None:
                    return order
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
        confidence=float(scipy.special.stdtrit(freedom, 0.975)) * error,
        coarsest=math.exp(float(x[-1])),
        finest=math.exp(float(x[0])),
        points=len(x),
    )


_PLATEAU_FEWEST = 4
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
    for count in range(len(h), _PLATEAU_FEWEST - 1, -1):
        level, constant, power, residual = _fit(h[:count], e[:count])
        if residual > _FITS:
            continue
        moving = abs(constant) * h[0] ** power
        if moving >= abs(level):
            return None
        limit = (abs(level) / abs(constant)) ** (1.0 / power) if constant else h[count - 1]
        return Plateau(level=level, timestep=float(min(limit, h[count - 1])), rungs=count)
    return _flat(h, e)


def _fit(h: Floats, e: Floats) -> tuple[float, float, float, float]:
    """Return L, C, p and the relative residual of the best fit, rms."""
    scaled = h / h.max()

    def residual(power: float) -> float:
        return _constants(scaled, e, power)[2]

    best = _POWERS[int(np.argmin([residual(power) for power in _POWERS]))]
    step = _POWERS[1] - _POWERS[0]
    refined = scipy.optimize.minimize_scalar(
        residual,
        bounds=(best - step, best + step),
        method="bounded",
        options={"xatol": 1e-9},  # the square of the residual is flat to about 1e-8
    )
    power = float(refined.x) if refined.fun < residual(best) else float(best)
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


def pareto_front(costs: Sequence[float], errors: Sequence[float]) -> tuple[int, ...]:
    """Return the places of the points that no other point beats, by rising cost.

    A point is beaten by one that costs no more and errs no more, and less in one of the two. Points
    equal in both are all on the front or all off it.

    Parameters
    ----------
    costs, errors : sequence of float, length n
        What is no number, or infinite, is on no front.

    Returns
    -------
    tuple of int
    """
    usable = [
        place
        for place, (cost, error) in enumerate(zip(costs, errors, strict=True))
        if math.isfinite(cost) and math.isfinite(error)
    ]
    front: list[int] = []
    for place in sorted(usable, key=lambda place: (costs[place], errors[place])):
        if front:
            last = front[-1]
            equal = costs[place] == costs[last] and errors[place] == errors[last]
            if not equal and errors[place] >= errors[last]:
                continue
        front.append(place)
    return tuple(front)
