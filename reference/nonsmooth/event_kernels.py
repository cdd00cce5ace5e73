"""Kernels of the hybrid integrator: the events of a piece.

The quantities and rules of `reference.nonsmooth.events`, in numbers instead of arrays.
Imported where a caller asks for compiled code.
"""

from math import inf, isnan, nan

import numpy as np

from reference.equations.compiled_equations import CONTACT_ROWS, FORCE, MOBILITY, MOMENT, Laws
from reference.equations.kernels import contact_of, false_and_zero
from reference.equations.state_vector import LEAN, ROWS, TIME, U1, U2, W1, W2, W3
from reference.nonsmooth.events import (
    BEGUN,
    FLAT,
    FLAT_AND_PUSHED,
    KINDS,
    LEAST_MOBILITY,
    LIMITS,
    LOOKS,
    NEAR_ZERO,
    OF_THE_STATE,
    EventKind,
)
from reference.nonsmooth.level_spin import STILL
from reference.nonsmooth.radau_iia import AT_START, STAGES, basis_at
from reference.nonsmooth.slip_onset import BEYOND
from reference.numerics.compiled import inner, jit
from reference.problem.states import Floats

_BASIS = np.ascontiguousarray(basis_at(LOOKS).T)
_PLACES = len(LOOKS)
_AT_START, _BEYOND, _STILL, _BEGUN = AT_START, BEYOND, STILL, BEGUN
_FLAT, _PUSHED, _LEAST_MOBILITY, _NEAR_ZERO = FLAT, FLAT_AND_PUSHED, LEAST_MOBILITY, NEAR_ZERO

# Every so many places are looked at first, and all only where a margin of the contact is not as
# far from zero at these as this share of what it changes. A heuristic: a margin that falls by more
# than that between two of these places and rises again is missed. The polynomial of a resolved step
# hardly bends so; `tests/reference/test_events.py` holds it against a look at all places.
_COARSE, _CLEAR = 4, 0.5
# phi' below this share of the turning is its round-off, and has no extrema.
_NOISE = 2e-15

Limits = tuple[float, bool]
"""The horizon, and whether the plane may pull."""
Contact = tuple[Floats, Floats]
"""Arrays for a contact."""

_AT = {kind: index for index, kind in enumerate(KINDS)}
_MAXIMUM, _MINIMUM, _HORIZON = (
    _AT[EventKind.MAXIMUM],
    _AT[EventKind.MINIMUM],
    _AT[EventKind.HORIZON],
)
_OVERTURNED, _FLAT_KIND = _AT[EventKind.OVERTURNED], _AT[EventKind.FLAT]
_SLIPS, _LIFTS, _JAMS = _AT[EventKind.SLIPS], _AT[EventKind.LIFTS], _AT[EventKind.JAMS]
_HELD, _TURNS, _ROLLS = _AT[EventKind.HELD], _AT[EventKind.TURNS], _AT[EventKind.ROLLS]
_OF_THE_STATE = np.array([kind in OF_THE_STATE for kind in KINDS])
_LOOKS = np.array(LOOKS)
# Rounds of the root, each at worst a halving, and distance that is a round-off of a place.
_MOST_ROUNDS, _NEAREST = 100, 1e-15
# Sections of a dip: what is left of it is as flat as round-off.
_SECTIONS, _GOLDEN = 40, (5**0.5 - 1) / 2
_IS_LIMIT = np.array([kind in LIMITS for kind in KINDS])


@inner
def _of_state(E: Floats, laws: Laws, y: Floats, limits: Limits, j: int, out: Floats) -> None:
    """Write the margin of each event that needs the state alone to column j of `out`."""
    t_end, bilateral = limits
    _, turns, rests = laws
    out[_OVERTURNED, j] = -y[LEAN, j]
    out[_FLAT_KIND, j] = y[LEAN, j] - (_FLAT if bilateral else _PUSHED)
    out[_HORIZON, j] = t_end - y[TIME, j]
    if not rests:
        out[_MAXIMUM, j], out[_MINIMUM, j] = -y[W2, j], y[W2, j]
    if E[16] > 0 and turns != 0:
        T = np.exp(y[LEAN, j])
        S, C = 2 * T / (1 + T * T), -np.tanh(y[LEAN, j])
        out[_HELD, j] = turns * (S * y[W1, j] + C * y[W3, j])


@inner
def _of_contact(
    E: Floats, laws: Laws, y: Floats, bilateral: bool, j: int, work: Contact, out: Floats
) -> None:
    """Write the margin of each event that needs the contact to column j of `out`."""
    slips, turns, rests = laws
    mu, drilling, resistance = E[15], E[16], E[17]
    D, here = work
    contact_of(E, laws, y, j, D, here)
    F1, F2, N = here[FORCE], here[FORCE + 1], here[FORCE + 2]
    if rests:
        limit = (1 + _BEYOND) * resistance * N
        out[_ROLLS, j] = limit - np.hypot(here[MOMENT], here[MOMENT + 1])
    if not bilateral:
        out[_LIFTS, j] = N
    if slips or drilling > 0 or resistance > 0:
        out[_JAMS, j] = here[MOBILITY] - _LEAST_MOBILITY
    if not slips and mu < inf:
        out[_SLIPS, j] = (1 + _BEYOND) * mu * N - np.hypot(F1, F2)
    if drilling > 0 and turns == 0:
        out[_TURNS, j] = (1 + _BEYOND) * drilling * N - abs(here[MOMENT + 2])


