"""Kernels of the smooth integrator: a Picard-Chebyshev step and its dense output, compiled.

The mathematics of `reference.smooth.picard_chebyshev` and `reference.smooth.dense_output`, node by
node instead of array by array. What differs: the convergence is judged after every round, for it
costs next to nothing here. Imported where a caller asks for compiled code.
"""

from math import atan, atanh, cos, cosh, exp, inf, isnan, sin, sqrt, tanh

import numpy as np
from numpy.typing import NDArray

from reference.numerics.chebyshev import derivative, integrator, points, to_coefficients
from reference.numerics.compiled import inner, jit
from reference.problem.states import Floats
from reference.smooth import picard_chebyshev as scheme

_N = scheme.NODES
_POINTS = points(_N)
# from values at the nodes to integrals, of which each row is what one value adds to all of them
_WEIGHTS = np.ascontiguousarray(integrator(_N).T)
_TO_COEFFICIENTS = np.ascontiguousarray(to_coefficients(_N).T)
_TO_SLOPES = np.ascontiguousarray((derivative(_N) @ to_coefficients(_N)).T)
_EPS = float(np.finfo(float).eps)
_TINY = float(np.finfo(float).tiny)
_BLIND, _MOST = scheme.BLIND_ROUNDS, scheme.MOST_ITERATIONS
_STANDS, _TOLERATED, _HOPELESS = scheme.STANDS, scheme.TOLERATED, scheme.HOPELESS
_SLOW, _CLOSEST, _ROUNDED = scheme.SLOW, scheme.CLOSEST, scheme.ROUNDED
_RESOLVED = scheme.RESOLVED
# Newton on a monotone, nearly linear function, as in `reference.smooth.dense_output`.
_MOST_ROUNDS = 60
# Values of which the largest is looked for at once; a divisor of the number of nodes.
_LANES = 16


@inner
def multiplied(rows: Floats, matrix: Floats, out: Floats) -> None:
    """Write the product of `rows`, shape (m, n), and a matrix, shape (n, n), to `out`."""
    n = rows.shape[1]
    for i in range(rows.shape[0]):
        for j in range(n):
            out[i, j] = 0.0
        for k in range(n):
            factor = rows[i, k]
            for j in range(n):
                out[i, j] += factor * matrix[k, j]


@inner
def integrated(rows: Floats, out: Floats) -> None:
    """Write the integrals of `rows`, shape (m, nodes), from -1 to each node to `out`.

    `multiplied` of a constant: the compiler sees that no result is written over the matrix, and
    terms are added in their order, four at a time, so that a sum is seldom put down on the way.
    """
    for i in range(rows.shape[0]):
        for j in range(_N):
            out[i, j] = 0.0
        for k in range(0, _N, 4):
            a, b, c, d = rows[i, k], rows[i, k + 1], rows[i, k + 2], rows[i, k + 3]
            for j in range(_N):
                total = out[i, j] + a * _WEIGHTS[k, j] + b * _WEIGHTS[k + 1, j]
                out[i, j] = total + c * _WEIGHTS[k + 2, j] + d * _WEIGHTS[k + 3, j]


@inner
def _round(forms: Floats, short: float, start: Floats, half: float, y: Floats, new: Floats) -> None:
    """Write one round of the fixed point to `new`: the start and the integral of the field at y.

    Loops of algebra alone, over arrays that nothing else can be, are done several nodes at once.
    """
    field, integral = np.empty((3, _N)), np.empty((3, _N))
    a, b, c, d = forms[0, 0], forms[0, 1], forms[0, 2], forms[0, 3]
    e, f, g, weight = forms[2, 1], forms[2, 2], forms[2, 3], forms[5, 1]
    for j in range(_N):
        field[1, j] = sin(short - y[4, j])
    for j in range(_N):
        T, s = y[0, j], y[3, j]
        S = 2 * T / (1 + T * T)
        m = T * S
        q = y[2, j] / S
        G = a * T + b * S + c * m + d
        Q = e * S + f * m + g
        field[0, j] = q * (q * G + s * Q) - weight * S * field[1, j]
    integrated(field[:1], integral[:1])
    for j in range(_N):
        new[1, j] = start[1] + half * integral[0, j]
    integrated(new[1:2], integral[:1])
    for j in range(_N):
        new[0, j] = start[0] * exp(half * integral[0, j])
    a, b, c = forms[1, 0], forms[1, 1], forms[1, 2]
    e, f, g = forms[3, 1], forms[3, 2], forms[6, 1]
    for j in range(_N):
        T, Phi, sweep, s = new[0, j], new[1, j], y[2, j], y[3, j]
        S = 2 * T / (1 + T * T)
        m = T * S
        W = a * T + b * S + c * m
        M = e * S + f * m
        field[0, j] = Phi * (g * S * S * s - sweep * M)
        field[1, j] = Phi * (s * M + sweep / S * W)
        field[2, j] = S * Phi
    integrated(field, integral)
    for i in range(3):
        for j in range(_N):
            new[i + 2, j] = start[i + 2] + half * integral[i, j]


