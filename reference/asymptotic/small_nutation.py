"""The reduced equation of motion, its Hamiltonian and its period.

Putting the expansions of Psi and Theta into eq01:Phi, with time in units of sqrt((a_p + 1) R/g),
gives (eq01:Phi_reduced_intermediate)

    phi'' = a_3/phi^3 + (a_l2 log phi + a_2)/phi^2 + (a_l1 log phi + a_1)/phi
            + a_ll log^2 phi + a_l0 log phi + a_0 - 1 + O(phi log^2 phi),

each coefficient quadratic in (B_0, B_{-2}). They are multiplied out here from the exact series and
not taken from the paper, whose list (app:coefficients) holds misprints; the tests say which agree.

The Hamiltonian is H = Phi^2/2 + U(phi) with U the integral of minus the force. eq01:hamiltonian1
prints that integral with errors: a_l1/2 belongs to log^2, a_1 to log, and the signs of a_l2 in the
term in 1/phi and of a_ll in the terms in phi are wrong.
"""

from dataclasses import dataclass

import numpy as np
import scipy

from reference.asymptotic.expansions import LogSeries, expansions, paper_constants, plain
from reference.integrable.elliptic import EllipticSubstitution
from reference.integrable.quadrature import nodes_needed
from reference.problem.can import Parameters
from reference.problem.problem import Problem
from reference.problem.states import Floats, initial_states
from reference.smooth.extrema import Run
from reference.smooth.scipy_ivp import follow

NAMES = ("a_3", "a_l2", "a_2", "a_l1", "a_1", "a_ll", "a_l0", "a_0")
POWERS = ((-3, 0), (-2, 1), (-2, 0), (-1, 1), (-1, 0), (0, 2), (0, 1), (0, 0))
TERMS = 12


@dataclass(frozen=True, slots=True, kw_only=True)
class Reduced:
    """The coefficients for one can and one pair of constants; time in sqrt((a_p + 1) R/g)."""

    parameters: Parameters
    B_0: float
    B_minus_two: float
    a_3: float
    a_l2: float
    a_2: float
    a_l1: float
    a_1: float
    a_ll: float
    a_l0: float
    a_0: float

    def force(self, phi: Floats) -> Floats:
        """Phi'' (eq01:Phi_reduced), shape of `phi`."""
        log = np.log(phi)
        return np.asarray(
            self.a_3 / phi**3
            + (self.a_l2 * log + self.a_2) / phi**2
            + (self.a_l1 * log + self.a_1) / phi
            + (self.a_ll * log + self.a_l0) * log
            + self.a_0
            - 1
        )

    def potential(self, phi: Floats) -> Floats:
        """U with phi'' = -dU/dphi, shape of `phi`."""
        log = np.log(phi)
        return np.asarray(
            phi
            + self.a_3 / (2 * phi**2)
            + (self.a_2 + self.a_l2 + self.a_l2 * log) / phi
            - self.a_l1 * log**2 / 2
            - self.a_1 * log
            - self.a_ll * phi * (log**2 - 2 * log + 2)
            - self.a_l0 * phi * (log - 1)
            - self.a_0 * phi
        )

    def hamiltonian(self, phi_dot: Floats, phi: Floats) -> Floats:
        """H(Phi, phi), in this equation's own time."""
        return np.asarray(phi_dot**2 / 2 + self.potential(phi))

    def turning_point(self, phi: float) -> float:
        """Return the other end of the motion that rests at `phi`, on the flat side."""
        level = float(self.potential(np.asarray(phi)))
        low = phi
        while float(self.potential(np.asarray(low))) <= level:
            low /= 2
        high = 2 * low

        def short(x: float) -> float:
            return float(self.potential(np.asarray(x))) - level

        # the release itself is a root: stay off it
        return float(
            scipy.optimize.brentq(short, low, min(high, phi * (1 - 1e-9)), xtol=1e-300, rtol=1e-14)
        )

    def period(self, phi: float) -> float:
        """Period of the motion that rests at `phi`, in this equation's own time.

        Not a number where the motion does not go from one turning point to the other.
        """
        low, level = self.turning_point(phi), float(self.potential(np.asarray(phi)))
        clock = EllipticSubstitution(
            low=np.array([low]),
            high=np.array([phi]),
            swing=np.array([phi - low]),
            fourth_root=np.array([np.pi]),
        )
        nodes = 4 * int(nodes_needed(clock)[0])
        fraction = (np.arange(nodes)[:, None] + 0.5) / nodes
        nutation, rise, gap = clock.nutation(fraction)
        room = 2 * (level - self.potential(nutation))
        quartic = rise * (nutation + low) * gap * (np.pi - nutation)
        slow = np.sqrt(quartic / np.where(room > 0, room, np.nan))
        return float(2 * clock.quarter[0] * clock.scale[0] * slow.mean())