@inner
def _sampled(
    E: Floats, laws: Laws, start: Floats, series: Floats, limits: Limits, values: Floats
) -> None:
    """Write the margins of a piece at all places at which it is looked at to `values`.

    What begins with the piece has no direction there, and so no contact: nan. So are margins that
    need the contact where a few samples show all of them far from zero.
    """
    n = _PLACES
    y, row = np.empty((ROWS, n)), np.empty(n)
    # no margin depends on the place of the contact or the works
    y[U2 + 1 :] = 0.0
    for i in range(U2 + 1):
        for j in range(_PLACES):
            row[j] = series[i, 0] * _BASIS[0, j]
        # four terms at a time, in their order: a sum is seldom put down on the way
        for k in range(1, STAGES + 1, 4):
            a, b, c, d = series[i, k], series[i, k + 1], series[i, k + 2], series[i, k + 3]
            for j in range(_PLACES):
                total = row[j] + a * _BASIS[k, j] + b * _BASIS[k + 1, j]
                row[j] = total + c * _BASIS[k + 2, j] + d * _BASIS[k + 3, j]
        for j in range(_PLACES):
            y[i, j] = row[j] + start[i]
    values[:] = nan
    for j in range(n):
        _of_state(E, laws, y, limits, j, values)
    # the least of |phi'| that is more than the round-off of the turning
    turning, nutation = 0.0, 0.0
    for j in range(n):
        nutation = max(nutation, abs(y[W2, j]))
        turning = max(turning, abs(y[W1, j]), abs(y[W3, j]))
    if nutation <= _NOISE * turning:
        values[_MAXIMUM], values[_MINIMUM] = nan, nan
    work = np.empty((10, 6)), np.empty(CONTACT_ROWS)
    clear = True
    for j in range(0, n, _COARSE):
        if _begun(E, laws, y, j):
            _of_contact(E, laws, y, limits[1], j, work, values)
        else:
            clear = False
    for kind in range(_IS_LIMIT.size):
        least, largest = inf, -inf
        if not _OF_THE_STATE[kind]:
            for j in range(0, n, _COARSE):
                least, largest = min(least, values[kind, j]), max(largest, values[kind, j])
            clear &= isnan(values[kind, 0]) or least > _CLEAR * (largest - least)
    if clear:
        # none of them comes near to zero: nothing to be looked at more closely
        for kind in range(_IS_LIMIT.size):
            if not _OF_THE_STATE[kind]:
                values[kind] = nan
        return
    for j in range(n):
        if j % _COARSE != 0 and _begun(E, laws, y, j):
            _of_contact(E, laws, y, limits[1], j, work, values)


@inner
def _begun(E: Floats, laws: Laws, y: Floats, j: int) -> bool:
    """Return whether what moves has a direction, and so the contact a force."""
    begun: bool = not laws[0] or y[U1, j] != 0 or y[U2, j] != 0
    if E[17] > 0 and not laws[2]:
        T = np.exp(y[LEAN, j])
        S, C = 2 * T / (1 + T * T), -np.tanh(y[LEAN, j])
        level = np.hypot(C * y[W1, j] - S * y[W3, j], y[W2, j])
        begun &= level > _STILL * max(abs(y[W1, j]), abs(y[W2, j]), abs(y[W3, j]))
    return begun


@jit
def state_at(start: Floats, series: Floats, c: float, y: Floats) -> None:
    """Write the state at one place of a piece to y, shape (13, 1), as `Segment.at`."""
    before, wave, x = 1.0, 2 * c - 1, 2 * c - 1
    for i in range(ROWS):
        y[i, 0] = start[i]
    for k in range(1, STAGES + 1):
        for i in range(ROWS):
            y[i, 0] += series[i, k] * (wave - _AT_START[k])
        before, wave = wave, 2 * x * wave - before


