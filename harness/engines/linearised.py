"""A motion with its derivative by a change of the release, as an engine differentiates itself.

A change of the state is 12 numbers: the place of the centre of mass (m), a rotation vector of the
can (rad), its velocity (m/s) and its angular velocity (rad/s), all in world coordinates.
"""

from dataclasses import dataclass, replace

import numpy as np

from harness.core.trajectory import Floats, Trajectory
from models.state import Pose, Twist


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LinearisedMotion:
    """A motion and how it changes with its release, to first order.

    Parameters
    ----------
    trajectory : Trajectory
        n samples.
    changes : ndarray, shape (n, 12, k)
        Of the state at each sample, by each of k changes of the release.
    by_differences : bool
        Whether the engine differentiates a step by differences, whose step then matters, or its
        program, exactly.
    why : str
        Why the changes are not numbers, in a sentence; empty where they are.
    """

    trajectory: Trajectory
    changes: Floats
    by_differences: bool = True
    why: str = ""

    def displaced(self, column: int, size: float) -> Trajectory:
        """Return the motion of a release that is changed by so much of one of the changes."""
        x = size * self.changes[:, :, column]
        own = self.trajectory
        return replace(
            own,
            position=own.position + x[:, :3],
            quaternion=turned(own.quaternion, x[:, 3:6]),
            velocity=own.velocity + x[:, 6:9],
            angular_velocity=own.angular_velocity + x[:, 9:12],
        )


def turned(quaternion: Floats, rotation: Floats) -> Floats:
    """Return orientations turned by rotation vectors in world coordinates.

    Parameters
    ----------
    quaternion : ndarray, shape (n, 4)
    rotation : ndarray, shape (n, 3)
        rad.
    """
    angle = np.linalg.norm(rotation, axis=1, keepdims=True)
    axis = rotation * (np.sinc(angle / (2.0 * np.pi)) / 2.0)
    w, v = np.cos(angle / 2.0), axis
    w0, v0 = quaternion[:, :1], quaternion[:, 1:]
    scalar = w * w0 - np.sum(v * v0, axis=1, keepdims=True)
    product: Floats = np.hstack((scalar, w * v0 + w0 * v + np.cross(v, v0)))
    return np.asarray(product / np.linalg.norm(product, axis=1, keepdims=True))


def change_between(before: tuple[Pose, Twist], after: tuple[Pose, Twist], size: float) -> Floats:
    """Return the difference of two states over a size, shape (12,); they are near each other."""
    (pose, twist), (further, faster) = before, after
    w0, v0 = pose.quaternion[0], -pose.quaternion[1:]
    w, v = further.quaternion[0], further.quaternion[1:]
    rotation = 2.0 * (w * v0 + w0 * v + np.cross(v, v0))
    difference = np.concatenate(
        (
            further.position - pose.position,
            rotation * np.sign(w * w0 - v @ v0),
            faster.velocity - twist.velocity,
            faster.angular_velocity - twist.angular_velocity,
        )
    )
    return np.asarray(difference / size, dtype=np.float64)