def reduced_force_series(
    parameters: Parameters, B_0: float, B_minus_two: float, terms: int = TERMS
) -> LogSeries:
    """(a_p + 1) phi'' of eq01:Phi along a branch, to any order, without gravity."""
    p, n = parameters, np.arange(terms)
    known = expansions(p, terms)
    Psi = known.psi_zero.scaled(B_0) + known.psi_minus_two.scaled(B_minus_two)
    spin = known.spin_zero.scaled(B_0) + known.spin_minus_two.scaled(B_minus_two)
    factorial = np.cumprod(np.concatenate([[1.0], np.arange(1.0, terms)]))
    C = np.where(n % 2 == 0, (-1.0) ** (n // 2), 0.0) / factorial
    S = np.where(n % 2 == 1, (-1.0) ** (n // 2), 0.0) / factorial
    SC, C2 = np.convolve(S, C)[:terms], np.convolve(C, C)[:terms]
    one = (n == 0).astype(float)
    square = plain((p.a_p - p.c_p) * SC - p.h * (2 * C2 - one) + p.c_p * S + p.h * C)
    cross = plain(p.c_p * S + p.h * C)
    return square * (Psi * Psi) + (cross * (spin * Psi)).scaled(-1.0)


def reduced_equation(parameters: Parameters, B_0: float, B_minus_two: float) -> Reduced:
    """Multiply out the coefficients."""
    force = reduced_force_series(parameters, B_0, B_minus_two)
    values = {
        name: force.coefficient(power, log)
        for name, (power, log) in zip(NAMES, POWERS, strict=True)
    }
    return Reduced(parameters=parameters, B_0=B_0, B_minus_two=B_minus_two, **values)


def reduced_of(problem: Problem) -> Reduced:
    """Return the reduced equation with the constants of a release, taken exactly."""
    B_0, B = paper_constants(initial_states(problem), problem.parameters)
    return reduced_equation(problem.parameters, float(B_0[0]), float(B[0]))


def solve_reduced(problem: Problem, *, method: str, rtol: float) -> Run:
    """Integrate the reduced equation, with Psi and Theta from the expansions."""
    p = problem.parameters
    equation = reduced_of(problem)
    known = expansions(p, 6)
    Psi_of = known.psi_zero.scaled(equation.B_0) + known.psi_minus_two.scaled(equation.B_minus_two)
    spin_of = known.spin_zero.scaled(equation.B_0)
    spin_of += known.spin_minus_two.scaled(equation.B_minus_two)
    rate_of, spin_rate_of = _slope(Psi_of), _slope(spin_of)

    @np.errstate(divide="ignore", invalid="ignore")
    def field(_t: float, y: Floats) -> Floats:
        # a stage may lie beyond the flat state, where nothing is a number: its step is refused
        phi, Phi = y[:1], float(y[1])
        Psi, spin = float(Psi_of.at(phi)[0]), float(spin_of.at(phi)[0])
        dPsi, dspin = float(rate_of.at(phi)[0]) * Phi, float(spin_rate_of.at(phi)[0]) * Phi
        Phi_dot = float(equation.force(phi)[0]) / p.pendulum_inertia
        return np.array([Phi, Phi_dot, dPsi, dspin - dPsi, Psi, spin - Psi])

    at = np.array([problem.phi])
    Psi, spin = float(Psi_of.at(at)[0]), float(spin_of.at(at)[0])
    start = [problem.phi, problem.phi_dot, Psi, spin - Psi, problem.psi, problem.theta]
    return follow(problem, field, start, method=method, rtol=rtol)


def _slope(series: LogSeries) -> LogSeries:
    """Differentiate with respect to phi."""
    powers = series.first + np.arange(len(series.terms))
    out = series.terms * powers[:, None]
    logs = np.arange(1, series.terms.shape[1])
    out[:, :-1] += series.terms[:, 1:] * logs
    return LogSeries(first=series.first - 1, terms=out)
