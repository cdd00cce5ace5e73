"""The can: a rigid, rotationally symmetric cylinder that stands or rolls on the rim of its base.

Its moments of inertia are declared, not derived from its shape: an empty drinks can is no solid
cylinder. The dimensionless groups are those of the paper, (eq01:scalings):
a = A/(m R^2), c = C/(m R^2), h = H/R.
"""

import math
from dataclasses import dataclass, fields
from typing import Self

from models.errors import InvalidValueError
from models.quantity import positive

AXIAL_INERTIA_ALLOWED = (
    "at most twice the moment about a transverse axis: no rigid body has C greater than 2A"
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Can:
    """A can, in SI units.

    Parameters
    ----------
    mass : float
        m, kg.
    radius : float
        R, m.
    half_height : float
        H, m: the can is 2H tall and its centre of mass is in the middle.
    transverse_inertia : float
        A, kg m^2, about every axis through the centre of mass perpendicular to the symmetry axis.
    axial_inertia : float
        C, kg m^2, about the symmetry axis.

    Raises
    ------
    InvalidValueError
        If a number is not finite and positive, or if C > 2A.
    """

    mass: float
    radius: float
    half_height: float
    transverse_inertia: float
    axial_inertia: float

    def __post_init__(self) -> None:
        """Refuse what is not a rigid body."""
        for field in fields(self):
            object.__setattr__(self, field.name, positive(field.name, getattr(self, field.name)))
        if self.axial_inertia > 2.0 * self.transverse_inertia:
            raise InvalidValueError("axial_inertia", self.axial_inertia, AXIAL_INERTIA_ALLOWED)

    @classmethod
    def from_groups(cls, *, mass: float, radius: float, a: float, c: float, h: float) -> Self:
        """Build a can from its mass (kg), its radius (m) and the paper's dimensionless groups.

        Raises
        ------
        InvalidValueError
            As for `Can`; the keys are then `a`, `c` and `h`.
        """
        mass, radius = positive("mass", mass), positive("radius", radius)
        a, c, h = positive("a", a), positive("c", c), positive("h", h)
        if c > 2.0 * a:
            raise InvalidValueError("c", c, AXIAL_INERTIA_ALLOWED)
        unit = mass * (radius * radius)
        return cls(
            mass=mass,
            radius=radius,
            half_height=h * radius,
            transverse_inertia=a * unit,
            axial_inertia=c * unit,
        )

    @property
    def a(self) -> float:
        """A/(m R^2), dimensionless."""
        return self.transverse_inertia / (self.mass * (self.radius * self.radius))

    @property
    def c(self) -> float:
        """C/(m R^2), dimensionless."""
        return self.axial_inertia / (self.mass * (self.radius * self.radius))

    @property
    def h(self) -> float:
        """H/R, dimensionless."""
        return self.half_height / self.radius

    @property
    def slowness(self) -> float:
        """The angle chi = slowness psi turns by pi in a hard bounce, dimensionless.

        sqrt(a_p/(a_p + 1)) with a_p = a + h^2: near the flat state phi exp(i chi) moves on a
        straight line (eq01:inner_problem, eq01:angle_of_turn).
        """
        a_p = self.a + self.h**2
        return math.sqrt(a_p / (a_p + 1.0))

    @property
    def balancing_angle(self) -> float:
        """The tilt phi* = arctan(R/H) at which the can balances on its rim (eq:phistar), rad."""
        return math.atan2(self.radius, self.half_height)

    @property
    def bounding_radius(self) -> float:
        """The distance of the rim from the centre of mass, m."""
        return math.hypot(self.radius, self.half_height)
