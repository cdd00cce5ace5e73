"""The next contact of a flying can: the first root of one smooth function.

The vector e of the axis, of vertical part C and horizontal length S, and the height z of the middle
decide on contact. A rim touches where F = d^2 - (1 - r)^2 S^2 falls to zero, with d = z - (h - r) C
- r, and C negated for the other rim. Unlike the gap d - (1 - r) S this F is smooth where the axis
passes the vertical. F'' is interpolated at Chebyshev points and integrated twice from the exact
beginning, so that a flight of a nanosecond is as exact as a long one; all roots of the polynomial
are computed, as eigenvalues of its colleague matrix (Boyd, SIAM J. Numer. Anal. 40 (2002) 1666), so
that none is missed between samples.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.polynomial import chebyshev

from reference.problem.states import Floats
from reference.unilateral.flight import Flight, FreeStates

NODES = 26
# Chebyshev coefficients of F'' fall geometrically; the last two below this are round-off.
RESOLVED = 1e-13
# In units of the fastest rate of the motion; a piece of this length is mostly resolved.
USUAL = 2.0
# A piece shorter than this share of the fastest time no longer moves a double.
SHORTEST = 1e-15
# After the normal force has fallen to zero the gap grows as t^3: sooner than this, in units of the
# fastest rate, it is below round-off, and a root of it means nothing.
BLURRED = 1e-4
# Of the horizontal part of the axis: a can that stands on its face.
FACE = 1e-20
# A flight shorter than this, in units of the fastest rate, is over at its beginning.
BRIEFEST = 1e-12
# A piece shorter than this, in units of the fastest rate, falls by less than PENETRATES.
SHALLOW = 1e-6
# In R: a gap below minus this is no round-off.
PENETRATES = 1e-14
# Of a piece: a root that is no farther beside it, or beside the real numbers, is one.
BESIDE = 1e-7
POLISHED = 4
# Of a series: coefficients that are no part of the polynomial.
NOTHING = 1e-18


@dataclass(frozen=True, slots=True, kw_only=True)
class Landing:
    """A contact to come.

    Attributes
    ----------
    after : float
        Time since the launch.
    lower : bool
        Whether it is of the rim on which the can stood, and not of the other.
    """

    after: float
    lower: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class _Start:
    """F and F' where a piece begins, and the time before which F has no root."""

    value: float
    slope: float
    touches: bool = False


def next_contact(flight: Flight, most: float, *, lifted: bool = False) -> Landing | None:
    """Return the next contact of a flight, or None if there is none until `most`.

    Parameters
    ----------
    flight : Flight
    most : float
        Time since the launch up to which to look.
    lifted : bool
        Whether the flight begins because the normal force has fallen to zero.
    """
    rate = flight.rates()
    begun, length = _launched(flight, min(USUAL / rate, most))
    start = 0.0
    while start < most:
        length = min(length, most - start)
        states = flight.at(start + length * (_nodes() + 1) / 2)
        bends = _fit(margin(flight, states)[2])
        if np.abs(bends[-2:]).max() > RESOLVED * (1.0 + np.abs(bends).max()):
            length /= 2
            if length * rate < SHORTEST:
                return Landing(after=start, lower=True)
            continue
        blurred = BLURRED / rate if lifted and begun.touches else 0.0
        found, then = _look(flight, states, bends, begun, length=length, blurred=blurred)
        if found is not None:
            return Landing(after=start + found.after, lower=found.lower)
        sinks = then.value < 0.0 and then.slope < 0.0
        if sinks and length * rate < SHALLOW:
            # so near to the launch that what it sinks by is still round-off
            return Landing(after=start + length, lower=True)
        if _below(flight, states):
            # two roots too near to each other, or to the beginning, for a piece of this length
            length /= 4
            if length * rate < BRIEFEST:
                return Landing(after=start, lower=True)
            continue
        start, begun, length = start + length, then, min(2 * length, USUAL / rate)
    return None


def margin(flight: Flight, states: FreeStates, side: int = 1) -> tuple[Floats, Floats, Floats]:
    """Return F, F' and F'' of a rim, each of shape (n,); side -1 is the other rim."""
    r, h = flight.body.effects.rim, flight.body.parameters.h
    e = states.frame[:, :, 2]
    first = np.cross(states.turning, e)
    second = np.cross(states.turning_rate, e) + np.cross(states.turning, first)
    lever = side * (h - r)
    d = states.middle[:, 2] - lever * e[:, 2] - r
    v = states.velocity[:, 2] - lever * first[:, 2]
    a = states.acceleration[:, 2] - lever * second[:, 2]
    if r == 1.0:
        return d, v, a
    square = (1 - r) ** 2
    S = np.hypot(e[:, 0], e[:, 1])
    level, bend = (e[:, :2] * first[:, :2]).sum(1), (e[:, :2] * second[:, :2]).sum(1)
    bend += (first[:, :2] ** 2).sum(1)
    F = (d - (1 - r) * S) * (d + (1 - r) * S)
    return F, 2 * (d * v - square * level), 2 * (v * v + d * a - square * bend)


