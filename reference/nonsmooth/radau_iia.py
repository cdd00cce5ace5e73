"""One long step of an ordinary differential equation, by collocation at the Radau points.

y(c) = y0 + h integral of the field from 0 to c, with y a polynomial of degree 16 that satisfies the
equation at the 16 right Radau points: order 31 at the end of the step. The method is implicit and
L-stable, solved by Newton's method: a rim that has just begun to slip has the direction of its slip
tied to its friction ever more stiffly the slower it slips, which an explicit method cannot follow.
None of the points is the beginning of the step, where that direction does not yet exist.

Hairer and Wanner, Solving Ordinary Differential Equations II, section IV.5 (Radau IIA).
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import TypeAlias

import numpy as np
import scipy
from numpy.polynomial import chebyshev, legendre

from reference.problem.states import Floats

STAGES = 16
MOST_ITERATIONS = 24
# Newton's update, over the scale of the state, that leaves nothing to improve.
STANDS = 3e-15
# Updates below this that no longer shrink are the round-off of a state with small parts.
ALMOST = 1e-12
# A part smaller than this need not be as exact in itself: of one that is zero there is only noise.
LEAST = 1e-4
# An iteration that gains less than this is worth a new matrix.
SLOW = 0.05
# And so is one that moves the state by more than this: the friction of a slip that has just begun
# turns with it, and its derivatives are those of another slip after an update of its own size.
STRAIGHT = 1e-2
# An update beyond this diverges.
HOPELESS = 1e3
# Imaginary steps, over the size of what is stepped: nothing is subtracted, so as small as may be.
STEP = 1e-40

AT_START = np.where(np.arange(STAGES + 1) % 2 == 0, 1.0, -1.0)

Field: TypeAlias = Callable[[Floats], Floats]


@lru_cache(maxsize=1)
def points() -> Floats:
    """Return the right Radau points on (0, 1], increasing, shape (STAGES,)."""
    # zeros of P_{s-1} + P_s on [-1, 1) are the left points mirrored
    series = np.zeros(STAGES + 1)
    series[STAGES - 1], series[STAGES] = 1.0, -1.0
    return np.sort(np.asarray(legendre.legroots(series).real)) / 2 + 0.5


@lru_cache(maxsize=1)
def with_start() -> Floats:
    """Return 0 and the points."""
    return np.concatenate([[0.0], points()])


@lru_cache(maxsize=1)
def integrator() -> Floats:
    """Return the matrix from values at the points to the integral from 0 to each, shape (s, s)."""
    x = 2 * points() - 1
    values = legendre.legvander(x, STAGES - 1)
    primitives = np.stack(
        [legendre.legval(x, legendre.legint(row, lbnd=-1)) for row in np.eye(STAGES)], axis=1
    )
    return np.asarray(np.linalg.solve(values.T, primitives.T).T / 2)


@lru_cache(maxsize=1)
def to_coefficients() -> Floats:
    """Matrix from values at 0 and the points to Chebyshev coefficients on [0, 1]."""
    return np.asarray(np.linalg.inv(chebyshev.chebvander(2 * with_start() - 1, STAGES)))


def basis(c: Floats) -> Floats:
    """Return the Chebyshev polynomials on [0, 1] less their values at 0, shape (n, STAGES + 1).

    What they are a basis of is a change: nothing at the start, not even round-off.
    """
    x = 2 * np.asarray(c) - 1
    waves = np.empty((STAGES + 1, x.size))
    waves[0], waves[1] = 1.0, x
    for k in range(2, STAGES + 1):
        waves[k] = waves[k - 1] * (2 * x) - waves[k - 2]
    return np.asarray(waves.T - AT_START)


@lru_cache(maxsize=8)
def basis_at(c: tuple[float, ...]) -> Floats:
    """Return the basis at given places, cached."""
    return basis(np.array(c))


@dataclass(frozen=True, slots=True, kw_only=True)
class Step:
    """A step that satisfies the equation at its points, or what was spent on one that does not.

    Attributes
    ----------
    change : ndarray, shape (n, STAGES), or None
        State less its start, at the points; None of a step that is too long for Newton's method.
    evaluations : int
        Of the field, each at all points.
    """

    change: Floats | None
    evaluations: int


def coefficients(change: Floats) -> Floats:
    """Return Chebyshev coefficients of a change that starts at zero, shape (n, STAGES + 1)."""
    return change @ to_coefficients()[:, 1:].T


@np.errstate(over="ignore", divide="ignore", invalid="ignore")
def step(
    field: Field, start: Floats, length: float, guess: Floats, scale: Callable[[Floats], Floats]
) -> Step:
    """Take one step, if it is not too long for Newton's method.

    An iteration that goes astray may meet no numbers on its way; what is returned is finite.

    Parameters
    ----------
    field : callable
        From states of shape (n, m) to their rates.
    start : ndarray, shape (n,)
    length : float
    guess : ndarray, shape (n, STAGES)
        Of the change at the points.
    scale : callable
        From states (n, m) to the size of each entry, positive.
    """
    A, n = integrator(), start.size
    change, before, gain, bent = guess, np.inf, np.inf, np.inf
    factors: tuple[Floats, Floats] | None = None
    for iteration in range(MOST_ITERATIONS):
        y = start[:, None] + change
        size = scale(y)
        if factors is None or gain > SLOW or bent > STRAIGHT:
            rates, jacobian = _linearised(field, y, size)
            blocks = -length * np.einsum("ab,ijb->iajb", A, jacobian)
            matrix = blocks.reshape(n * STAGES, n * STAGES)
            matrix[np.diag_indices(n * STAGES)] += 1.0
            if not np.isfinite(matrix).all():
                return Step(change=None, evaluations=iteration + 1)
            factors, before = scipy.linalg.lapack.dgetrf(matrix)[:2], np.inf
        else:
            rates = field(y)
        residual = change - length * rates @ A.T
        if not np.isfinite(residual).all():
            return Step(change=None, evaluations=iteration + 1)
        update = scipy.linalg.lapack.dgetrs(*factors, residual.ravel())[0].reshape(n, STAGES)
        change = change - update
        bent = float((np.abs(update) / size).max())
        moved = float((np.abs(update) / np.maximum(size.max(axis=1), LEAST)[:, None]).max())
        if not moved < HOPELESS:
            return Step(change=None, evaluations=iteration + 1)
        gain = moved / before if np.isfinite(before) else 0.0
        if moved < STANDS or (moved < ALMOST and gain > SLOW):
            return Step(change=change, evaluations=iteration + 1)
        before = moved
    return Step(change=None, evaluations=MOST_ITERATIONS)


def _linearised(field: Field, y: Floats, size: Floats) -> tuple[Floats, Floats]:
    """Return rates (n, s), and their derivatives (n, n, s), along imaginary steps.

    Those subtract nothing. Differences would: what a slip changes in a force is its direction, and
    beside a slip that has just begun the round-off of the force is a change of any direction.
    """
    n, s = y.shape
    shift = STEP * size
    columns = np.repeat(y[:, None, :], n, axis=1).astype(complex)
    columns[np.arange(n), np.arange(n), :] += 1j * shift
    values = field(columns.reshape(n, n * s)).reshape(n, n, s)
    return field(y), values.imag / shift
