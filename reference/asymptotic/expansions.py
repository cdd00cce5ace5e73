"""The paper's small-nutation expansions of Psi, Theta and their two constants, to any order.

Normalised as in the paper (eq01:psi_orig with q_2 = 0): Psi = B_0 Psi_0 + B_{-2} Psi_{-2} with

    Psi_0    = 1 + ...,
    Psi_{-2} = phi^-2 - k h/phi + 0 + ... + lambda log(phi) Psi_0,    lambda = k (1 - k h^2)/2 =
    k^2 a c_p/(2 c) ...

They are the series of `reference.integrable.frobenius` divided by S^2, so B_{-2} = B exactly and
B_0 = k c_p K/2 + (coefficient of phi^0 in b2/S^2) B. Evaluated exactly the two do not oscillate, as
they do in fig01:conserved, where the expansions eq01:A_sol and eq01:B_sol stand for them.

Series in phi and log(phi): sums of x[i, j] phi^(i + first) log(phi)^j.

Small, exact in structure, and enough to multiply out the reduced equation.
"""

from dataclasses import dataclass

import numpy as np

from reference.integrable.frobenius import (
    can_constants,
    first_integrals,
    frobenius_series,
    series_of,
)
from reference.problem.can import Parameters
from reference.problem.states import Floats, States


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


TERMS = 16


@dataclass(frozen=True, slots=True, kw_only=True)
class Expansions:
    """Psi and the spin s = Psi + Theta of the two normalised solutions, as series."""

    psi_zero: LogSeries
    spin_zero: LogSeries
    psi_minus_two: LogSeries
    spin_minus_two: LogSeries


def expansions(parameters: Parameters, terms: int = TERMS) -> Expansions:
    """Return the two solutions in the paper's normalisation.

    Parameters
    ----------
    parameters : Parameters
    terms : int
        Powers of phi kept, from phi^-2 on.
    """
    can = can_constants(parameters)
    series = frobenius_series(can, terms)
    over_square = _inverse_square_sine(terms)
    log = LogSeries(
        first=0, terms=np.eye(1, 2, 1).repeat(terms, 0) * (np.arange(terms) == 0)[:, None]
    )
    b1, b2, s1, s2 = (plain(part) for part in (series.b1, series.b2, series.s1, series.s2))
    with_log = log.scaled(float(can.residue))
    regular = over_square * b1
    singular = over_square * (b2 + with_log * b1)
    # normalise the regular one to 1 and take it out of the other's constant term
    unit = regular.coefficient(0)
    extra = -singular.coefficient(0) / unit
    return Expansions(
        psi_zero=regular.scaled(1 / unit),
        spin_zero=s1.scaled(1 / unit),
        psi_minus_two=singular + regular.scaled(extra),
        spin_minus_two=(s2 + with_log * s1) + s1.scaled(extra),
    )


def _inverse_square_sine(terms: int) -> LogSeries:
    """1/sin^2 phi, from phi^-2 on."""
    n = np.arange(terms)
    cosine = np.where(n % 2 == 0, (-1.0) ** (n // 2), 0.0)
    factorial = np.cumprod(np.concatenate([[1.0], np.arange(1.0, 2 * terms)]))
    # (sin phi/phi)^2 and its reciprocal by long division
    sinc = cosine / factorial[1 : terms + 1]
    square = np.convolve(sinc, sinc)[:terms]
    inverse = np.zeros(terms)
    inverse[0] = 1.0
    for i in range(1, terms):
        inverse[i] = -square[1 : i + 1] @ inverse[:i][::-1]
    return plain(inverse, first=-2)


def paper_constants(states: States, parameters: Parameters) -> tuple[Floats, Floats]:
    """Return B_0 and B_{-2} of eq01:psi_orig exactly, shape (n,)."""
    K, B = first_integrals(
        can_constants(parameters), series_of(parameters), states.phi, states.psi_dot, states.spin
    )
    can = can_constants(parameters)
    b2 = frobenius_series(can, 4).b2
    # Psi = ... + phi^0 (K b1_2 + B (b2_2 + b2_0/3)), and b1_2 = k c_p/2
    half = parameters.k * parameters.c_p / 2
    return half * K + (b2[2] + b2[0] / 3) * B, B


def leading_constants(states: States, parameters: Parameters) -> tuple[Floats, Floats]:
    """Return B_0 and B_{-2} to leading order in phi, shape (n,).

    The first terms of eq01:A_sol and eq01:B_sol. Unlike those of `paper_constants` they are not
    constant during a motion: the ripples of fig01:conserved.
    """
    half = parameters.k * parameters.c_p / 2
    return half * states.spin, (states.psi_dot - half * states.spin) * states.phi**2
