"""A trajectory: the motion of an engine as read-only arrays on the engine's own time grid."""

from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from harness.core.errors import TrajectoryError

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


@dataclass(eq=False, kw_only=True)
class ArrayShapeError(TrajectoryError):
    """The array `name` has another shape than the number of samples makes it need."""

    name: str
    shape: tuple[int, ...]
    expected: tuple[int, ...]

    def __str__(self) -> str:
        """Return both shapes."""
        return (
            f"`{self.name}` has shape {self.shape}, but {self.expected[0]} samples need "
            f"{self.expected}"
        )


class TimeOrderError(TrajectoryError):
    """The instants of a trajectory do not increase, or there are none."""

    def __str__(self) -> str:
        """Say what time must do."""
        return "`time` must hold at least one instant and increase strictly"


_WIDTHS = {
    "time": None,
    "position": 3,
    "quaternion": 4,
    "velocity": 3,
    "angular_velocity": 3,
    "contact_point": 3,
    "contact_force": 3,
    "penetration": None,
    "contact_count": None,
}


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Trajectory:
    """Pose, twist and contact of the can at the same instants.

    Parameters
    ----------
    time : ndarray, shape (n,)
        s, strictly increasing.
    position, velocity : ndarray, shape (n, 3)
        Of the centre of mass in the world, m and m/s.
    quaternion : ndarray, shape (n, 4)
        Rotation from body to world, scalar first.
    angular_velocity : ndarray, shape (n, 3)
        In world coordinates, rad/s.
    contact_point : ndarray, shape (n, 3)
        Mean of the engine's contact points weighted with their normal forces, m; NaN where no
        contact has a force.
    contact_force : ndarray, shape (n, 3)
        Sum of the plane's forces on the can, N; zero where there is none. NaN throughout in the
        record of a program that tells none: then the count says where the can touches.
    penetration : ndarray, shape (n,)
        Depth of the deepest contact, m; negative or NaN where there is a gap.
    contact_count : ndarray of int, shape (n,)
        Number of the engine's contact points in samples with a contact force, else zero; points
        without a force are not counted where the engine gives the force of each.

    Raises
    ------
    ArrayShapeError
        If an array has the wrong shape.
    TimeOrderError
        If time does not increase.
    """

    time: Floats
    position: Floats
    quaternion: Floats
    velocity: Floats
    angular_velocity: Floats
    contact_point: Floats
    contact_force: Floats
    penetration: Floats
    contact_count: Integers

    def __post_init__(self) -> None:
        """Check the shapes and lock the arrays."""
        samples = len(self.time)
        for name, width in _WIDTHS.items():
            kind = np.int64 if name == "contact_count" else np.float64
            array = np.array(getattr(self, name), dtype=kind)
            expected = (samples,) if width is None else (samples, width)
            if array.shape != expected:
                raise ArrayShapeError(name=name, shape=array.shape, expected=expected)
            array.flags.writeable = False
            object.__setattr__(self, name, array)
        if samples == 0 or not (self.time[1:] > self.time[:-1]).all():
            raise TimeOrderError

    def __len__(self) -> int:
        """Return the number of samples."""
        return len(self.time)

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle by the fields, so that the arrays are locked again on the other side."""
        return partial(Trajectory, **{name: getattr(self, name) for name in _WIDTHS}), ()


def join(parts: list[Trajectory], until: float = np.inf) -> Trajectory:
    """Return the concatenation of trajectories, up to an instant in s."""
    count = int(sum(np.searchsorted(part.time, until, side="right") for part in parts))
    return Trajectory(
        **{
            name: np.concatenate([getattr(part, name) for part in parts])[:count]
            for name in _WIDTHS
        }
    )


def take(trajectory: Trajectory, keep: NDArray[np.bool_] | Integers) -> Trajectory:
    """Return the samples that `keep` selects."""
    return Trajectory(**{name: getattr(trajectory, name)[keep] for name in _WIDTHS})
