"""Kernels of the dense output of the hybrid integrator: its rows at given times.

The mathematics of `reference.nonsmooth.segments.SegmentsPath`, time by time. Imported where a
caller asks for compiled code.
"""

from math import isinf, isnan

import numpy as np

from reference.equations.compiled_equations import CONTACT_ROWS, FORCE
from reference.equations.kernels import contact_of, false_and_zero
from reference.equations.reaction_force import VANISHED
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
from reference.nonsmooth.event_kernels import state_at
from reference.nonsmooth.radau_iia import AT_START, STAGES
from reference.numerics.compiled import inner, jit
from reference.problem.states import Floats

_AT_START = AT_START
_EPS = float(np.finfo(float).eps)
# Halvings that find an instant in a piece to round-off.
_HALVINGS = 60
# Samples of a piece; share of the highest of them from which the top of a lower one may be the
# highest, as in `reference.analysis.bounces`.
_NODES, _WORTH = 4, 0.7
# A top is placed to this share of its bracket, whose square is a round-off of its height; a part
# as small of a height is that round-off.
_PLACED, _FLAT = 3e-8, 1e-14
_MOST_SECTIONS, _GOLDEN = 60, (3 - 5**0.5) / 2

Work = tuple[Floats, Floats, Floats]
"""A state, and arrays for its contact."""


@inner
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
    rests, _ = false_and_zero(E)
    for j in range(y.shape[1]):
        T = np.exp(y[LEAN, j])
        S, C = 2 * T / (1 + T * T), -np.tanh(y[LEAN, j])
        contact_of(E, (slips[j] != 0, turns[j], rests), y, j, D, here)
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


Pieces = tuple[Floats, Floats, Floats, Floats, Index, Index]
"""Starts, series, cuts and spans of pieces, and of each whether it slips and which way it turns."""


@inner
def _measured(E: Floats, of: Pieces, piece: int, c: float, work: Work, out: Floats) -> None:
    """Write psi' and the friction ratio at a place of a piece to `out`."""
    starts, series, _, _, slips, turns = of
    y, D, here = work
    state_at(starts[piece], series[piece], c, y)
    T = np.exp(y[LEAN, 0])
    out[0] = y[W1, 0] * (1 + T * T) / (2 * T)
    rests, only = false_and_zero(E)
    contact_of(E, (slips[piece] != 0, turns[piece], rests), y, only, D, here)
    friction, N = np.hypot(here[FORCE], here[FORCE + 1]), here[FORCE + 2]
    out[1] = friction / N if VANISHED * friction < N or isnan(N) else np.inf


@inner
def _magnitude(
    E: Floats, of: Pieces, time: float, near: int, which: int, work: Work, out: Floats
) -> float:
    """Return the magnitude of one of both at a time, in a piece near to a given one."""
    starts, series, cuts, spans = of[:4]
    piece = near
    while piece + 1 < cuts.size and starts[piece + 1, TIME] <= time:
        piece += 1
    while piece > 0 and starts[piece, TIME] > time:
        piece -= 1
    c = _place(series[piece, TIME], cuts[piece], spans[piece], time - starts[piece, TIME])
    _measured(E, of, piece, c, work, out)
    return float(abs(out[which]))


