"""Dense output of the marching integrator: a Chebyshev polynomial for each quantity and step."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from reference.equations.regularised import sine_of
from reference.numerics.batching import in_blocks
from reference.numerics.chebyshev import clenshaw, derivative, points, to_coefficients, waves
from reference.problem.problem import Problem
from reference.problem.states import Floats, States, initial_states, select_states

TIME = 5
# Newton on a monotone, nearly linear function: a handful of rounds, bisection where they overshoot.
MOST_ROUNDS = 60
EPS = float(np.finfo(float).eps)
# Up to so many places at once cosines are cheaper than a recurrence of as many steps as terms.
FEW = 128


@dataclass(frozen=True, slots=True, kw_only=True)
class Piece:
    """One step.

    Attributes
    ----------
    length : float
        In sigma.
    values : ndarray, shape (8, nodes) or (10, nodes)
        T, Phi, b, s, d, t, psi, psi + theta[, x, y] at the Chebyshev points.
    compiled : bool
        Whether it is interpolated by compiled code.
    """

    length: float
    values: Floats
    compiled: bool = False

    def at(self, x: float) -> list[float]:
        """Return all quantities at x in [-1, 1]."""
        if self.compiled:
            from reference.smooth import kernels

            there: list[float] = kernels.values_at(self.values, np.array([x]))[:, 0].tolist()
            return there
        n = self.values.shape[1]
        waves = to_coefficients(n).T @ np.cos(np.arange(n) * np.arccos(x))
        column: list[float] = (self.values @ waves).tolist()
        return column

    def sign_changes(self, row: int) -> list[int]:
        """Return the nodes after which a quantity changes its sign."""
        values = self.values[row]
        if self.compiled:
            from reference.smooth import kernels

            compiled: list[int] = kernels.sign_changes(values).tolist()
            return compiled
        changes: list[int] = np.flatnonzero(np.sign(values[:-1]) * np.sign(values[1:]) < 0).tolist()
        return changes

    def root(self, row: int, level: float, node: int) -> float:
        """Return where a quantity takes a value, between two neighbouring nodes."""
        if self.compiled:
            from reference.smooth import kernels

            return float(kernels.root(self.values[row], level, node))
        n = self.values.shape[1]
        coefficients = to_coefficients(n) @ self.values[row]
        slopes = (derivative(n) @ coefficients).tolist()
        coefficients[0] -= level
        # what round-off leaves of the sum of a series: below it a step means nothing
        noise = float(EPS * np.abs(coefficients).sum())
        series = coefficients.tolist()
        low, high = points(n)[node : node + 2].tolist()
        ends = _sum(series, low), _sum(series, high)
        # the nodes bracket the root but for round-off: then the nearer node is the root
        if ends[0] * ends[1] >= 0:
            return float(low if abs(ends[0]) < abs(ends[1]) else high)
        x = low + (high - low) * ends[0] / (ends[0] - ends[1])
        for _ in range(MOST_ROUNDS):
            value, gradient = _sum(series, x), _sum(slopes, x)
            if abs(value) <= noise:
                break
            low, high = (x, high) if (value < 0) == (ends[0] < 0) else (low, x)
            new = x - value / gradient if gradient else low
            new = new if low < new < high else (low + high) / 2
            moved, x = abs(new - x), new
            if moved <= 2 * EPS:
                break
        return float(x)


def _sum(coefficients: Sequence[float], x: float) -> float:
    """Return the value of a Chebyshev series at one place."""
    b1 = b2 = 0.0
    for c in reversed(coefficients[1:]):
        b1, b2 = 2 * x * b1 - b2 + c, b1
    return x * b1 - b2 + coefficients[0]


@dataclass(frozen=True, slots=True, kw_only=True)
class ElementsPath:
    """All steps of an integration.

    Attributes
    ----------
    values : ndarray, shape (quantities, steps, nodes)
    release : Problem
        Whose release a path without steps is.
    """

    values: Floats
    release: Problem

    @classmethod
    def of(cls, pieces: Sequence[Piece], release: Problem) -> "ElementsPath":
        """Return the path of steps; without a step it is the release."""
        if not pieces:
            return cls(values=np.empty((8, 0, 2)), release=release)
        return cls(values=np.stack([piece.values for piece in pieces], axis=1), release=release)

    def nodes(self) -> tuple[Floats, States]:
        """Return times and states at the Chebyshev points, each shared end once."""
        if not self.values.shape[1]:
            return np.zeros(1), initial_states(self.release)
        inner = self.values[:, :, :-1].reshape(len(self.values), -1)
        flat = np.concatenate([inner, self.values[:, -1, -1:]], axis=1)
        return flat[TIME], _states(flat)

    def ends(self) -> States:
        """Return the first and the last state, shape (2,)."""
        return _states(self.values[:, [0, -1], [0, -1]])

    def at(self, times: Floats) -> States:
        """States at the given times, shape (n,)."""
        if not self.values.shape[1]:
            there = np.zeros(times.size, dtype=np.intp)
            return select_states(initial_states(self.release), there)
        return in_blocks(self._block, times)

    def _block(self, times: Floats) -> States:
        """States at the given times, with the series of all of them side by side."""
        values, n = self.values, self.values.shape[2]
        step = np.clip(np.searchsorted(values[TIME, :, 0], times, side="right") - 1, 0, None)
        used, which = np.unique(step, return_inverse=True)
        # a product for each step: of all places together the last bits depend on their number, and
        # on that of the threads among which a library of linear algebra shares so large a product
        series = values[:, used].transpose(1, 0, 2) @ to_coefficients(n).T
        slopes = series[:, TIME : TIME + 1] @ derivative(n).T
        # what round-off leaves of the sum of the series of time
        rounded = EPS * np.abs(series[:, TIME]).sum(axis=1)[which]
        if times.size > FEW:  # summed term by term, each of them at all places side by side
            coefficients = series.transpose(2, 1, 0).take(which, axis=2)
            slope = slopes[:, 0].T.take(which, axis=1)
        else:
            coefficients, slope = series[which].transpose(2, 1, 0), slopes[which, 0].T
        x = _instant(coefficients[:, TIME], slope, rounded, values[TIME, step], times)
        return _states(_series(coefficients, x))


def _instant(
    coefficients: Floats, slope: Floats, rounded: Floats, node_times: Floats, times: Floats
) -> Floats:
    """Solve t(x) = times on [-1, 1], each in its own step.

    Parameters
    ----------
    coefficients, slope : ndarray, shape (terms, n)
        Series of t and of its derivative.
    rounded : ndarray, shape (n,)
        What round-off leaves of the sum of the series of t.
    node_times : ndarray, shape (n, nodes)
    times : ndarray, shape (n,)
    """
    n = node_times.shape[1]
    nodes = points(n)
    place = np.clip((node_times <= times[:, None]).sum(axis=1) - 1, 0, n - 2)
    rows = np.arange(times.size)
    low, high = nodes[place], nodes[place + 1]
    t_low, t_high = node_times[rows, place], node_times[rows, place + 1]
    width = np.where(t_high > t_low, t_high - t_low, 1.0)
    x = low + (high - low) * np.clip((times - t_low) / width, 0, 1)
    both = np.stack([coefficients, slope], axis=1)
    # what round-off leaves of the time, and of the sum of a series: below it a step means nothing
    noise = np.maximum(np.spacing(times), rounded)
    for _ in range(MOST_ROUNDS):
        value, gradient = _series(both, x)
        excess = value - times
        low, high = np.where(excess < 0, x, low), np.where(excess > 0, x, high)
        new = x - excess / np.where(gradient > 0, gradient, np.inf)
        new = np.where((new < low) | (new > high), (low + high) / 2, new)
        done = np.abs(excess) <= noise
        moved = np.where(done, 0.0, new - x)
        x = x + moved
        if (np.abs(moved) <= 2 * EPS).all():
            break
    return np.asarray(x)


def _series(coefficients: Floats, x: Floats) -> Floats:
    """Return values of Chebyshev series at n places, coefficients of shape (terms, ..., n)."""
    if x.size > FEW:
        return clenshaw(coefficients, x)
    return np.asarray(np.einsum("k...n,kn->...n", coefficients, waves(coefficients.shape[0], x)))


def _states(values: Floats) -> States:
    T, Phi, b, s, _, _, psi, total = values[:8]
    psi_dot = b / sine_of(T) ** 2
    with_locus = len(values) > 8  # noqa: PLR2004 - eight quantities, or ten
    return States(
        phi=2 * np.arctan(T),
        phi_dot=Phi,
        psi=psi,
        psi_dot=psi_dot,
        theta=total - psi,
        theta_dot=s - psi_dot,
        spin=s,
        x=values[8] if with_locus else None,
        y=values[9] if with_locus else None,
    )
