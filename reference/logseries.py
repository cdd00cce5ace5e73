"""Series in phi and log(phi): sums of x[i, j] phi^(i + first) log(phi)^j.

Small, exact in structure, and enough to multiply out the reduced equation.
"""

from dataclasses import dataclass

import numpy as np

from reference.states import Floats


@dataclass(frozen=True, slots=True, kw_only=True)
class LogSeries:
    """A truncated series.

    Attributes
    ----------
    first : int
        Lowest power of phi.
    terms : ndarray, shape (powers, logs)
        Coefficient of phi^(first + i) log(phi)^j.
    """

    first: int
    terms: Floats

    def __add__(self, other: "LogSeries") -> "LogSeries":
        """Add; powers are kept as far as both go."""
        first = min(self.first, other.first)
        last = min(self.first + len(self.terms), other.first + len(other.terms))
        logs = max(self.terms.shape[1], other.terms.shape[1])
        out = np.zeros((last - first, logs))
        for series in (self, other):
            shift = series.first - first
            part = series.terms[: last - series.first]
            out[shift : shift + len(part), : part.shape[1]] += part
        return LogSeries(first=first, terms=out)

    def __mul__(self, other: "LogSeries") -> "LogSeries":
        """Multiply; powers are kept as far as they are certain."""
        count = min(len(self.terms), len(other.terms))
        out = np.zeros((count, self.terms.shape[1] + other.terms.shape[1] - 1))
        for i in range(count):
            for j in range(count - i):
                out[i + j] += np.convolve(self.terms[i], other.terms[j])
        return LogSeries(first=self.first + other.first, terms=out)

    def scaled(self, factor: float) -> "LogSeries":
        """Multiply by a number."""
        return LogSeries(first=self.first, terms=self.terms * factor)

    def coefficient(self, power: int, log: int = 0) -> float:
        """Coefficient of phi^power log(phi)^log; 0 where there is none."""
        i = power - self.first
        if 0 <= i < len(self.terms) and log < self.terms.shape[1]:
            return float(self.terms[i, log])
        return 0.0

    def at(self, phi: Floats) -> Floats:
        """Value, shape of `phi`."""
        log = np.log(phi)
        total = np.zeros_like(phi)
        for row in self.terms[::-1]:
            total = total * phi + np.polynomial.polynomial.polyval(log, row)
        return np.asarray(total * phi**self.first)


def plain(coefficients: Floats, first: int = 0) -> LogSeries:
    """Return a series without logarithms."""
    return LogSeries(first=first, terms=np.asarray(coefficients, dtype=float)[:, None])