@inner
def _top(
    E: Floats,
    of: Pieces,
    bracket: tuple[float, float, float],
    near: int,
    which: int,
    work: Work,
    out: Floats,
) -> float:
    """Return the largest magnitude between two times, by parabolas within golden sections.

    R. P. Brent, Algorithms for Minimization without Derivatives, 1973, chapter 5.
    """
    low, best, high = bracket
    tolerance = _PLACED * (high - low)
    second = third = best
    top = _magnitude(E, of, best, near, which, work, out)
    at_second = at_third = top
    moved = before = 0.0
    for _ in range(_MOST_SECTIONS):
        middle = (low + high) / 2
        if abs(best - middle) <= 2 * tolerance - (high - low) / 2:
            break
        p, q, parabolic = 0.0, 0.0, False
        if abs(before) > tolerance:
            r = (best - second) * (at_third - top)
            q = (best - third) * (at_second - top)
            p = (best - third) * q - (best - second) * r
            q = 2 * (q - r)
            if q > 0:
                p = -p
            q = abs(q)
            parabolic = abs(p) < abs(q * before / 2) and q * (low - best) < p < q * (high - best)
        if parabolic:
            before, moved = moved, p / q
            if min(best + moved - low, high - best - moved) < 2 * tolerance:
                moved = tolerance if best < middle else -tolerance
        else:
            before = high - best if best < middle else low - best
            moved = _GOLDEN * before
        step = moved if abs(moved) >= tolerance else (tolerance if moved > 0 else -tolerance)
        trial = best + step
        value = _magnitude(E, of, trial, near, which, work, out)
        if value >= top:
            if trial < best:
                high = best
            else:
                low = best
            third, at_third, second, at_second = second, at_second, best, top
            best, top = trial, value
            continue
        if trial < best:
            low = trial
        else:
            high = trial
        if value >= at_second or second == best:
            third, at_third, second, at_second = second, at_second, trial, value
        elif value >= at_third or third in (best, second):
            third, at_third = trial, value
    return top


@jit
def peaks_of(E: Floats, of: Pieces, extrema: Floats, tops: Index) -> Floats:
    """Return the largest rates of precession, with their signs, and friction ratios of bounces.

    The rules are those of `reference.analysis.bounces`, for motions without mirror symmetry.

    Parameters
    ----------
    E : ndarray
    of : tuple
    extrema : ndarray, shape (n,)
        Times of the extrema of phi.
    tops : ndarray of int, shape (m + 1,)
        Which of them are maxima.

    Returns
    -------
    ndarray, shape (2, m)
    """
    cuts = of[2]
    work, out = (np.empty((ROWS, 1)), np.empty((10, 6)), np.empty(CONTACT_ROWS)), np.empty(2)
    most = _NODES * cuts.size + 1
    times, owner, values, count = np.empty(most), np.empty(most, np.int64), np.empty((2, most)), 0
    for node in range(most):
        piece = min(node // _NODES, cuts.size - 1)
        part = (node - _NODES * piece) / _NODES
        _measured(E, of, piece, part * cuts[piece], work, out)
        time = work[0][TIME, 0]
        if count == 0 or time > times[count - 1]:
            times[count], owner[count] = time, piece
            values[0, count], values[1, count] = out
            count += 1
    peaks, node = np.zeros((2, tops.size - 1)), 0
    for bounce in range(tops.size - 1):
        left, right = extrema[tops[bounce]], extrema[tops[bounce + 1]]
        for number in range(tops[bounce], tops[bounce + 1] + 1):
            near = owner[min(node, count - 1)]
            for which in range(2):
                _magnitude(E, of, extrema[number], near, which, work, out)
                if abs(out[which]) > abs(peaks[which, bounce]):
                    peaks[which, bounce] = out[which]
        while node < count and times[node] < left:
            node += 1
        first = node
        while node < count and times[node] < right:
            node += 1
        for which in range(2):
            highest = 0.0
            for at in range(first, node):
                highest = max(highest, abs(values[which, at]))
            for at in range(first, node):
                here = abs(values[which, at])
                if here > abs(peaks[which, bounce]):
                    peaks[which, bounce] = values[which, at]
                before = abs(values[which, at - 1]) if at > first else 0.0
                after = abs(values[which, at + 1]) if at + 1 < node else 0.0
                if not (here >= before and here >= after and here >= _WORTH * highest):
                    continue
                sign = 1.0 if values[which, at] > 0 else -1.0
                low = times[at - 1] if at > first else left
                high = times[at + 1] if at + 1 < node else right
                # what is flat to round-off, as where the rim slips, has no top to look for
                if isinf(here) or here - min(before, after) <= _FLAT * here or not low < high:
                    continue
                bracket = low, times[at], high
                top = _top(E, of, bracket, owner[at], which, work, out)
                if top > abs(peaks[which, bounce]):
                    peaks[which, bounce] = sign * top
    return peaks
