"""The can as the equations see it: two moments of inertia and a height, all dimensionless.

Lengths are in R, masses in m, moments of inertia in m R^2 (eq01:scalings). The derived constants
are those below (eq01:non_dimensionalised_eom) of Collins, Hall and Hogan, arXiv:2302.08335.

The dimensional moments the paper prints (A = 6.97e-5, C = 5.89e-5 kg m^2) belong to a different
can than its dimensionless groups (eq01:material_parameters); its results follow from the groups,
and so does `PAPER_CAN`.
"""

import math
from dataclasses import dataclass

from reference.problem.validation import POSITIVE, RefusedError, require, require_numbers


class ParameterError(RefusedError):
    """Parameters that no rigid can has."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Parameters:
    """A rotationally symmetric rigid can.

    Parameters
    ----------
    a : float
        Moment of inertia about a transverse axis through the centre, A/(m R^2).
    c : float
        Moment of inertia about the symmetry axis, C/(m R^2); at most 2 a, as for every rigid body.
    h : float
        Half the height over the radius, H/R.

    Raises
    ------
    ParameterError
        If a value is not finite and positive, or `c` exceeds 2 `a`.
    """

    a: float
    c: float
    h: float

    def __post_init__(self) -> None:
        """Refuse what makes no sense."""
        require_numbers(ParameterError, {"a": self.a, "c": self.c, "h": self.h}, POSITIVE)
        allowed = f"at most 2 `a` = {2 * self.a!r}, for no rigid body has C > 2 A"
        require(ParameterError, "c", self.c, allowed, when=self.c <= 2 * self.a)

    @property
    def a_p(self) -> float:
        """Transverse moment about the contact point, a + h^2."""
        return self.a + self.h * self.h

    @property
    def c_p(self) -> float:
        """Axial moment about the contact point, c + 1."""
        return self.c + 1

    @property
    def k(self) -> float:
        """The constant k = c/(a + c a_p)."""
        return self.c / (self.a + self.c * self.a_p)

    @property
    def pendulum_inertia(self) -> float:
        """Moment about the rim for motion in a plane, a_p + 1."""
        return self.a_p + 1

    @property
    def balancing_angle(self) -> float:
        """Nutation at which the centre stands above the contact point (eq:phistar), in rad."""
        return math.atan2(1.0, self.h)

    @property
    def turn_ratio(self) -> float:
        """Leading angle of turn over pi, sqrt((a_p + 1)/a_p) (eq01:angle_of_turn)."""
        return math.sqrt((self.a_p + 1) / self.a_p)


PAPER_CAN = Parameters(a=0.727, c=0.615, h=1.473)
