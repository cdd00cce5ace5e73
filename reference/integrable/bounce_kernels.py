"""The exact bounce of one release after another, compiled to machine code.

The same mathematics as `reference.integrable.cycle` in scalars, for releases that are not hard: the
well referred to phi_max, phi_min by a secant in phi^2, the midpoint rule on the elliptic clock.
Each value is checked as there; a release with a value in doubt is left to the arrays of
`reference.integrable.cycle`, which know what to do with it. No release knows of another, so that it
has the same bits alone and in a batch.

A constant as an argument is compiled for by itself: where that costs time and gains none, a
variable stands for it.

Needs numba (`reference.numerics.compiled`).
"""

import math
from functools import cache

import numpy as np
from numpy.typing import NDArray

from reference.equations.balancing_angle import balancing_angle
from reference.equations.nonholonomic import ROUND_OFFS
from reference.integrable.effective_potential import POISED
from reference.integrable.frobenius import MOST_TERMS
from reference.integrable.potential_kernels import (
    EPS,
    MOST_NODES,
    Space,
    evaluate,
    extend_series,
    first_integral,
    force,
    noise,
    refer,
    terms_for,
)
from reference.integrable.quadrature import DECADES, LOST, to_cosines
from reference.integrable.quadrature_kernels import (
    arithmetic_geometric_mean,
    place_nodes,
    stays_positive,
    unresolved,
)
from reference.integrable.turning_points import (
    BESIDE,
    GRID,
    NEARBY,
    OUTCOMES,
    SMALLEST,
    UPRIGHT,
)
from reference.numerics.chebyshev import to_coefficients
from reference.numerics.compiled import jit
from reference.problem.outcome import Outcome
from reference.problem.states import Floats

FIELDS = ("period", "angle_of_turn", "rotation_turn", "phi_min", "phi_max", "peak_psi_dot")
"""Columns of the results of `solve_each`."""

LEFT = -1
"""Code of a release that is left to the arrays."""
_FINISHED, _OVERTURNED = OUTCOMES.index(Outcome.FINISHED), OUTCOMES.index(Outcome.OVERTURNED)
# The theta series converge fastest up to here, where the two nomes are equal.
_DEEP = 0.5
_PLACES = 8
"""Trial nutations evaluated together, in search of a change of sign."""
# A sign is sure beyond four times the round-off of what is added up.
_UNSURE = 4.0 * ROUND_OFFS * EPS


@cache
def _waves() -> tuple[Floats, ...]:
    """Return the matrices from values to cosines of 8, 16, ... nodes and of a grid, transposed."""
    matrices = [to_cosines(n) for n in range(8, MOST_NODES + 1, 8)]
    return tuple(np.ascontiguousarray(each.T) for each in (*matrices, to_coefficients(GRID + 1)))


def solve_each(
    cans: tuple[Floats, ...], releases: tuple[Floats, ...]
) -> tuple[Floats, NDArray[np.int8]]:
    """Solve the releases that are not hard: those that bounce and those that overturn.

    Parameters
    ----------
    cans : tuple of ndarray, shape (1,) or (n,)
        a, c, h; equal cans beside each other are prepared once.
    releases : tuple of ndarray, shape (n,)
        phi, phi_dot, psi_dot, theta_dot.

    Returns
    -------
    numbers : ndarray, shape (n, 6)
        `FIELDS`, and 0 where a release is not solved.
    code : ndarray of int8, shape (n,)
        Index into `reference.integrable.turning_points.OUTCOMES`; `LEFT` where nothing is sure.
    """
    heights, places = np.unique(cans[2], return_inverse=True)
    balance = [part[places] for part in balancing_angle(heights)]
    parts = [np.ascontiguousarray(part) for part in (*cans, *balance)]
    numbers = np.zeros((releases[0].size, len(FIELDS)))
    code = np.full(releases[0].size, LEFT, dtype=np.int8)
    _all(np.stack(releases), np.stack(parts), _waves(), numbers, code)
    return numbers, code


@jit
def _all(
    releases: Floats,
    cans: Floats,
    waves: tuple[Floats, ...],
    numbers: Floats,
    code: NDArray[np.int8],
) -> None:
    """Solve releases one after another; the series of a can last until another can comes."""
    space = Space(
        np.zeros(8),
        np.empty(8),
        np.empty((4, MOST_TERMS)),
        np.empty((5, MOST_TERMS)),
        np.empty(MOST_NODES + 1),
        np.empty(MOST_NODES + 1),
        np.empty(MOST_NODES + 1),
        np.empty((4, MOST_NODES + 1)),
        np.empty((6, MOST_NODES + 1)),
    )
    can, well = space.can, space.well
    known = int(can[0])
    for i in range(code.size):
        j = i if cans.shape[1] > 1 else 0
        a, c, h = cans[0, j], cans[1, j], cans[2, j]
        if not (a == can[0] and c == can[1] and h == can[2]):
            a_p = a + h * h
            whole = a + c * a_p
            can[0], can[1], can[2], can[3], can[4] = a, c, h, c / whole, a_p
            can[5], can[6], can[7] = c + 1.0, a / whole, math.sqrt(1.0 + h * h)
            known = 0
        phi, phi_dot, psi_dot = releases[0, i], releases[1, i], releases[2, i]
        S = math.sin(phi)
        well[0], well[1], well[2] = phi, S * S * psi_dot, psi_dot + releases[3, i]
        well[4], well[5], well[6] = S, math.cos(phi), (cans[3, j] - phi) + cans[4, j]
        well[7] = 0.5 * (can[4] + 1.0) * phi_dot * phi_dot
        falls = phi_dot == 0.0 and force(space) < 0.0
        # a release that moves or rises has its maximum anywhere below pi/2
        terms = terms_for(phi if falls else UPRIGHT)
        if terms > known:
            extend_series(space, known, terms)
            known = terms
        well[3] = first_integral(space, terms)
        if abs(well[3]) > SMALLEST and _decided(space, phi_dot == 0.0):
            refer(space, terms)
            code[i] = _one(space, terms, falls, phi_dot == 0.0, waves, numbers[i])


