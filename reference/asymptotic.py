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
"""

from dataclasses import dataclass

import numpy as np

from reference.outer import outer_correction
from reference.parameters import Parameters
from reference.problem import Problem
from reference.reduced import Reduced, reduced_of
from reference.states import Floats


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
    """Contact locus wherever theta' = -psi': an arc of the can's own radius, shape (n, 2), in R.

    (x, y) = -(cos psi, sin psi) + const (eq01:contact_pt_inner and eq01:contact_pt_outer, mended):
    in the bounce with `Matched.precession`, whose arc is the angle of turn; before it with
    `Matched.outer_precession`, where the point hardly moves.
    """
    return -np.stack([np.cos(psi), np.sin(psi)], axis=-1)


def matched_of(problem: Problem) -> Matched:
    """Return the asymptotic bounce of a release from rest."""
    return Matched(reduced=reduced_of(problem), height=2 * problem.phi)


def boundary_rotation(parameters: Parameters, psi_dot: float) -> float:
    """Theta at which the sense of the turn changes, to leading order (eq01:boundary)."""
    return (2 / (parameters.c_p * parameters.k) - 1) * psi_dot


def friction_bound(parameters: Parameters) -> float:
    """Friction coefficient needed in a hard bounce, h/a_p (eq01:required_friction)."""
    return parameters.h / parameters.a_p


def uniform_cylinder(h: float) -> Parameters:
    """Return the solid cylinder of uniform density: a = 1/4 + h^2/3, c = 1/2."""
    return Parameters(a=0.25 + h * h / 3, c=0.5, h=h)
