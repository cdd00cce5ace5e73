"""Kernels of the dense output of the hybrid integrator: its rows at given times.

The mathematics of `reference.nonsmooth.segments.SegmentsPath`, time by time. Imported where a
caller asks for compiled code.
"""

import numpy as np

from reference.equations.kernels import CONTACT_ROWS, FORCE, contact_at
from reference.equations.state_vector import (
    LEAN,
    PSI,
    ROWS,
    TIME,
    TOTAL,
    U1,
    U2,
    W1,
    W2,
    W3,
    Index,
)
from reference.nonsmooth.radau_iia import AT_START, STAGES
from reference.numerics.compiled import jit
from reference.problem.states import Floats

_AT_START = AT_START
_EPS = float(np.finfo(float).eps)
# Halvings that find an instant in a piece to round-off.
_HALVINGS = 60


@jit
def _place(series: Floats, cut: float, span: float, target: float) -> float:
    """Return where in a piece a time since its start is, by Newton's method within a bisection."""
    if target >= span or span == 0.0:
        return cut
    low, high, noise = 0.0, cut, 0.0
    for k in range(series.size):
        noise += 2 * _EPS * abs(series[k])
    c = cut * max(target / span, 0.0)
    for _ in range(_HALVINGS):
        x, total, slope = 2 * c - 1, -target, 0.0
        before, wave, second_before, second = 1.0, x, 1.0, 2 * x
        for k in range(1, series.size):
            total += series[k] * (wave - _AT_START[k])
            # the derivative of a wave of the first kind is one of the second
            slope += series[k] * 2 * k * second_before
            before, wave = wave, 2 * x * wave - before
            second_before, second = second, 2 * x * second - second_before
        if total < 0:
            low = c
        else:
            high = c
        better = c - total / slope
        new = better if low <= better <= high else (low + high) / 2
        if abs(total) <= noise or abs(new - c) <= 4 * _EPS * (1e-3 + c):
            break
        c = new
    return min(max(c, 0.0), cut)


@jit
def state_at(start: Floats, series: Floats, c: float) -> Floats:
    """Return the state, shape (13,), at one place of a piece, as `Segment.at`."""
    out, x = start.copy(), 2 * c - 1
    before, wave = 1.0, x
    for k in range(1, STAGES + 1):
        for i in range(ROWS):
            out[i] += series[i, k] * (wave - _AT_START[k])
        before, wave = wave, 2 * x * wave - before
    return out


@jit
def rows_at(
    starts: Floats, series: Floats, cuts: Floats, spans: Floats, number: Index, times: Floats
) -> Floats:
    """Return all rows at given times, each in its piece.

    Parameters
    ----------
    starts : ndarray, shape (pieces, 13)
    series : ndarray, shape (pieces, 13, STAGES + 1)
    cuts, spans : ndarray, shape (pieces,)
        Where pieces end, and the times that they take.
    number : ndarray of int, shape (n,)
    times : ndarray, shape (n,)

    Returns
    -------
    ndarray, shape (13, n)
    """
    out = np.empty((ROWS, times.size))
    for j in range(times.size):
        piece = number[j]
        own = series[piece]
        x = 2 * _place(own[TIME], cuts[piece], spans[piece], times[j] - starts[piece, TIME]) - 1
        for i in range(ROWS):
            out[i, j] = starts[piece, i]
        before, wave = 1.0, x
        for k in range(1, STAGES + 1):
            for i in range(ROWS):
                out[i, j] += own[i, k] * (wave - _AT_START[k])
            before, wave = wave, 2 * x * wave - before
    return out


@jit
def states_of(E: Floats, slips: Index, turns: Index, y: Floats) -> Floats:
    """Return what is told of states (13, n), of a can whose rolling meets no resistance.

    Parameters
    ----------
    E : ndarray
    slips, turns : ndarray of int, shape (n,)
        The laws that are in force.
    y : ndarray, shape (13, n)

    Returns
    -------
    ndarray, shape (12, n)
        phi, phi', psi, psi', theta, theta', spin, slip and force in the world.
    """
    out, D, here = np.empty((12, y.shape[1])), np.empty((10, 6)), np.empty(CONTACT_ROWS)
    for j in range(y.shape[1]):
        T = np.exp(y[LEAN, j])
        S, C = 2 * T / (1 + T * T), -np.tanh(y[LEAN, j])
        contact_at(E, (slips[j] != 0, turns[j], False), y, j, D, here)
        psi, psi_dot = y[PSI, j], y[W1, j] / S
        cosine, sine = np.cos(psi), np.sin(psi)
        u1, u2 = y[U1, j] * slips[j], y[U2, j] * slips[j]
        F1, F2 = here[FORCE] / S, here[FORCE + 1] / S
        out[0, j], out[1, j], out[2, j], out[3, j] = 2 * np.arctan(T), -y[W2, j], psi, psi_dot
        out[4, j], out[5, j] = y[TOTAL, j] - psi, y[W3, j] - psi_dot * C
        out[6, j] = y[W3, j] + y[W1, j] * T
        out[7, j], out[8, j] = u1 * cosine - u2 * sine, u1 * sine + u2 * cosine
        out[9, j], out[10, j] = F1 * cosine - F2 * sine, F1 * sine + F2 * cosine
        out[11, j] = here[FORCE + 2] / S
    return out
