"""The exact bounce of one release after another, compiled to machine code.

The same mathematics as `reference.integrable.cycle` in scalars, for releases that are not hard: the
well referred to phi_max, phi_min by a secant in phi^2, the midpoint rule on the elliptic clock.
Each value is checked as there; a release with a value in doubt is left to the arrays of
`reference.integrable.cycle`, which know what to do with it. No release knows of another, so that it
has the same bits alone and in a batch.

Needs numba (`reference.numerics.compiled`).
"""

import math
from functools import cache

import numpy as np
from numpy.typing import NDArray

from reference.equations.balancing_angle import balancing_angle
from reference.equations.nonholonomic import ROUND_OFFS
from reference.integrable.compiled_potential import (
    CAN,
    EPS,
    WELL,
    evaluate,
    extend_series,
    force,
    noise,
    refer,
    terms_for,
)
from reference.integrable.effective_potential import POISED
from reference.integrable.frobenius import MOST_TERMS
from reference.integrable.quadrature import DECADES, LOST, TAIL, to_cosines
from reference.integrable.turning_points import NEARBY, SMALLEST
from reference.numerics.compiled import jit
from reference.problem.states import Floats

FIELDS = ("period", "angle_of_turn", "rotation_turn", "phi_min", "phi_max", "peak_psi_dot")
"""Columns of the results of `solve_each`."""

_NODES = 64
"""Releases that need more nodes are left to the arrays."""
_MOST_TERMS = MOST_TERMS
_PLACES = 8
"""Trial nutations evaluated together, in search of a change of sign."""
_UNSURE = 4.0 * ROUND_OFFS * EPS
_POISED, _NEARBY, _SMALLEST, _LOST = POISED, NEARBY, SMALLEST, LOST
_DECADES, _TAIL = DECADES, TAIL


@cache
def _waves() -> tuple[Floats, ...]:
    """Return the matrices of `to_cosines` of 8, 16, 24, ... nodes."""
    return tuple(to_cosines(n) for n in range(8, _NODES + 1, 8))


def solve_each(
    cans: tuple[Floats, ...], releases: tuple[Floats, ...]
) -> tuple[Floats, NDArray[np.bool_]]:
    """Solve the releases that are not hard.

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
    solved : ndarray of bool, shape (n,)
    """
    heights, places = np.unique(cans[2], return_inverse=True)
    balance = [part[places] for part in balancing_angle(heights)]
    parts = [np.ascontiguousarray(part) for part in (*cans, *balance)]
    numbers = np.zeros((releases[0].size, len(FIELDS)))
    solved = np.zeros(releases[0].size, dtype=np.bool_)
    _all(*parts, *releases, _waves(), numbers, solved)
    return numbers, solved


@jit
def _all(  # type: ignore[no-untyped-def]
    a, c, h, balance, rest, phi, phi_dot, psi_dot, theta_dot, waves, numbers, solved
):
    """Solve releases one after another; the series of a can last until another can comes."""
    can, well = np.zeros(CAN), np.empty(WELL)
    series, polynomials = np.empty((4, _MOST_TERMS)), np.empty((5, _MOST_TERMS))
    state, work = np.empty((4, _NODES + 1)), np.empty((6, _NODES + 1))
    nodes = np.empty((3, _NODES + 1))
    known = 0
    for i in range(phi.size):
        j = i if a.size > 1 else 0
        if not (a[j] == can[0] and c[j] == can[1] and h[j] == can[2]):
            a_p = a[j] + h[j] ** 2
            whole = a[j] + c[j] * a_p
            can[0], can[1], can[2], can[3], can[4] = a[j], c[j], h[j], c[j] / whole, a_p
            can[5], can[6], can[7] = c[j] + 1.0, a[j] / whole, math.sqrt(1.0 + h[j] ** 2)
            known = 0
        S = math.sin(phi[i])
        well[0], well[1], well[2] = phi[i], S * S * psi_dot[i], psi_dot[i] + theta_dot[i]
        well[4], well[5], well[6] = S, math.cos(phi[i]), (balance[j] - phi[i]) + rest[j]
        well[7] = 0.5 * (can[4] + 1.0) * phi_dot[i] ** 2
        falls = well[7] == 0.0 and force(can, well) < 0.0
        # a release that moves or rises has its maximum anywhere below pi/2
        terms = terms_for(phi[i] if falls else 0.5 * math.pi)
        if terms > known:
            extend_series(can, known, terms, series)
            known = terms
        solved[i] = _one(
            can, well, series, terms, falls, polynomials, state, work, nodes, waves, numbers[i]
        )