@jit
def _one(
    space: Space,
    terms: int,
    falls: bool,
    at_rest: bool,
    waves: tuple[Floats, ...],
    result: Floats,
) -> int:
    """Fill the numbers of a release that bounces, and return the code of its outcome."""
    well, phi, below, rise = space.well, space.phi, space.below, space.rise
    state, work = space.state, space.work
    release, climb = well[0], 0.0
    if not falls:
        climb = _turning(space, terms, not falls)
        if climb < 0.0 and _stays_above(space, terms, waves[MOST_NODES // 8]):
            return _OVERTURNED
        if not climb > 0.0:
            return LEFT
        phi[0], below[0] = release + climb, -climb
        evaluate(space, terms, 1)
        well[0], well[1], well[2] = phi[0], state[0, 0], state[1, 0]
        well[4], well[5], well[6] = math.sin(phi[0]), math.cos(phi[0]), well[6] - climb
        well[7] = 0.0
        terms = terms_for(phi[0])
        refer(space, terms)
        if not _decided(space, well[7] != 0.0):
            return LEFT
    high = well[0]
    low = release
    if falls or not at_rest:
        low = _turning(space, terms, climb < 0.0)
    swing = climb if low == release else high - low
    # nearer to the maximum phi_min needs a search of its own
    if not (low > 0.0 and swing >= NEARBY * high):
        return LEFT
    # the fourth root of the quartic, from the slope of g at the maximum and its change
    aside = min(1e-3 * high, 0.5 * swing)
    below[0], phi[0] = aside, high - aside
    evaluate(space, terms, 1)
    near, far = -force(space), state[3, 0]
    drop = far - near
    beyond = near * aside / drop if drop > 0.0 else math.inf
    beyond = min(max(beyond, 4.0 * EPS * high), math.pi - high)
    spread = (high - low + beyond) * (high + low)
    complementary = 2.0 * low * beyond / spread
    if not complementary <= _DEEP:
        return LEFT
    K = 0.5 * math.pi / arithmetic_geometric_mean(1.0, math.sqrt(complementary))
    K1 = 0.5 * math.pi / arithmetic_geometric_mean(1.0, math.sqrt(1.0 - complementary))
    strip = min(math.atan(math.sqrt((high + low) / swing)), K1)
    count = 8 * math.ceil((DECADES * K / (2.0 * math.pi * strip) + 4.0) / 8.0)
    if count > MOST_NODES:
        return LEFT
    place_nodes(space, (low, high, swing), (K, K1, complementary), count)
    phi[count], below[count] = low, swing
    evaluate(space, terms, count + 1)
    factor = 2.0 * math.sqrt(0.5 * (space.can[4] + 1.0) / spread)
    period = turn = total = 0.0
    smallest, least, best, peak = math.inf, 0, -1, 0.0
    for j in range(count):
        S = state[2, j]
        room = S * S * (state[3, j] / rise[j]) / ((phi[j] + low) * (beyond + below[j]))
        if not room > 0.0:
            return LEFT
        time, rate = factor * S / math.sqrt(room), state[0, j] / (S * S)
        work[0, j], work[1, j], work[2, j], work[3, j] = room, time, rate * time, state[1, j] * time
        if room < smallest:
            smallest, least = room, j
        if abs(rate) > abs(peak):
            best, peak = j, rate
        period += work[1, j]
        turn += work[2, j]
        total += work[3, j]
    if not stays_positive(work, count, waves[count // 8 - 1], smallest):
        return LEFT
    for which in range(2):
        j = which * least
        if noise(space, j) > LOST * abs(state[3, j] * below[j]):
            return LEFT
    if unresolved(work, count, waves[count // 8 - 1]):
        return LEFT
    weight = 2.0 * K / count
    bottom, top = state[0, count] / state[2, count] ** 2, well[1] / well[4] ** 2
    if abs(bottom) >= abs(peak):
        peak = bottom
    elif abs(top) >= abs(peak):
        peak = top
    else:
        first = phi[best - 1] if best > 0 else low
        last = phi[best + 1] if best < count - 1 else high
        peak = _peak(space, terms, first, last, peak)
    result[0], result[1], result[2] = weight * period, weight * turn, weight * (total - turn)
    result[3], result[4], result[5] = low, high, peak
    return _FINISHED


@jit
def _decided(space: Space, at_rest: bool) -> bool:
    """Return whether the force at the reference has its digits, and at rest its sign."""
    well = space.well
    q, s = well[1] / well[4], well[2]
    pull = force(space)
    size = 1.0 + (q * q * (1.0 + space.can[4]) + abs(q * s)) / well[4]
    if at_rest and not abs(pull) > _UNSURE * size:
        return False
    return bool(abs(pull) >= POISED * (s * s + q * q))


@jit
def _turning(space: Space, terms: int, up: bool) -> float:
    """Return how far phi rises, or phi_min: the first root of g found, or -1 if none was.

    Upwards by a secant in the rise, downwards in phi^2, in which g sin^2 phi is all but linear. The
    root is the first if g is positive between the turning points, which the caller shows.
    """
    well, phi, below = space.well, space.phi, space.below
    r, moves, pull = well[0], well[7] > 0.0, force(space)
    if up:
        positive, f_positive = 0.0, well[7] if moves else pull
        span = math.log(UPRIGHT / r)
    else:
        positive, f_positive = r * r, -pull * well[4] ** 2
        # from where precession alone would take all the energy
        span = math.log(min(0.5, abs(well[3]) / r))
    negative = f_negative = math.inf
    before = 0.0
    for _ in range(60):
        for j in range(_PLACES):
            share = (j + 1.0) / _PLACES
            if up:
                below[j] = -r * math.expm1(span * share * share)
                phi[j] = r - below[j]
            else:
                phi[j] = r * math.exp(before + (span - before) * share)
                below[j] = r - phi[j]
        evaluate(space, terms, _PLACES)
        for j in range(_PLACES):
            value = _value(space, up, moves, j)
            place = -below[j] if up else phi[j] * phi[j]
            if value <= 0.0:
                negative, f_negative = place, value
                break
            positive, f_positive = place, value
        if up or f_negative <= 0.0:
            break
        before, span = span, span - math.log(8.0)
    if not f_negative <= 0.0:
        return -1.0
    last, f_last, at, f_at = negative, f_negative, positive, f_positive
    if abs(f_negative) < abs(f_positive):
        last, f_last, at, f_at = positive, f_positive, negative, f_negative
    for _ in range(80):
        place = at
        if f_at != f_last:
            place -= f_at * (at - last) / (f_at - f_last)
        if abs(place - at) <= EPS * at:
            break
        if not min(positive, negative) < place < max(positive, negative):
            place = 0.5 * (positive + negative) if up else math.sqrt(positive * negative)
        last, f_last, at = at, f_at, place
        below[0] = -at if up else r - math.sqrt(at)
        phi[0] = r + at if up else math.sqrt(at)
        evaluate(space, terms, 1)
        f_at = _value(space, up, moves, 0)
        if f_at > 0.0:
            positive = at
        else:
            negative = at
        if f_at == 0.0 or abs(positive - negative) <= EPS * at:
            break
    return float(at if up else math.sqrt(at))


@jit
def _stays_above(space: Space, terms: int, waves: Floats) -> bool:
    """Return whether g is shown to be positive from the release up to pi/2."""
    r, work, smallest = space.well[0], space.work, math.inf
    moves, span = space.well[7] > 0.0, math.log(UPRIGHT / r)
    for j in range(GRID + 1):
        share = 0.5 * (1.0 - math.cos(math.pi * j / GRID))
        space.below[j] = -r * math.expm1(span * share) if j else -BESIDE * r
        space.phi[j] = r - space.below[j]
    count = waves.shape[0]
    evaluate(space, terms, count)
    for j in range(count):
        work[0, j] = _value(space, True, moves, j)
        smallest = min(smallest, work[0, j])
    return stays_positive(work, count, waves, smallest)


@jit
def _value(space: Space, up: bool, moves: bool, j: int) -> float:
    """Return what has the sign of g and is nearly linear, at a node."""
    slope = space.state[3, j]
    if not up:
        return float(slope * space.state[2, j] ** 2)
    return float(slope * space.below[j] if moves else -slope)


@jit
def _peak(space: Space, terms: int, first: float, last: float, peak: float) -> float:
    """Return the precession rate of largest magnitude between two nutations around a node."""
    r, phi, below, state = space.well[0], space.phi, space.below, space.state
    for _ in range(24):
        for j in range(_PLACES):
            phi[j] = first + (last - first) * j / (_PLACES - 1.0)
            below[j] = max(r - phi[j], 1e-20 * r)
        evaluate(space, terms, _PLACES)
        best = 0
        for j in range(_PLACES):
            rate = state[0, j] / state[2, j] ** 2
            if abs(rate) >= abs(peak):
                best, peak = j, rate
        first, last = phi[max(best - 1, 0)], phi[min(best + 1, _PLACES - 1)]
        if last - first <= 1e-6 * last:
            break
    return peak
