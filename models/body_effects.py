"""Effects on the can and its surroundings: drag, tilt, shaking, a mass off the axis.

Each class holds the constants of one law, in SI units. The world's frame is that of the plane, z
along its normal, whatever the plane does: a tilted plane is a tilted gravity, a shaken plane an
acceleration of its frame, so that angles and contact locus keep their meaning.
"""

import math
from dataclasses import dataclass, fields
from typing import ClassVar

from models.errors import InvalidValueError
from models.quantity import finite, not_negative, positive


@dataclass(frozen=True, slots=True, kw_only=True)
class Damping:
    """Drag in proportion to velocity: force -m linear v, moment -angular I omega, at the centre.

    Modelling choice: the velocity is relative to the plane, also of one that is shaken, as if the
    air moved with it.

    Parameters
    ----------
    linear, angular : float
        Rates of decay, 1/s, zero or greater, not both zero.

    Raises
    ------
    InvalidValueError
        If a rate is negative or not finite, or if both are zero.
    """

    modelling_choice: ClassVar[str] = (
        "Drag is against the motion relative to the plane, also where the plane is shaken: the "
        "air is supposed to move with it; its linear part acts at the centre of mass."
    )

    linear: float = 0.0
    angular: float = 0.0

    def __post_init__(self) -> None:
        """Refuse drag that drives, or is none."""
        for field in fields(self):
            value = not_negative(field.name, getattr(self, field.name))
            object.__setattr__(self, field.name, value)
        if self.linear == self.angular == 0.0:
            raise InvalidValueError("linear", 0.0, "greater than zero, or `angular` must be")


@dataclass(frozen=True, slots=True, kw_only=True)
class Tilt:
    """A plane that is not level: gravity is g (sin a cos d, sin a sin d, -cos a) in its frame.

    Parameters
    ----------
    angle : float
        a, rad, greater than 0 and less than pi/2.
    direction : float
        d, rad: which way is down the plane, from its x-axis.

    Raises
    ------
    InvalidValueError
        If an angle is out of its range.
    """

    modelling_choice: ClassVar[str] = (
        "A tilted plane is a tilted gravity in the frame of the plane."
    )

    angle: float
    direction: float = 0.0

    def __post_init__(self) -> None:
        """Refuse a wall."""
        allowed = "greater than 0 and less than pi/2 (radians)"
        angle = finite("angle", self.angle, allowed)
        if not 0.0 < angle < math.pi / 2.0:
            raise InvalidValueError("angle", angle, allowed)
        object.__setattr__(self, "angle", angle)
        object.__setattr__(self, "direction", finite("direction", self.direction))


@dataclass(frozen=True, slots=True, kw_only=True)
class Shake:
    """A plane that is shaken: its displacement is (horizontal e_d, vertical) sin(2 pi f t + phase).

    In the plane's frame gravity gains (2 pi f)^2 (horizontal e_d, vertical) sin(2 pi f t + phase).
    The release, and every velocity, is relative to the plane.

    Parameters
    ----------
    frequency : float
        f, Hz, greater than zero.
    horizontal, vertical : float
        Amplitudes, m, zero or greater, not both zero.
    direction : float
        d, rad: of the horizontal shaking, from the x-axis; e_d is its unit vector.
    phase : float
        rad, at the release.

    Raises
    ------
    InvalidValueError
        If a number is out of its range, or if both amplitudes are zero.
    """

    modelling_choice: ClassVar[str] = (
        "A shaken plane is a gravity that changes with time in the frame of the plane: the "
        "release and every velocity are relative to it."
    )

    frequency: float
    horizontal: float = 0.0
    vertical: float = 0.0
    direction: float = 0.0
    phase: float = 0.0

    def __post_init__(self) -> None:
        """Refuse a plane that is not shaken at all."""
        object.__setattr__(self, "frequency", positive("frequency", self.frequency))
        for name in ("horizontal", "vertical"):
            object.__setattr__(self, name, not_negative(name, getattr(self, name)))
        for name in ("direction", "phase"):
            object.__setattr__(self, name, finite(name, getattr(self, name)))
        if self.horizontal == self.vertical == 0.0:
            raise InvalidValueError("horizontal", 0.0, "greater than zero, or `vertical` must be")


@dataclass(frozen=True, slots=True, kw_only=True)
class PointMass:
    """A point mass fixed to the can, in addition to the can's own mass and moments.

    Off the axis it makes the rolling can chaotic (Srinivasan and Ruina).

    Parameters
    ----------
    mass : float
        kg, greater than zero.
    x, y, z : float
        Where, from the centre of the can in axes fixed to it, m: z along the symmetry axis away
        from the rim it rolls on, x away from the contact point where theta is zero (the paper's
        frame B, sec01:derivation). Inside the can, which the scene checks, and not all zero.

    Raises
    ------
    InvalidValueError
        If a number is out of its range.
    """

    modelling_choice: ClassVar[str] = (
        "A point mass is added to the mass and the moments of the can, which stay as declared."
    )

    mass: float
    x: float = 0.0
    y: float = 0.0
    z: float = 0.0

    def __post_init__(self) -> None:
        """Refuse a mass that is none, or one in the centre, which belongs to the can's own."""
        object.__setattr__(self, "mass", positive("mass", self.mass))
        for name in ("x", "y", "z"):
            object.__setattr__(self, name, finite(name, getattr(self, name)))
        if self.x == self.y == self.z == 0.0:
            raise InvalidValueError("x", 0.0, "not zero, or `y` or `z` must not be")
