"""The state of a can after its release: pose and twist."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from models.errors import InvalidValueError

# A unit quaternion rounded to double precision is off by an ulp or two; this admits any that was
# normalised in single precision as well and nothing that was not normalised at all.
_UNIT_TOLERANCE = 1e-6


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
        if abs(math.hypot(*self.quaternion.tolist()) - 1.0) > _UNIT_TOLERANCE:
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
    # of so few numbers Python asks faster than numpy
    if vector.shape != (size,) or not all(map(math.isfinite, vector.tolist())):
        raise InvalidValueError(key, vector.tolist(), f"{size} finite numbers")
    vector.flags.writeable = False
    return vector