@inner
def _bracket(
    E: Floats,
    laws: Laws,
    start: Floats,
    series: Floats,
    limits: Limits,
    v: Floats,
    kind: int,
    brackets: Floats,
) -> int:
    """Write between which places a margin falls through zero, given its samples; return how many.

    The rules are those of `events._zeros`.
    """
    n, first, count = v.size, 0, 0
    while first < n and isnan(v[first]):
        first += 1
    if kind == _HELD and first < n and v[first] <= 0:
        first += 1
    if first == n:
        return 0
    least, largest = v[first], v[first]
    for j in range(first + 1, n):
        least, largest = min(least, v[j]), max(largest, v[j])
    if least > 0 and least > _NEAR_ZERO * (largest - least):
        # no parabola through three of them comes near zero
        return 0
    if _IS_LIMIT[kind] and v[first] <= 0 and least < 0:
        brackets[count, 0], brackets[count, 1] = min(_BEGUN, _LOOKS[first]), _LOOKS[first]
        count += 1
    for j in range(first + 1, n):
        if v[j - 1] > 0 and v[j] <= 0:
            brackets[count, 0], brackets[count, 1] = _LOOKS[j - 1], _LOOKS[j]
            count += 1
    for j in range(first + 1, n - 1):
        bend, slope = v[j - 1] - 2 * v[j] + v[j + 1], (v[j + 1] - v[j - 1]) / 2
        least = min(v[j - 1], v[j], v[j + 1])
        if not (least > 0 and bend > 0 and abs(slope) <= bend):
            continue
        if least > _NEAR_ZERO * (least - (v[j] - slope * slope / (2 * bend))):
            continue
        # the bottom of the dip, by sections in the golden ratio
        low, high = _LOOKS[j - 1], _LOOKS[j + 1]
        for _ in range(_SECTIONS):
            left, right = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
            at_left = _margin(E, laws, start, series, limits, kind, left)
            if at_left < _margin(E, laws, start, series, limits, kind, right):
                high = right
            else:
                low = left
        if _margin(E, laws, start, series, limits, kind, (low + high) / 2) < 0:
            brackets[count, 0], brackets[count, 1] = _LOOKS[j - 1], (low + high) / 2
            count += 1
    return count


@inner
def _zero(
    E: Floats,
    laws: Laws,
    start: Floats,
    series: Floats,
    limits: Limits,
    kind: int,
    left: float,
    right: float,
) -> float:
    """Return where a margin falls through zero, to round-off, as `events._root`.

    T. R. Chandrupatla, Advances in Engineering Software 28, 1997, 145-149.
    """
    a, b = right, left
    fa = _margin(E, laws, start, series, limits, kind, a)
    fb = _margin(E, laws, start, series, limits, kind, b)
    if fb <= 0:
        return left
    if fa >= 0:
        return right
    c, fc, share = a, fa, 0.5
    for _ in range(_MOST_ROUNDS):
        x = a + share * (b - a)
        fx = _margin(E, laws, start, series, limits, kind, x)
        if (fx > 0) == (fa > 0):
            c, fc = a, fa
        else:
            c, fc, b, fb = b, fb, a, fa
        a, fa = x, fx
        nearest = a if abs(fa) < abs(fb) else b
        tolerance = (_NEAREST * (1 + abs(nearest))) / abs(b - a)
        if 2 * tolerance > 1 or fa == 0:
            return nearest
        share = 0.5
        xi, phi = (a - b) / (c - b), (fa - fb) / (fc - fb)
        if phi * phi < xi and (1 - phi) * (1 - phi) < 1 - xi:
            share = fa / (fb - fa) * fc / (fb - fc)
            share += (c - a) / (b - a) * fa / (fc - fa) * fb / (fc - fb)
        share = min(max(share, tolerance), 1 - tolerance)
    return nearest


@inner
def _margin(
    E: Floats,
    laws: Laws,
    start: Floats,
    series: Floats,
    limits: Limits,
    kind: int,
    c: float,
) -> float:
    """Return the margin of an event at one place of a piece."""
    y, out = np.empty((ROWS, 1)), np.empty((_IS_LIMIT.size, 1))
    state_at(start, series, c, y)
    _, only = false_and_zero(E)
    out[:] = nan
    _of_state(E, laws, y, limits, only, out)
    if not _OF_THE_STATE[kind]:
        work = np.empty((10, 6)), np.empty(CONTACT_ROWS)
        _of_contact(E, laws, y, limits[1], only, work, out)
    return float(out[kind, 0])


@jit
def located(E: Floats, laws: Laws, start: Floats, series: Floats, limits: Limits) -> Floats:
    """Return the events of a piece in order, each with its kind and its place, shape (n, 2)."""
    n = _LOOKS.size
    values, found, brackets = np.empty((_IS_LIMIT.size, n)), np.empty((4 * n, 2)), np.empty((n, 2))
    _sampled(E, laws, start, series, limits, values)
    total = 0
    for kind in range(_IS_LIMIT.size):
        for number in range(_bracket(E, laws, start, series, limits, values[kind], kind, brackets)):
            left, right = brackets[number, 0], brackets[number, 1]
            place = _zero(E, laws, start, series, limits, kind, left, right)
            at = total
            while at > 0 and found[at - 1, 1] > place:
                found[at, 0], found[at, 1] = found[at - 1, 0], found[at - 1, 1]
                at -= 1
            found[at, 0], found[at, 1] = kind, place
            total += 1
    return found[:total]
