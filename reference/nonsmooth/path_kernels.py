"""Kernels of the dense output of the hybrid integrator: its rows at given times.

The mathematics of `reference.nonsmooth.segments.SegmentsPath`, time by time. Imported where a
caller asks for compiled code.
"""

import numpy as np

from reference.equations.state_vector import ROWS, TIME, Index
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
