"""The state of a can: as the paper's angles at release, and as pose and twist ever after."""

import math
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import ArrayLike, NDArray

from models.errors import InvalidValueError
from models.quantity import finite

# A unit quaternion rounded to double precision is off by an ulp or two; this admits any that was
# normalised in single precision as well and nothing that was not normalised at all.
_UNIT_TOLERANCE = 1e-6


@dataclass(frozen=True, slots=True, kw_only=True)
class Release:
    """The angles and rates with which a can is let go, rad and rad/s, and how high.

    Parameters
    ----------
    phi : float
        Nutation, the tilt of the symmetry axis from the vertical; between 0 and pi/2, exclusive.
    psi, theta : float
        Precession and rotation (spin about the symmetry axis).
    phi_dot, psi_dot, theta_dot : float
        Their rates.
    height : float
        Of the lowest point of the rim above the plane, m; negative starts inside it. At zero,
        which is what is left out, the can stands on its rim.

    Raises
    ------
    InvalidValueError
        If a number is not finite, or if `phi` is out of its range.
    """

    phi: float
    psi: float = 0.0
    theta: float = 0.0
    phi_dot: float = 0.0
    psi_dot: float = 0.0
    theta_dot: float = 0.0
    height: float = 0.0

    def __post_init__(self) -> None:
        """Refuse a can whose lowest point is not one point of its rim."""
        for field in fields(self):
            object.__setattr__(self, field.name, finite(field.name, getattr(self, field.name)))
        if not 0.0 < self.phi < math.pi / 2.0:
            raise InvalidValueError("phi", self.phi, "greater than 0 and less than pi/2 (radians)")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Pose:
    """Position and orientation of a can.

    Parameters
    ----------
    position : array_like, shape (3,)
        The centre of mass in the world, m.
    quaternion : array_like, shape (4,)
        Rotation from body to world, scalar first, of unit length.

    Raises
    ------
    InvalidValueError
        If a shape is wrong, a number is not finite, or the quaternion is not of unit length.
    """

    position: NDArray[np.float64]
    quaternion: NDArray[np.float64]

    def __post_init__(self) -> None:
        """Keep read-only copies."""
        object.__setattr__(self, "position", _vector("position", self.position, 3))
        object.__setattr__(self, "quaternion", _vector("quaternion", self.quaternion, 4))
        if abs(np.linalg.norm(self.quaternion) - 1.0) > _UNIT_TOLERANCE:
            raise InvalidValueError("quaternion", self.quaternion.tolist(), "of unit length")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Twist:
    """Velocities of a can.

    Parameters
    ----------
    velocity : array_like, shape (3,)
        Of the centre of mass, in world coordinates, m/s.
    angular_velocity : array_like, shape (3,)
        In world coordinates, rad/s.

    Raises
    ------
    InvalidValueError
        If a shape is wrong or a number is not finite.
    """

    velocity: NDArray[np.float64]
    angular_velocity: NDArray[np.float64]

    def __post_init__(self) -> None:
        """Keep read-only copies."""
        object.__setattr__(self, "velocity", _vector("velocity", self.velocity, 3))
        object.__setattr__(
            self, "angular_velocity", _vector("angular_velocity", self.angular_velocity, 3)
        )


def _vector(key: str, value: ArrayLike, size: int) -> NDArray[np.float64]:
    """Return a read-only copy of `value`, shape (size,)."""
    vector = np.array(value, dtype=np.float64)
    if vector.shape != (size,) or not np.isfinite(vector).all():
        raise InvalidValueError(key, vector.tolist(), f"{size} finite numbers")
    vector.flags.writeable = False
    return vector
