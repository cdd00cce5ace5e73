"""The error of a difference against its step: truncation, a floor, and noise, by a fit.

A central difference over a relative step s has the error A s^2 of truncation, F that no step
changes, since the engine's own motion has another derivative, and N/s of noise in the numbers that
are subtracted. The three are fitted to the logarithms of the errors.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from harness.core.trajectory import Floats


@dataclass(frozen=True, slots=True, kw_only=True)
class ErrorOfSteps:
    """The three parts of the error of a difference, relative to the derivative.

    Parameters
    ----------
    truncation, floor, noise : float
        A, F and N: the error is A s^2 + F + N/s.
    residual : float
        Root mean square of the logarithm of the error over the fit.
    """

    truncation: float
    floor: float
    noise: float
    residual: float

    def at(self, steps: Floats) -> Floats:
        """Return the fitted error at relative steps, shape (n,)."""
        return np.asarray(self.truncation * steps**2 + self.floor + self.noise / steps)

    @property
    def noise_below(self) -> float:
        """Step below which noise is the largest part."""
        if self.floor <= self._least_without_floor:
            return math.cbrt(self.noise / self.truncation)
        return self.noise / self.floor

    @property
    def truncation_above(self) -> float:
        """Step above which truncation is the largest part."""
        if self.floor <= self._least_without_floor:
            return math.cbrt(self.noise / self.truncation)
        return math.sqrt(self.floor / self.truncation)

    @property
    def _least_without_floor(self) -> float:
        """What truncation and noise are where they are equal: a lower floor is never seen."""
        return math.cbrt(self.noise**2 * self.truncation)


_FEWEST = 5
"""Errors from which three constants are told apart."""

_TINY = 1e-30
"""Least constant: of a part that is never seen."""


def fit_errors(steps: Sequence[float], errors: Sequence[float | None]) -> ErrorOfSteps | None:
    """Return the three parts, or None if too few errors are known.

    Parameters
    ----------
    steps : sequence of float, length n
        Relative.
    errors : sequence of float or None, length n
        Relative to the derivative; zero and what is not known are left out.
    """
    pairs = [
        (step, error)
        for step, error in zip(steps, errors, strict=True)
        if error is not None and math.isfinite(error) and error > 0.0
    ]
    if len(pairs) < _FEWEST:
        return None
    s, e = np.array(pairs).T
    logs = np.log(e)

    def residual(constants: Floats) -> Floats:
        A, F, N = np.exp(constants)
        return np.asarray(np.log(A * s**2 + F + N / s) - logs)

    # each part alone is no larger than the errors: begin where it is the largest it can be
    start = np.log([max(float(np.min(part)), _TINY) for part in (e / s**2, e, e * s)])
    bounds = np.full(3, math.log(_TINY)), np.full(3, 700.0)
    best = scipy.optimize.least_squares(residual, start, bounds=bounds, loss="soft_l1", x_scale=1.0)
    A, F, N = (float(each) for each in np.exp(best.x))
    rest = float(np.sqrt(np.mean(residual(best.x) ** 2)))
    return ErrorOfSteps(truncation=A, floor=F, noise=N, residual=rest)