@jit
def _one(  # type: ignore[no-untyped-def]
    can, well, series, terms, falls, polynomials, state, work, nodes, waves, result
):
    """Fill the numbers of a release, and return whether they are sure."""
    phi, below, rise = nodes[0], nodes[1], nodes[2]
    release, at_rest = well[0], well[7] == 0.0
    refer(series, terms, well, True, polynomials)
    if not (abs(well[3]) > _SMALLEST and _decided(can, well, at_rest)):
        return False
    climb = 0.0
    if not falls:
        climb = _turning(can, well, polynomials, terms, True, state, work, phi, below)
        if not climb > 0.0:
            return False
        phi[0], below[0] = release + climb, -climb
        evaluate(can, well, polynomials, terms, phi, below, 1, state, work)
        well[0], well[1], well[2] = phi[0], state[0, 0], state[1, 0]
        well[4], well[5], well[6] = math.sin(phi[0]), math.cos(phi[0]), well[6] - climb
        well[7] = 0.0
        terms = terms_for(phi[0])
        refer(series, terms, well, False, polynomials)
        if not _decided(can, well, False):
            return False
    high = well[0]
    low = release
    if falls or not at_rest:
        low = _turning(can, well, polynomials, terms, False, state, work, phi, below)
    swing = climb if low == release else high - low
    # nearer to the maximum phi_min needs a search of its own
    if not (low > 0.0 and swing >= _NEARBY * high):
        return False
    # the fourth root of the quartic, from the slope and its change at the maximum
    aside = min(1e-3 * high, 0.5 * swing)
    below[0], below[1] = 1e-20 * aside, aside
    phi[0], phi[1] = high - below[0], high - below[1]
    evaluate(can, well, polynomials, terms, phi, below, 2, state, work)
    near, far = state[3, 0], state[3, 1]
    drop = far - near
    beyond = near * aside / drop if drop > 0.0 else math.inf
    beyond = min(max(beyond, 4.0 * EPS * high), math.pi - high)
    spread = (high - low + beyond) * (high + low)
    complementary = 2.0 * low * beyond / spread
    if not complementary <= 0.5:
        return False
    K = 0.5 * math.pi / _mean(1.0, math.sqrt(complementary))
    K1 = 0.5 * math.pi / _mean(1.0, math.sqrt(1.0 - complementary))
    strip = min(math.atan(math.sqrt((high + low) / swing)), K1)
    count = 8 * int(math.ceil((_DECADES * K / (2.0 * math.pi * strip) + 4.0) / 8.0))
    if count > _NODES:
        return False
    _clock(low, high, swing, K, K1, complementary, count, phi, rise, below)
    phi[count], below[count] = low, swing
    evaluate(can, well, polynomials, terms, phi, below, count + 1, state, work)
    factor = 2.0 * math.sqrt(0.5 * (can[4] + 1.0) / spread)
    period = turn = total = 0.0
    smallest, least, best, peak = math.inf, 0, -1, 0.0
    for j in range(count):
        S = state[2, j]
        room = S * S * (state[3, j] / rise[j]) / ((phi[j] + low) * (beyond + below[j]))
        if not room > 0.0:
            return False
        time, rate = factor * S / math.sqrt(room), state[0, j] / (S * S)
        work[0, j], work[1, j], work[2, j], work[3, j] = room, time, rate * time, state[1, j] * time
        if room < smallest:
            smallest, least = room, j
        if abs(rate) > abs(peak):
            best, peak = j, rate
        period += work[1, j]
        turn += work[2, j]
        total += work[3, j]
    if not _positive(work[0], count, waves[count // 8 - 1], smallest):
        return False
    for j in (0, least):
        lost = noise(can, well, phi[j], below[j], state[0, j], state[1, j])
        if lost > _LOST * abs(state[3, j] * below[j]):
            return False
    if _rough(work, count, waves[count // 8 - 1]):
        return False
    weight = 2.0 * K / count
    bottom, top = state[0, count] / state[2, count] ** 2, well[1] / well[4] ** 2
    if abs(bottom) >= abs(peak):
        peak = bottom
    elif abs(top) >= abs(peak):
        peak = top
    else:
        first = phi[best - 1] if best > 0 else low
        last = phi[best + 1] if best < count - 1 else high
        peak = _peak(can, well, polynomials, terms, first, last, peak, state, work, phi, below)
    result[0], result[1], result[2] = weight * period, weight * turn, weight * (total - turn)
    result[3], result[4], result[5] = low, high, peak
    return True


@jit
def _decided(can, well, at_rest):  # type: ignore[no-untyped-def]
    """Return whether the force at the reference has its digits, and at rest its sign."""
    q, s = well[1] / well[4], well[2]
    pull = force(can, well)
    size = 1.0 + (q * q * (1.0 + can[4]) + abs(q * s)) / well[4]
    if at_rest and not abs(pull) > _UNSURE * size:
        return False
    return abs(pull) >= _POISED * (s * s + q * q)


@jit
def _turning(can, well, polynomials, terms, up, state, work, phi, below):  # type: ignore[no-untyped-def]
    """Return how far phi rises, or phi_min: the first root of g found, or zero.

    Upwards by a secant in the rise, downwards in phi^2, in which g sin^2 phi is all but linear. The
    root is the first if g is positive between the turning points, which the caller shows.
    """
    r, moves = well[0], well[7] > 0.0
    pull = force(can, well)
    if up:
        positive, f_positive = 0.0, well[7] if moves else pull
        span = math.log(0.5 * math.pi / r)
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
        evaluate(can, well, polynomials, terms, phi, below, _PLACES, state, work)
        for j in range(_PLACES):
            value = _value(up, moves, below[j], state, j)
            place = -below[j] if up else phi[j] * phi[j]
            if value <= 0.0:
                negative, f_negative = place, value
                break
            positive, f_positive = place, value
        if up or f_negative <= 0.0:
            break
        before, span = span, span - math.log(8.0)
    if not f_negative <= 0.0:
        return 0.0
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
        evaluate(can, well, polynomials, terms, phi, below, 1, state, work)
        f_at = _value(up, moves, below[0], state, 0)
        if f_at > 0.0:
            positive = at
        else:
            negative = at
        if f_at == 0.0 or abs(positive - negative) <= EPS * at:
            break
    return at if up else math.sqrt(at)


@jit
def _value(up, moves, below, state, j):  # type: ignore[no-untyped-def]
    """Return what has the sign of g and is nearly linear, at a node."""
    if not up:
        return state[3, j] * state[2, j] ** 2
    return state[3, j] * below if moves else -state[3, j]


@jit
def _mean(x: float, y: float) -> float:
    """Return the arithmetic-geometric mean of two positive numbers."""
    for _ in range(40):
        if abs(x - y) <= 4.0 * EPS * x:
            break
        x, y = 0.5 * (x + y), math.sqrt(x * y)
    return 0.5 * (x + y)


@jit
def _clock(low, high, swing, K, K1, complementary, nodes, phi, rise, gap):  # type: ignore[no-untyped-def]
    """Fill the nutations of the nodes, and their distances from phi_min and phi_max."""
    q = math.exp(-math.pi * K / K1)
    z2, z3, z4 = 1.0, 1.0, 1.0
    sign = 1.0
    for n in range(1, 4):
        sign = -sign
        weight, square = q ** (n * (n + 1)), q ** (n * n)
        z2 += weight
        z3 += 2.0 * square
        z4 += 2.0 * sign * square
    s_factor, c_factor, d_factor = (z3 / z4) ** 2, (z2 / z4) ** 2, (z2 / z3) ** 2
    w1, w2, w3, w4, w6, w9 = q * q, q**6, q**12, q**4, q, q**9
    for j in range((nodes + 1) // 2):
        e = math.exp(math.pi * K / (2.0 * K1) * (j + 0.5) / nodes)
        d = 1.0 / e
        e2, d2 = e * e, d * d
        e3, d3 = e * e2, d * d2
        e5, d5 = e3 * e2, d3 * d2
        e7, d7 = e5 * e2, d5 * d2
        e4, d4 = e2 * e2, d2 * d2
        e6, d6 = e4 * e2, d4 * d2
        t1 = 0.5 * (e - d - w1 * (e3 - d3) + w2 * (e5 - d5) - w3 * (e7 - d7))
        t2 = 0.5 * (e + d + w1 * (e3 + d3) + w2 * (e5 + d5) + w3 * (e7 + d7))
        u1, u2, u3 = w6 * (e2 + d2), w4 * (e4 + d4), w9 * (e6 + d6)
        t3, t4 = 1.0 + u1 + u2 + u3, 1.0 - u1 + u2 - u3
        sn2, cn2 = s_factor * (t1 / t2) ** 2, c_factor * (t4 / t2) ** 2
        dn2 = d_factor * (t3 / t2) ** 2
        for mirrored in range(2):
            i = nodes - 1 - j if mirrored else j
            s = cn2 / dn2 if mirrored else sn2
            k = complementary * sn2 / dn2 if mirrored else cn2
            denominator = swing * k + 2.0 * low
            rise[i] = 2.0 * low * swing * s / denominator
            gap[i] = swing * (high + low) * k / denominator
            phi[i] = low + rise[i] if rise[i] < gap[i] else high - gap[i]


@jit
def _positive(room, nodes, waves, smallest):  # type: ignore[no-untyped-def]
    """Return whether g is shown to be positive between the nodes, as `brackets.stays_positive`."""
    bend = largest = last = 0.0
    for m in range(nodes):
        value = 0.0
        for j in range(nodes):
            value += waves[m, j] * room[j]
        value = abs(value)
        bend += m * m * value
        largest = max(largest, value)
        if m >= nodes - 3:
            last = max(last, value)
    tail = 8.0 * last + nodes * EPS * largest
    return smallest > tail + (math.pi / (nodes - 1)) ** 2 / 8.0 * bend


@jit
def _rough(work, nodes, waves):  # type: ignore[no-untyped-def]
    """Return whether the two highest harmonics of an integrand have not yet decayed."""
    for row in range(1, 4):
        size = high = higher = 0.0
        for j in range(nodes):
            size += abs(work[row, j])
            high += waves[nodes - 2, j] * work[row, j]
            higher += waves[nodes - 1, j] * work[row, j]
        # waves have the weight 2/n of a coefficient
        if max(abs(high), abs(higher)) * 0.5 * nodes > _TAIL * size:
            return True
    return False


@jit
def _peak(can, well, polynomials, terms, first, last, peak, state, work, phi, below):  # type: ignore[no-untyped-def]
    """Return the precession rate of largest magnitude between two nutations around a node."""
    r = well[0]
    for _ in range(24):
        for j in range(_PLACES):
            phi[j] = first + (last - first) * j / (_PLACES - 1.0)
            below[j] = max(r - phi[j], 1e-20 * r)
        evaluate(can, well, polynomials, terms, phi, below, _PLACES, state, work)
        best = 0
        for j in range(_PLACES):
            rate = state[0, j] / state[2, j] ** 2
            if abs(rate) >= abs(peak):
                best, peak = j, rate
        first, last = phi[max(best - 1, 0)], phi[min(best + 1, _PLACES - 1)]
        if last - first <= 1e-6 * last:
            break
    return peak
