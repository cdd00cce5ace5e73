"""Kernels of the hybrid integrator: one collocation step, by fixed point.

The equations of a step at the Radau points (`reference.nonsmooth.radau_iia`) are solved by
iterating y = y0 + h integral of the field, which needs no derivatives. The friction of a slow slip
turns with it: where that is stiff the slip alone is found by Newton's method in each round. Where
that does not converge either, Newton's method for all (`radau_iia.step`) takes the step. Imported
where a caller asks for compiled code.
"""

from math import inf, isnan
from typing import Any

import numpy as np

from reference.equations.compiled_equations import CONTACT_ROWS, SLIPPING, Laws
from reference.equations.kernels import contact_of, false_and_zero, rates_at
from reference.equations.rim_kernels import WORK_ROWS, rim_rates, slipping_at
from reference.equations.state_vector import (
    FLOOR,
    LEAN,
    LEAST_SLIP,
    PSI,
    QUIET,
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
from reference.nonsmooth.hybrid_integrator import RESOLVED
from reference.nonsmooth.radau_iia import (
    ALMOST,
    HOPELESS,
    LEAST,
    STAGES,
    STANDS,
    STEP,
    integrator,
    points,
    to_coefficients,
)
from reference.numerics.compiled import inner
from reference.problem.states import Floats

# Rounds after which a fixed point is given up, and after which each must gain a factor of two.
_MOST, _PATIENCE = 30, 8
# A change this small that shrinks as the last two did leaves less than this to the next round: a
# third of what stands, for it is foreseen and not seen.
_NEAR, _FORESEEN = 1e-6, STANDS / 3
# A can moves steadily where a first round finds its lean and velocities changed by no more than
# this share of the angular velocity and the length, the round-off of its rates. More rounds would
# make a noise of it that long steps do not bear.
_ROUNDING = 2e-16
# Of the angular velocity: changes of parts that are smaller are measured against this share.
_PART = 1e-3
# A round of a stiff slip that leaves more than this of the last one's change is worth a new matrix.
_SLOWLY = 0.3
# Imaginary step of a slip, over its speed: nothing is subtracted.
_STEP = STEP
_INTEGRATOR = np.ascontiguousarray(integrator().T)
_TO_COEFFICIENTS = np.ascontiguousarray(to_coefficients()[:, 1:].T)
_POINTS = points()
_STANDS, _ALMOST, _HOPELESS, _LEAST = STANDS, ALMOST, HOPELESS, LEAST
_FLOOR, _LEAST_SLIP, _QUIET, _RESOLVED = FLOOR, LEAST_SLIP, QUIET, RESOLVED


@inner
def extrapolated(series: Floats, harmonics: int, cut: float, ratio: float, out: Floats) -> None:
    """Write the change in a step by the polynomial of another, shape (13, STAGES), to `out`.

    Parameters
    ----------
    series : ndarray, shape (13, STAGES + 1)
    harmonics : int
        How many of them are more than round-off, which would grow beyond the other step.
    cut : float
        Where in the other step this one begins.
    ratio : float
        The length of this step over that of the other.
    out : ndarray, shape (13, STAGES)
    """
    out[:] = 0.0
    origin = 2 * cut - 1
    before_0, wave_0 = 1.0, origin
    x, before, wave = np.empty(STAGES), np.ones(STAGES), np.empty(STAGES)
    for j in range(STAGES):
        x[j] = 2 * (cut + ratio * _POINTS[j]) - 1
        wave[j] = x[j]
    for k in range(1, harmonics + 1):
        for i in range(ROWS):
            factor = series[i, k]
            for j in range(STAGES):
                out[i, j] += factor * (wave[j] - wave_0)
        for j in range(STAGES):
            before[j], wave[j] = wave[j], 2 * x[j] * wave[j] - before[j]
        before_0, wave_0 = wave_0, 2 * origin * wave_0 - before_0


@inner
def evaluate(
    E: Floats,
    laws: Laws,
    y: Floats,
    f: Floats,
    work: tuple[Floats, Floats],
    along: bool,
) -> None:
    """Write the rates of states to f."""
    D, here = work
    for j in range(y.shape[1]):
        contact_of(E, laws, y, j, D, here)
        rates_at(E, laws, y, j, here, f, along)


@inner
def _integrate(f: Floats, i: int, length: float, out: Floats) -> None:
    """Write the integral of row i of rates to that of `out`."""
    for j in range(STAGES):
        out[i, j] = 0.0
    for k in range(STAGES):
        factor = length * f[i, k]
        for j in range(STAGES):
            out[i, j] += factor * _INTEGRATOR[k, j]


@inner
def _slip_matrix(E: Floats, y: Floats, length: float, matrix: Floats) -> None:
    """Write I - h A J of the slips at the points, J by imaginary steps, to a matrix (32, 32)."""
    column: Any = np.empty((ROWS, 1), np.complex128)
    here: Any = np.empty(CONTACT_ROWS, np.complex128)
    _, only = false_and_zero(E)
    for k in range(STAGES):
        shift = _STEP * np.hypot(y[U1, k], y[U2, k])
        for of in range(2):
            for i in range(ROWS):
                column[i, 0] = y[i, k]
            column[U1 + of, 0] += 1j * shift
            slipping_at(E, column, only, here)
            for by in range(2):
                rate = here[SLIPPING + by].imag / shift
                if by != of:
                    rate += y[W1, k] if by == 0 else -y[W1, k]
                for j in range(STAGES):
                    matrix[2 * j + by, 2 * k + of] = -length * _INTEGRATOR[k, j] * rate
    for i in range(2 * STAGES):
        matrix[i, i] += 1.0


@inner
def _factor(matrix: Floats, order: Index) -> None:
    """Factor a matrix in place, with exchange of rows in an order that is written."""
    n = order.size
    for i in range(n):
        pivot = i
        for below in range(i + 1, n):
            if abs(matrix[below, i]) > abs(matrix[pivot, i]):
                pivot = below
        order[i] = pivot
        if pivot != i:
            for k in range(n):
                matrix[i, k], matrix[pivot, k] = matrix[pivot, k], matrix[i, k]
        for below in range(i + 1, n):
            matrix[below, i] /= matrix[i, i]
            factor = matrix[below, i]
            for k in range(i + 1, n):
                matrix[below, k] -= factor * matrix[i, k]


@inner
def _solve(matrix: Floats, order: Index, b: Floats) -> None:
    """Solve a factored system in place."""
    n = order.size
    for i in range(n):
        pivot = order[i]
        b[i], b[pivot] = b[pivot], b[i]
    for i in range(n):
        for k in range(i):
            b[i] -= matrix[i, k] * b[k]
    for i in range(n - 1, -1, -1):
        for k in range(i + 1, n):
            b[i] -= matrix[i, k] * b[k]
        b[i] /= matrix[i, i]


@inner
def collocate(
    E: Floats,
    laws: Laws,
    start: Floats,
    core: Index,
    length: float,
    arrays: tuple[Floats, Floats, Floats, Floats, Floats, Floats],
    choices: tuple[bool, bool],
) -> int:
    """Take a step by fixed point, and return its rounds; negative where it does not converge.

    The friction of a slow slip turns with it: where that is stiff the slip alone is found by
    Newton's method in each round, 32 unknowns with a matrix that is kept while it converges, and
    all that is not stiff goes on by fixed point.

    Parameters
    ----------
    E : ndarray
    laws : tuple
    start : ndarray, shape (13,)
    core : ndarray of int
        Rows that the rates depend on.
    length : float
    arrays : tuple of ndarray
        The change at the points, shape (13, STAGES), first a guess and then the result; its
        coefficients, shape (13, STAGES + 1); and work space.
    choices : tuple of bool
        Whether the place of the contact and the works are wanted, and whether the slip is stiff.
    """
    along, stiff = choices
    moments = E[16] > 0 or E[17] > 0
    b = np.empty(WORK_ROWS * STAGES)
    n = 2 * STAGES if stiff else 0
    matrix, order, residual = np.empty((n, n)), np.empty(n, np.int64), np.empty(n)
    patience = 2 * _PATIENCE if stiff else _PATIENCE
    slow = True
    change, series, y, f, D, here = arrays
    work, size, tangent = (D, here), np.empty(ROWS), np.empty(STAGES)
    without, _ = false_and_zero(E)
    before, gain, stands, steady, rounds = inf, 1.0, False, False, 0
    for i in range(U2 + 1, ROWS):
        for j in range(STAGES):
            change[i, j] = 0.0
    while rounds < _MOST and not stands:
        rounds += 1
        for i in range(ROWS):
            for j in range(STAGES):
                y[i, j] = start[i] + change[i, j]
        _sizes(y, size, stiff)
        if moments:
            evaluate(E, laws, y, f, work, without)
        else:
            rim_rates(E, laws[0], y, b, f)
        if stiff:
            if slow:
                _slip_matrix(E, y, length, matrix)
                _factor(matrix, order)
            for j in range(STAGES):
                for i in range(2):
                    total = change[U1 + i, j]
                    for k in range(STAGES):
                        total -= length * _INTEGRATOR[k, j] * f[U1 + i, k]
                    residual[2 * j + i] = total
            _solve(matrix, order, residual)
        # what is known of the turning is used at once for what follows from it
        for i in range(W1, U2 + 1):
            if i <= W3 or (i >= U1 and not stiff):
                _integrate(f, i, length, y)
        if stiff:
            for j in range(STAGES):
                for i in range(2):
                    y[U1 + i, j] = change[U1 + i, j] - residual[2 * j + i]
        for j in range(STAGES):
            f[LEAN, j], f[PSI, j] = -(start[W2] + y[W2, j]), start[W1] + y[W1, j]
        for i in range(LEAN, PSI + 1, PSI - LEAN):
            _integrate(f, i, length, y)
        for j in range(STAGES):
            tangent[j] = np.exp(start[LEAN] + y[LEAN, j])
        for j in range(STAGES):
            T = tangent[j]
            S = 2 * T / (1 + T * T)
            f[TIME, j] = S
            f[TOTAL, j] = S * (start[W3] + y[W3, j] + T * f[PSI, j])
        for i in range(TOTAL, TIME + 1):
            _integrate(f, i, length, y)
        moved, changed = 0.0, 0.0
        for i in core:
            largest, total = 0.0, 0.0
            for j in range(STAGES):
                apart = abs(y[i, j] - change[i, j])
                largest = max(largest, apart)
                total += apart
            moved = inf if isnan(total) else max(moved, largest / size[i])
        for i in range(U2 + 1):
            for j in range(STAGES):
                if i <= W3 or i >= U1:
                    # a lean has what velocities gather on the way
                    share = max(1.0, length) if i == LEAN else 1.0
                    changed = max(changed, abs(y[i, j]) / share, abs(change[i, j]) / share)
                change[i, j] = y[i, j]
        if not moved < _HOPELESS or (rounds > patience and moved > before / 2 > _ALMOST):
            return -rounds
        # or the next round would leave less than that
        rate = moved / before if before < inf else 1.0
        stands = moved < _STANDS or (moved < _ALMOST and moved > before / 2)
        stands |= moved < _NEAR and moved * max(rate, gain) < _FORESEEN
        turning = max(size[W1], size[W2], size[W3])
        if rounds == 1 and changed <= _ROUNDING * length * turning:
            stands = steady = True
            for j in range(STAGES):
                for i in range(LEAN, U2 + 1):
                    if i <= W3 or i >= U1:
                        change[i, j] = 0.0
        slow = rounds == 1 or moved > _SLOWLY * before
        before, gain = moved, rate
    if not stands:
        return -rounds
    if along:
        for i in range(ROWS):
            for j in range(STAGES):
                y[i, j] = start[i] + change[i, j]
        evaluate(E, laws, y, f, work, along)
        for i in range(U2 + 1, ROWS):
            _integrate(f, i, length, y)
            for j in range(STAGES):
                change[i, j] = y[i, j]
    series[:] = 0.0
    for i in range(ROWS):
        for j in range(STAGES):
            for k in range(STAGES + 1):
                series[i, k] += change[i, j] * _TO_COEFFICIENTS[j, k]
    if steady:
        for i in range(PSI, TIME + 1):
            series[i] = 0.0
            series[i, 1] = length * f[i, 0] / 2
    return rounds


@inner
def _sizes(y: Floats, size: Floats, stiff: bool) -> None:
    """Write the size of each row, as `state_vector.sizes` and `radau_iia.step` measure it.

    But a part of the angular velocity that is next to zero has the round-off of the others, and a
    slip, unless its direction is stiff, that of all: what stands is still less than a tenth of it.
    """
    size[:] = 1.0
    largest = 0.0
    for i in (W1, W2, W3):
        size[i] = 0.0
        for j in range(STAGES):
            size[i] = max(size[i], abs(y[i, j]))
        largest = max(largest, size[i])
    for i in (W1, W2, W3):
        size[i] = max(size[i], _FLOOR * (1 + largest), _PART * largest)
    slip = _LEAST_SLIP
    square = slip * slip
    for j in range(STAGES):
        square = max(square, y[U1, j] * y[U1, j] + y[U2, j] * y[U2, j])
    size[U1] = size[U2] = np.sqrt(square) if stiff else max(np.sqrt(square), _PART * largest)
    for i in range(ROWS):
        size[i] = max(size[i], _LEAST)


@inner
def tail_and_present(E: Floats, start: Floats, series: Floats) -> tuple[float, int]:
    """Return the last two coefficients of a step over the size of its rows, and which stand out."""
    size, largest = np.empty(ROWS), 0.0
    for i in range(ROWS):
        size[i] = abs(start[i])
        for k in range(STAGES + 1):
            size[i] += abs(series[i, k])
    size[LEAN] = 1.0
    size[U1] = size[U2] = np.hypot(size[U1], size[U2])
    for i in range(ROWS):
        largest = max(largest, size[i])
    for i in range(ROWS):
        size[i] = max(size[i], 1e-9 * largest)
    turning = max(size[W1], size[W2], size[W3])
    for i in (W1, W2, W3):
        size[i] = max(size[i], _QUIET * turning)
    for i in (U1, U2):
        size[i] = max(size[i], _QUIET * max(1.0, turning))
    if E[17] > 0:
        for i in (W1, W2, W3):
            size[i] = max(size[i], _QUIET)
    tail = 0.0
    for i in range(ROWS):
        for k in (STAGES - 1, STAGES):
            tail = max(tail, abs(series[i, k]) / size[i])
    present = STAGES
    while present > 1:
        largest = 0.0
        for i in range(ROWS):
            largest = max(largest, abs(series[i, present]) / size[i])
        if largest > _RESOLVED:
            break
        present -= 1
    return tail, present