def _launched(flight: Flight, length: float) -> tuple[_Start, float]:
    """Return how F begins, and a length for the first piece."""
    F, slope, bend = (float(row[0]) for row in margin(flight, flight.at(np.zeros(1))))
    launch, r = flight.launch, flight.body.effects.rim
    if launch.gap > 0.0:
        return _Start(value=F, slope=slope), length
    S = float(np.hypot(*launch.frame[:2, 2]))
    if S < FACE and r < 1.0:
        # both sides of the face leave the plane: F begins with the product of their rises
        first = 6.0 * float(np.sqrt(max(bend, 0.0) / 2))
        return _Start(value=0.0, slope=0.0, touches=True), min(length, first) or length
    # the exact rise of the rim, of which F' has the round-off
    slope = launch.rise * (2 * (1 - r) * S if r < 1.0 else 1.0)
    if slope > 0 and bend < 0:
        length = min(length, 3.0 * slope / -bend)
    return _Start(value=0.0, slope=slope, touches=True), length


def _look(
    flight: Flight,
    states: FreeStates,
    bends: Floats,
    begun: _Start,
    *,
    length: float,
    blurred: float,
) -> tuple[Landing | None, _Start]:
    """Return the first contact within a piece, if any, and how the next piece begins."""
    once, twice = _integrated(bends, begun, length)
    least = max(_first_possible(begun.slope, bends, length), blurred) if begun.touches else 0.0
    found = _first_root(twice, length, least)
    met = None if found is None else Landing(after=found, lower=True)
    # C < 0 of a can that has tumbled: the other rim may be lower
    if states.frame[:, 2, 2].min() < 0:
        F, slopes, others = margin(flight, states, -1)
        start = _Start(value=float(F[-1]), slope=float(slopes[-1]))
        found = _first_root(_integrated(_fit(others), start, length)[1], length, 0.0)
        if found is not None and (met is None or found < met.after):
            met = Landing(after=found, lower=False)
    return met, _Start(value=float(twice.sum()), slope=float(once.sum()))


def _integrated(bends: Floats, begun: _Start, length: float) -> tuple[Floats, Floats]:
    """Return coefficients of F' and F from those of F'' and the beginning."""
    once: Floats = np.asarray(chebyshev.chebint(bends, lbnd=-1.0) * (length / 2))
    once[0] += begun.slope
    twice: Floats = np.asarray(chebyshev.chebint(once, lbnd=-1.0) * (length / 2))
    twice[0] += begun.value
    return once, twice


def _below(flight: Flight, states: FreeStates) -> bool:
    """Return whether the lowest point is below the plane at the end of a piece."""
    lowest = flight.body.lowest(states.frame[:1, :, 2])[0, 2]
    return float(states.middle[0, 2] + lowest) < -PENETRATES


def _first_possible(slope: float, bends: Floats, length: float) -> float:
    """Return a time before which F, which begins at zero and rises, is not zero again."""
    largest = float(np.abs(bends).sum())
    if slope > 0:
        return 1.9 * slope / largest if largest > 0 else length
    # F begins with F''/2 t^2, as of a can that leaves the plane with its whole face
    start = float(chebyshev.chebval(-1.0, bends))
    change = float(np.abs(chebyshev.chebder(bends)).sum()) * 2 / length
    return 2.9 * max(start, 0.0) / change if change > 0 else length


def _first_root(series: Floats, length: float, least: float) -> float | None:
    """Return the first place after `least` where a polynomial on [0, length] falls through zero."""
    if series[0] > np.abs(series[1:]).sum():
        return None
    keep = np.flatnonzero(np.abs(series) > NOTHING * float(np.abs(series).max()))
    if not keep.size or keep[-1] == 0:
        return None
    trimmed = series[: keep[-1] + 1]
    slopes: Floats = np.asarray(chebyshev.chebder(trimmed))
    roots = chebyshev.chebroots(trimmed)
    real = np.sort(roots[np.abs(roots.imag) < BESIDE].real)
    for root in real[np.abs(real) <= 1.0 + BESIDE].tolist():
        x = _polished(root, trimmed, slopes)
        after = length * (x + 1) / 2
        # a root where F rises is where a blurred beginning ends
        if after > least and float(chebyshev.chebval(x, slopes)) <= 0.0:
            return after
    return None


def _polished(x: float, series: Floats, slopes: Floats) -> float:
    """Return a root on [-1, 1], by Newton's method, which leads from a double root anywhere."""
    low, high = max(x - BESIDE, -1.0), min(x + BESIDE, 1.0)
    for _ in range(POLISHED):
        slope = float(chebyshev.chebval(x, slopes))
        if slope == 0.0:
            break
        x = min(max(x - float(chebyshev.chebval(x, series)) / slope, low), high)
    return x


@lru_cache(maxsize=1)
def _nodes() -> Floats:
    """Return Chebyshev points of the second kind on [-1, 1], falling."""
    return np.asarray(np.cos(np.pi * np.arange(NODES + 1) / NODES))


@lru_cache(maxsize=1)
def _to_series() -> Floats:
    return np.asarray(np.linalg.inv(chebyshev.chebvander(_nodes(), NODES)))


def _fit(values: Floats) -> Floats:
    """Return Chebyshev coefficients of values at the nodes."""
    return np.asarray(_to_series() @ values)
