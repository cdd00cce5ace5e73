"""Kernels of the hybrid integrator: samples of the margins of its events.

The quantities of `reference.nonsmooth.events`, at one place of a piece or at all at which it is
looked at. Imported where a caller asks for compiled code.
"""

from math import inf, nan

import numpy as np
from numpy.typing import NDArray

from reference.equations.compiled_equations import Laws
from reference.equations.kernels import (
    CONTACT_ROWS,
    FORCE,
    MOBILITY,
    MOMENT,
    contact_at,
    sticking_at,
)
from reference.equations.state_vector import LEAN, ROWS, TIME, U1, U2, W1, W2, W3
from reference.nonsmooth.events import (
    FLAT,
    FLAT_AND_PUSHED,
    LEAST_MOBILITY,
    LIMITS,
    LOOKS,
    NEAR_ZERO,
    EventKind,
)
from reference.nonsmooth.level_spin import STILL
from reference.nonsmooth.radau_iia import AT_START, STAGES, basis_at
from reference.nonsmooth.slip_onset import BEYOND
from reference.numerics.compiled import jit
from reference.problem.states import Floats

_BASIS = np.ascontiguousarray(basis_at(LOOKS).T)
_AT_START, _BEYOND, _STILL = AT_START, BEYOND, STILL
_FLAT, _PUSHED, _LEAST_MOBILITY, _NEAR_ZERO = FLAT, FLAT_AND_PUSHED, LEAST_MOBILITY, NEAR_ZERO

KINDS = tuple(EventKind)
_AT = {kind: index for index, kind in enumerate(KINDS)}
_MAXIMUM, _MINIMUM, _HORIZON = (
    _AT[EventKind.MAXIMUM],
    _AT[EventKind.MINIMUM],
    _AT[EventKind.HORIZON],
)
_OVERTURNED, _FLAT_KIND = _AT[EventKind.OVERTURNED], _AT[EventKind.FLAT]
_SLIPS, _LIFTS, _JAMS = _AT[EventKind.SLIPS], _AT[EventKind.LIFTS], _AT[EventKind.JAMS]
_HELD, _TURNS, _ROLLS = _AT[EventKind.HELD], _AT[EventKind.TURNS], _AT[EventKind.ROLLS]
_IS_LIMIT = np.array([kind in LIMITS for kind in KINDS])


@jit
def margins_at(
    E: Floats,
    laws: Laws,
    y: Floats,
    limits: tuple[float, bool],
    j: int,
    D: Floats,
    here: Floats,
    out: Floats,
) -> None:
    """Write the margin of each event at column j of states to `out`; nan where there is none."""
    t_end, bilateral = limits
    slips, turns, rests = laws
    mu, drilling, resistance = E[15], E[16], E[17]
    for k in range(out.shape[0]):
        out[k, j] = nan
    out[_OVERTURNED, j] = -y[LEAN, j]
    out[_FLAT_KIND, j] = y[LEAN, j] - (_FLAT if bilateral else _PUSHED)
    out[_HORIZON, j] = t_end - y[TIME, j]
    if not rests:
        out[_MAXIMUM, j], out[_MINIMUM, j] = -y[W2, j], y[W2, j]
    if not slips and drilling == 0 and resistance == 0:
        sticking_at(E, y, j, here)
    else:
        contact_at(E, laws, y, j, D, here)
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
    if drilling > 0 and turns != 0:
        T = np.exp(y[LEAN, j])
        S, C = 2 * T / (1 + T * T), -np.tanh(y[LEAN, j])
        out[_HELD, j] = turns * (S * y[W1, j] + C * y[W3, j])
    elif drilling > 0:
        out[_TURNS, j] = (1 + _BEYOND) * drilling * N - abs(here[MOMENT + 2])


@jit
def sampled(
    E: Floats, laws: Laws, start: Floats, series: Floats, limits: tuple[float, bool]
) -> tuple[bool, Floats, NDArray[np.bool_]]:
    """Sample the margins of a piece, and say which of them may become zero.

    Returns
    -------
    begun : bool
        Whether every sample has the directions that its contact needs.
    values : ndarray, shape (kinds, n)
    looked_for : ndarray of bool, shape (kinds,)
        Whether there may be an event of a kind: a margin that falls through zero between two
        samples or dips towards it, or of a limit one that is negative from the start.
    """
    n, slips, rests, begun = _BASIS.shape[1], laws[0], laws[2], True
    y = np.empty((ROWS, n))
    for i in range(ROWS):
        for j in range(n):
            y[i, j] = 0.0
        for k in range(STAGES + 1):
            for j in range(n):
                y[i, j] += series[i, k] * _BASIS[k, j]
        for j in range(n):
            y[i, j] += start[i]
    D, here, values = np.empty((10, 6)), np.empty(CONTACT_ROWS), np.empty((_IS_LIMIT.size, n))
    for j in range(n):
        margins_at(E, laws, y, limits, j, D, here, values)
        if slips and y[U1, j] == 0 and y[U2, j] == 0:
            begun = False
        if E[17] > 0 and not rests:
            T = np.exp(y[LEAN, j])
            S, C = 2 * T / (1 + T * T), -np.tanh(y[LEAN, j])
            level = np.hypot(C * y[W1, j] - S * y[W3, j], y[W2, j])
            if level <= _STILL * max(abs(y[W1, j]), abs(y[W2, j]), abs(y[W3, j])):
                begun = False
    looked_for = np.zeros(_IS_LIMIT.size, np.bool_)
    for kind in range(_IS_LIMIT.size):
        v = values[kind]
        if _IS_LIMIT[kind] and v[0] <= 0:
            looked_for[kind] = True
        for j in range(1, n):
            if v[j - 1] > 0 and v[j] <= 0:
                looked_for[kind] = True
        for j in range(1, n - 1):
            bend, slope = v[j - 1] - 2 * v[j] + v[j + 1], (v[j + 1] - v[j - 1]) / 2
            least = min(v[j - 1], v[j], v[j + 1])
            if least > 0 and bend > 0 and abs(slope) <= bend:
                drop = least - (v[j] - slope * slope / (2 * bend))
                if least <= _NEAR_ZERO * drop:
                    looked_for[kind] = True
    return begun, values, looked_for


@jit
def margin_of(
    E: Floats,
    laws: Laws,
    start: Floats,
    series: Floats,
    limits: tuple[float, bool],
    kind: int,
    c: float,
) -> float:
    """Return the margin of an event at one place of a piece."""
    y, out = np.empty((ROWS, 1)), np.empty((_IS_LIMIT.size, 1))
    before, wave, x = 1.0, 2 * c - 1, 2 * c - 1
    for i in range(ROWS):
        y[i, 0] = start[i]
    for k in range(1, STAGES + 1):
        for i in range(ROWS):
            y[i, 0] += series[i, k] * (wave - _AT_START[k])
        before, wave = wave, 2 * x * wave - before
    margins_at(E, laws, y, limits, 0, np.empty((10, 6)), np.empty(CONTACT_ROWS), out)
    return float(out[kind, 0])