@inner
def _largest(magnitudes: Floats) -> float:
    """Return the largest of as many magnitudes as there are nodes; nan if one is no number."""
    lanes = np.zeros(_LANES)
    for first in range(0, _N, _LANES):
        for lane in range(_LANES):
            here = magnitudes[first + lane]
            # a comparison with what is no number is false
            lanes[lane] = lanes[lane] if lanes[lane] >= here or isnan(lanes[lane]) else here
    largest = 0.0
    for lane in range(_LANES):
        if lanes[lane] > largest or isnan(lanes[lane]):
            largest = lanes[lane]
    return largest


@inner
def _scales(short: float, y: Floats, length: float, scale: Floats) -> None:
    """Write the magnitudes of (T, Phi, b, s, d), as `picard_chebyshev.scales`."""
    least = inf
    for i in range(5):
        scale[i] = _largest(np.abs(y[i]))
    for j in range(y.shape[1]):
        least = min(least, y[0, j])
    precession = scale[2] / (abs(least) + _TINY)
    swung = precession * (precession + scale[3])
    scale[1] = max(scale[1], _ROUNDED * min(swung * length, precession)) + _TINY
    scale[2] += _TINY
    scale[3] += scale[2]
    scale[4] = max(abs(short), scale[4]) + _TINY


@inner
def bare_bounce(swing: float, start: Floats, length: float, y: Floats) -> None:
    """Write the motion without gravity to y, the first guess of a step."""
    T, Phi = start[0], start[1]
    q = start[2] * (1 + T * T) / (2 * T)
    speed = sqrt(Phi * Phi + swing * q * q)
    for i in range(5):
        for j in range(y.shape[1]):
            y[i, j] = start[i]
    if speed * length < _SLOW:
        return
    phase = atanh(min(max(Phi / speed, -_CLOSEST), _CLOSEST))
    lowest = cosh(phase)
    for j in range(y.shape[1]):
        u = phase + speed * length / 2 * (_POINTS[j] + 1)
        y[0, j] = T * cosh(u) / lowest
        y[1, j] = speed * tanh(u)
        y[4, j] += 2 * (atan(y[0, j]) - atan(T))


@jit
def converge(
    forms: Floats,
    constants: tuple[float, float],
    start: Floats,
    length: float,
    guess: tuple[Floats, Floats],
) -> tuple[float, int, int, Floats, Floats]:
    """Iterate a step to its fixed point.

    Parameters
    ----------
    forms : ndarray, shape (7, 4)
    constants : tuple of float
        `short` and `swing` of the equations.
    start : ndarray, shape (5,)
    length : float
        In sigma.
    guess : tuple of ndarray, shapes (5, nodes) and (5, 1)
        Values and magnitudes from which to start; without a value: from the bare bounce.

    Returns
    -------
    shrink : float
        Zero of a step that converged, else the factor by which to shorten it.
    count, harmonics : int
    values, scale : ndarray, shapes (5, nodes) and (5, 1)
    """
    short, swing = constants
    n = _POINTS.size
    y, old, scale, apart = np.empty((5, n)), np.empty((5, n)), np.empty((5, 1)), np.empty(n)
    guessed = guess[0].size > 0
    if guessed:
        y[:] = guess[0]
        scale[:] = guess[1]
    else:
        bare_bounce(swing, start, length, y)
    count, before = 0, inf
    while True:
        old, y = y, old
        _round(forms, short, start, length / 2, old, y)
        count += 1
        if not guessed and count < _BLIND:
            continue
        if not guessed:
            _scales(short, y, length, scale[:, 0])
        moved = 0.0
        for i in range(5):
            for j in range(_N):
                apart[j] = abs(y[i, j] - old[i, j])
            share = _largest(apart) / scale[i, 0]
            if share > moved or isnan(share):
                moved = share
        if moved < _STANDS or (moved < _TOLERATED and moved > before / 2):
            break
        if not moved < _HOPELESS:
            return 0.3, count, 0, y, scale
        if count >= _MOST:
            return 0.5, count, 0, y, scale
        before = moved
    multiplied(y, _TO_COEFFICIENTS, old)
    harmonics = n - 1
    while harmonics > 0 and not _stands_out(old[:, harmonics], scale[:, 0]):
        harmonics -= 1
    return (0.6 if harmonics >= n - 2 else 0.0), count, harmonics, y, scale


@inner
def _stands_out(coefficients: Floats, scale: Floats) -> bool:
    """Return whether a harmonic stands out of the round-off of any quantity."""
    return bool((np.abs(coefficients) > _RESOLVED * scale).any())


