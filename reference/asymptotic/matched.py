"""The matched asymptotic solution: outer fall, inner bounce, composite, and what follows from them.

For the reduced equation phi'' = a_p epsilon/phi^3 + ... - 1 (eq01:Phi_reduced), released from rest
at I/2, with epsilon = B_{-2}^2 and time in sqrt((a_p + 1) R/g):

    outer      phi = (I - t^2)/2 + epsilon phi_1(t)                          (eq01:outer_solution)
    inner      phi = sqrt(epsilon a_p/I + I (t - sqrt I)^2)                  (eq01:phi_inner)
    composite  phi = inner - (sqrt I - t)^2/2
    (eq01:uniformly_valid_solution)

Where the paper is in error:

- eq01:psi_inner, eq01:theta_inner, eq01:contact_pt_inner: the factor is sqrt((a_p + 1)/a_p), not
  sqrt(a_p + 1)/a_p;
- the matching expansion of the outer solution: I^(3/2), not I^(5/2), and the term is positive;
- below eq01:dpsi_max the two numbers are exchanged: 3449 is the numerical peak, 3575 the formula's;
- epsilon = 1.43e-10 is B_{-2}^2 (a_p + 1), though time has been rescaled already: the reduced
equation needs
  3.7e-11;
- eq01:contact_pt_inner: the path turns with psi, (x, y) = -(cos psi, sin psi) + const; the sign of
y is lost,
  and with it the sense: positive B_{-2} goes anticlockwise;
- the friction bound of the uniform cylinder: its transverse moment is m (3 R^2 + (2H)^2)/12, so the
  bound is 12 h/(3 + 16 h^2), at most sqrt(3)/2 at h = sqrt(3)/4.

The first correction to the outer solution: the integrals J.

phi_1'' (eq01:order1_outer) is a sum of (1 - T^2)^-i log^j(1 - T^2), T = t/sqrt(I), integrated twice
from 0. With L = log(1 - T^2), A = artanh T and P = integral of L/(1 - T^2) from 0,

    P    = (log^2(1 + T) - log^2(1 - T))/4 + log(2) A + (Li2((1 - T)/2) - Li2((1 + T)/2))/2,

    J_0  = T^2/2       J_1 = T A + L/2       J_2 = T A/2       J_3 = T^2/(8 (1 - T^2)) + 3 T A/8
    J_l0 = ((1 + T^2) L - 3 T^2 + 4 T A)/2
    J_l1 = T P + L^2/4
    J_l2 = (T P - L - T A)/2
    J_ll = T^2 L^2 + 4 T P - 4 T^2 L + 8 T^2 - 8 T A + (1 - T^2) (L^2 - 2 L + 2)/2 - 1

secA:integrals prints J_3 with the sign of its first term wrong. The logarithmic ones are derived
anew here and held to double quadrature in the tests.

The asymptotic solution as a motion that runs on from bounce to bounce.

phi is the composite solution (eq01:uniformly_valid_solution); psi and theta are the inner ones
(eq01:psi_inner, eq01:theta_inner), equal and opposite, with the whole angle of turn in each bounce.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.special import spence

from reference.asymptotic.small_nutation import Reduced, reduced_of
from reference.problem.can import Parameters
from reference.problem.outcome import Outcome
from reference.problem.problem import Problem, ProblemError
from reference.problem.states import Floats, States
from reference.smooth.extrema import Extrema, Run


def integrals(T: Floats) -> dict[str, Floats]:
    """Return J_0 ... J_3, J_l0 ... J_l2 and J_ll at T in [0, 1), each of the shape of T."""
    T = np.asarray(T, dtype=float)
    L, A, T2 = np.log1p(-(T**2)), np.arctanh(T), T**2
    # Li2(z) = spence(1 - z)
    dilogarithms = spence((1 + T) / 2) - spence((1 - T) / 2)
    P = (np.log1p(T) ** 2 - np.log1p(-T) ** 2) / 4 + np.log(2) * A + dilogarithms / 2
    return {
        "J_0": T2 / 2,
        "J_1": T * A + L / 2,
        "J_2": T * A / 2,
        "J_3": T2 / (8 * (1 - T2)) + 3 * T * A / 8,
        "J_l0": ((1 + T2) * L - 3 * T2 + 4 * T * A) / 2,
        "J_l1": T * P + L**2 / 4,
        "J_l2": (T * P - L - T * A) / 2,
        "J_ll": T2 * L**2
        + 4 * T * P
        - 4 * T2 * L
        + 8 * T2
        - 8 * T * A
        + (1 - T2) * (L**2 - 2 * L + 2) / 2
        - 1,
    }


def outer_coefficients(reduced: Reduced, height: float) -> dict[str, float]:
    """Return b_0 ... b_3, b_l0 ... b_l2 and b_ll (app:b_coefficients), epsilon included.

    Parameters
    ----------
    reduced : Reduced
    height : float
        I, twice the nutation at release.
    """
    r, log = reduced, np.log(height / 2)
    return {
        "J_3": 8 * r.a_3 / height**2,
        "J_l2": 4 * r.a_l2 / height,
        "J_2": 4 * (r.a_2 + r.a_l2 * log) / height,
        "J_l1": 2 * r.a_l1,
        "J_1": 2 * (r.a_1 + r.a_l1 * log),
        "J_ll": r.a_ll * height,
        "J_l0": (r.a_l0 + 2 * r.a_ll * log) * height,
        "J_0": (r.a_0 + r.a_l0 * log + r.a_ll * log**2) * height,
    }


def outer_correction(reduced: Reduced, height: float, t: Floats) -> Floats:
    """Epsilon phi_1(t) of eq01:outer_sol, shape of `t`; t in [0, sqrt(I)) of the reduced time."""
    parts = integrals(np.asarray(t) / np.sqrt(height))
    weights = outer_coefficients(reduced, height)
    return np.asarray(sum(weights[name] * part for name, part in parts.items()))


@dataclass(frozen=True, slots=True, kw_only=True)
class Matched:
    """The asymptotic bounce of one release; time t in sqrt((a_p + 1) R/g), the bounce at sqrt(I).

    Attributes
    ----------
    reduced : Reduced
    height : float
        I, twice the nutation at release.
    """

    reduced: Reduced
    height: float

    @property
    def epsilon(self) -> float:
        """B_{-2}^2."""
        return self.reduced.B_minus_two**2

    @property
    def sign(self) -> float:
        """Sign of B_{-2}, which is that of the turn."""
        return float(np.sign(self.reduced.B_minus_two))

    @property
    def bounce_time(self) -> float:
        """sqrt(I)."""
        return float(np.sqrt(self.height))

    @property
    def phi_min(self) -> float:
        """sqrt(epsilon a_p/I)."""
        return float(np.sqrt(self.epsilon * self.reduced.parameters.a_p / self.height))

    @property
    def peak_psi_dot(self) -> float:
        """Peak precession rate in sqrt(g/R): B_{-2}/phi_min^2 (eq01:dpsi_max, in unscaled time)."""
        return self.reduced.B_minus_two / self.phi_min**2

    @property
    def angle_of_turn(self) -> float:
        """Pi sqrt((a_p + 1)/a_p) sign(B_{-2}) (eq01:angle_of_turn)."""
        return float(np.pi * self.reduced.parameters.turn_ratio * self.sign)

    def outer(self, t: Floats, *, corrected: bool = True) -> Floats:
        """Return phi of the falling can, for 0 <= t < sqrt(I)."""
        leading = (self.height - t**2) / 2
        if not corrected:
            return np.asarray(leading)
        return np.asarray(leading + outer_correction(self.reduced, self.height, t))

    def inner(self, t: Floats) -> Floats:
        """Return phi of the bounce, around t = sqrt(I)."""
        return np.asarray(
            np.hypot(self.phi_min, np.sqrt(self.height) * (t - self.bounce_time)), dtype=float
        )

    def composite(self, t: Floats) -> Floats:
        """Return the uniformly valid phi, over a whole period 0 <= t <= 2 sqrt(I)."""
        return np.asarray(self.inner(t) - (self.bounce_time - t) ** 2 / 2)

    def precession(self, t: Floats) -> Floats:
        """Inner solution for psi (eq01:psi_inner), zero at the minimum of phi."""
        sweep = np.arctan(np.sqrt(self.height) * (t - self.bounce_time) / self.phi_min)
        return np.asarray(self.reduced.parameters.turn_ratio * self.sign * sweep)

    def outer_precession(self, t: Floats) -> Floats:
        """Outer solution for psi, zero at release; valid short of the bounce."""
        height = self.height
        unit = t / np.sqrt(height)
        rate = np.sqrt(self.reduced.parameters.pendulum_inertia) * self.reduced.B_minus_two
        # the integral of 4/(I - t^2)^2
        return np.asarray(
            2 * rate * (t / (height * (height - t**2)) + np.arctanh(unit) / height**1.5)
        )


def locus_arc(psi: Floats) -> Floats:
    """Return the contact locus where theta' = -psi': an arc of the can's radius, shape (n, 2).

    (x, y) = -(cos psi, sin psi) + const in R (eq01:contact_pt_inner, eq01:contact_pt_outer, both
    mended): in the bounce with `Matched.precession`, whose arc is the angle of turn; before it with
    `Matched.outer_precession`, where the point hardly moves.
    """
    return -np.stack([np.cos(psi), np.sin(psi)], axis=-1)


def matched_of(problem: Problem) -> Matched:
    """Return the asymptotic bounce of a release from rest."""
    return Matched(reduced=reduced_of(problem), height=2 * problem.phi)


def boundary_rotation(parameters: Parameters, psi_dot: float) -> float:
    """Return Theta at which the sense of the turn changes, to leading order (eq01:boundary)."""
    return (2 / (parameters.c_p * parameters.k) - 1) * psi_dot


def friction_bound(parameters: Parameters) -> float:
    """Return the friction that a hard bounce needs, h/a_p (eq01:required_friction)."""
    return parameters.h / parameters.a_p


def uniform_cylinder(h: float) -> Parameters:
    """Return the solid cylinder of uniform density: a = 1/4 + h^2/3, c = 1/2."""
    return Parameters(a=0.25 + h * h / 3, c=0.5, h=h)


SAMPLES = 60


@dataclass(frozen=True, slots=True, kw_only=True)
class MatchedPath:
    """The composite solution as a motion, bounce after bounce; time in sqrt(R/g)."""

    problem: Problem
    matched: Matched
    t_end: float

    @property
    def period(self) -> float:
        """From maximum to maximum, 2 sqrt(I (a_p + 1))."""
        inertia = self.problem.parameters.pendulum_inertia
        return float(2 * self.matched.bounce_time * np.sqrt(inertia))

    def at(self, times: Floats) -> States:
        """States at the given times, shape (n,)."""
        m = self.matched
        scale = np.sqrt(self.problem.parameters.pendulum_inertia)
        cycle = np.floor(times / self.period)
        t = (times - cycle * self.period) / scale
        phi, away = m.composite(t), t - m.bounce_time
        inner = m.inner(t)
        phi_dot = (m.height * away / inner - away) / scale
        # the sweep of one bounce, made whole at its ends, where the outer region takes over
        sweep = m.precession(t) / m.precession(np.array([2 * m.bounce_time]))
        turned = m.angle_of_turn * (cycle + (1 + sweep) / 2)
        rate = m.reduced.B_minus_two / inner**2
        zero = np.zeros_like(phi)
        return States(
            phi=phi,
            phi_dot=phi_dot,
            psi=self.problem.psi + turned,
            psi_dot=rate,
            theta=self.problem.theta - turned,
            theta_dot=-rate,
            spin=zero,
        )

    def nodes(self) -> tuple[Floats, States]:
        """Return times and states, crowded around each bounce."""
        half = self.period / 2
        width = self.matched.phi_min / np.sqrt(self.matched.height)
        steps = np.sinh(np.linspace(0, np.arcsinh(self.matched.bounce_time / width), SAMPLES))
        steps *= half / steps[-1]
        bounces = np.arange(int(np.ceil(self.t_end / self.period)) or 1)
        grid = half + np.concatenate([-steps[:0:-1], steps])
        times = np.unique((bounces[:, None] * self.period + grid).ravel())
        times = np.unique(np.clip(times, 0.0, self.t_end))
        return times, self.at(times)


def solve_asymptotically(problem: Problem) -> Run:
    """Return the composite solution of a release from rest.

    Raises
    ------
    ProblemError
        If the release is not at rest in phi, or nothing turns: the expansion has no such case.
    """
    if problem.phi_dot != 0:
        sentence = "the asymptotic solution starts from rest: `phi_dot` must be 0"
        raise ProblemError("phi_dot", problem.phi_dot, "0", sentence)
    matched = matched_of(problem)
    if matched.sign == 0:
        sentence = "the asymptotic solution needs precession or rotation: B_{-2} is 0"
        raise ProblemError("B_{-2}", 0.0, "not 0", sentence)
    path = MatchedPath(problem=problem, matched=matched, t_end=0.0)
    t_end = problem.duration or path.period * (problem.bounces or 1)
    path = replace(path, t_end=t_end)
    count = int(np.floor(2 * t_end / path.period * (1 + 1e-15))) + 1
    halves = np.arange(count, dtype=float)
    times = np.minimum(halves * path.period / 2, t_end)
    track = Extrema(
        outcome=Outcome.FINISHED,
        t_end=t_end,
        times=times,
        extrema=_extrema(path, halves),
        maximum=halves % 2 == 0,
    )
    return Run(path=path, track=track, steps=0, evaluations=0)


def _extrema(path: MatchedPath, halves: Floats) -> States:
    """States at maxima and minima, free of the rounding of their times."""
    top = path.at(np.zeros(1))
    bottom = path.at(np.array([path.period / 2]))
    even = halves % 2 == 0
    turned = path.matched.angle_of_turn * halves / 2

    def pick(name: str) -> Floats:
        return np.asarray(np.where(even, getattr(top, name)[0], getattr(bottom, name)[0]))

    return States(
        phi=np.where(even, pick("phi"), path.matched.phi_min),
        phi_dot=np.zeros(halves.size),
        psi=path.problem.psi + turned,
        psi_dot=np.where(even, pick("psi_dot"), path.matched.peak_psi_dot),
        theta=path.problem.theta - turned,
        theta_dot=np.where(even, pick("theta_dot"), -path.matched.peak_psi_dot),
        spin=np.zeros(halves.size),
    )