@jit
def quadratures(values: Floats, length: float, origin: tuple[float, float, float]) -> Floats:
    """Return a step with its time, precession, and precession plus rotation, shape (8, nodes).

    Parameters
    ----------
    values : ndarray, shape (5, nodes)
    length : float
        In sigma.
    origin : tuple of float
        The three at the start.
    """
    n = values.shape[1]
    rows, out = np.empty((3, n)), np.empty((8, n))
    for j in range(n):
        T = values[0, j]
        S = 2 * T / (1 + T * T)
        rows[0, j], rows[1, j], rows[2, j] = S, values[2, j] / S, S * values[3, j]
    out[:5] = values
    integrated(rows, out[5:])
    for i in range(3):
        for j in range(n):
            out[5 + i, j] = out[5 + i, j] * (length / 2) + origin[i]
    return out


@jit
def forces(
    can: tuple[float, float, float, float, float],
    nutation: tuple[Floats, Floats],
    precession: tuple[Floats, Floats],
    spin: Floats,
) -> Floats:
    """Return the force of the plane, in the world, as `reaction_force.contact_force`.

    Parameters
    ----------
    can : tuple of float
        a, c, h, k and c_p.
    nutation, precession : tuple of ndarray, shape (n,)
        The angle and its rate.
    spin : ndarray, shape (n,)

    Returns
    -------
    ndarray, shape (3, n)
        In m g.
    """
    a, c, h, k, c_p = can
    a_p = a + h * h
    out = np.empty((3, spin.size))
    for j in range(spin.size):
        Phi, Psi, s = nutation[1][j], precession[1][j], spin[j]
        S, C, half = sin(nutation[0][j]), cos(nutation[0][j]), sin(nutation[0][j] / 2)
        m = 2 * (half * half)
        square = a_p * S * C + (c_p * S + h * (1 + 2 * C)) * m
        drive = square * (Psi * Psi) - (c_p * S + h * C) * s * Psi + h * S - C
        pull = drive / (a_p + 1)
        lateral = s - Psi * (m + h * S)
        along = -(S + h * C) * pull - (C - h * S) * (Phi * Phi) - Psi * lateral
        aside = -k * Phi * (a * Psi * S + c * h * (s - Psi * m))
        cosine, sine = cos(precession[0][j]), sin(precession[0][j])
        out[0, j], out[1, j] = along * cosine - aside * sine, along * sine + aside * cosine
        out[2, j] = 1 + (C - h * S) * pull - (S + h * C) * (Phi * Phi)
    return out


@inner
def value_of(series: Floats, x: float) -> float:
    """Return the value of a Chebyshev series at one place."""
    b1 = b2 = 0.0
    for k in range(series.size - 1, 0, -1):
        b1, b2 = 2 * x * b1 - b2 + series[k], b1
    return float(x * b1 - b2 + series[0])


@jit
def values_at(values: Floats, x: Floats) -> Floats:
    """Return rows of values at the nodes, shape (m, nodes), at places in [-1, 1], shape (m, n)."""
    series, out = np.empty_like(values), np.empty((values.shape[0], x.size))
    multiplied(values, _TO_COEFFICIENTS, series)
    if x.size == 1:
        for i in range(values.shape[0]):
            out[i, 0] = value_of(series[i], x[0])
        return out
    # the same sums, of several places at once
    b1, b2 = np.empty(x.size), np.empty(x.size)
    for i in range(values.shape[0]):
        b1[:], b2[:] = 0.0, 0.0
        for k in range(series.shape[1] - 1, 0, -1):
            coefficient = series[i, k]
            for j in range(x.size):
                b2[j] = 2 * x[j] * b1[j] - b2[j] + coefficient
            b1, b2 = b2, b1
        for j in range(x.size):
            out[i, j] = x[j] * b1[j] - b2[j] + series[i, 0]
    return out


@jit
def root(values: Floats, level: float, node: int) -> float:
    """Return where a quantity takes a value between two nodes, as `dense_output.Piece.root`."""
    series, slopes = np.empty((1, values.size)), np.empty((1, values.size))
    row = values.reshape((1, values.size))
    multiplied(row, _TO_COEFFICIENTS, series)
    multiplied(row, _TO_SLOPES, slopes)
    noise = _EPS * np.abs(series).sum()
    series[0, 0] -= level
    low, high = _POINTS[node], _POINTS[node + 1]
    left, right = value_of(series[0], low), value_of(series[0], high)
    if left * right >= 0:
        return float(low if abs(left) < abs(right) else high)
    x = low + (high - low) * left / (left - right)
    for _ in range(_MOST_ROUNDS):
        value, gradient = value_of(series[0], x), value_of(slopes[0], x)
        if abs(value) <= noise:
            break
        if (value < 0) == (left < 0):
            low = x
        else:
            high = x
        new = x - value / gradient if gradient != 0 else low
        if not low < new < high:
            new = (low + high) / 2
        moved, x = abs(new - x), new
        if moved <= 2 * _EPS:
            break
    return float(x)


@jit
def sign_changes(row: Floats) -> NDArray[np.int64]:
    """Return the nodes after which a quantity changes its sign, both neighbours being nonzero."""
    count, out = 0, np.empty(row.size, dtype=np.int64)
    for j in range(row.size - 1):
        if row[j] * row[j + 1] < 0:
            out[count] = j
            count += 1
    return out[:count]
