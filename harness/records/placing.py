"""Poses of a record, turned and moved to where the exact motion starts.

The plane has no direction and no origin, and the can none about its axis: where a scene has no
effect that gives it one, a record may start at any heading and place, and is put where the exact
motion starts; what was done is told.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from harness.core.trajectory import Floats
from harness.records.convention import multiplied, turned
from models.kinematics import angles as angles_of
from models.rim import released
from models.scene import Scene

CONJUGATE = np.array((1.0, -1.0, -1.0, -1.0))
"""Signs of the inverse of a unit quaternion."""

ALIKE = 1e-6
"""rad, and radii: motions that differ by less are one."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Poses:
    """Poses in our convention.

    Parameters
    ----------
    time : ndarray, shape (n,)
        s, from the first sample on.
    position : ndarray, shape (n, 3)
        Of the centre of the can in the world, m.
    quaternion : ndarray, shape (n, 4)
        From body to world, scalar first.
    """

    time: Floats
    position: Floats
    quaternion: Floats


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Placed:
    """Poses that were turned and moved to the start of the exact motion.

    Parameters
    ----------
    heading : ndarray, shape (4,)
        Turn of the world about the vertical.
    roll : ndarray, shape (4,)
        Turn of the can about its axis.
    shift : ndarray, shape (3,)
        Move after that, m.
    poses : Poses
    said : tuple of str
    """

    heading: Floats
    roll: Floats
    shift: Floats
    poses: Poses
    said: tuple[str, ...]

    @classmethod
    def of(cls, poses: Poses, scene: Scene) -> "Placed":
        """Return poses as the scene's symmetries allow them to be placed."""
        heading = own = np.array((1.0, 0.0, 0.0, 0.0))
        still, effects, said = np.zeros(3), scene.effects, list[str]()
        if effects.tilt is None and effects.shake is None:
            _, psi, theta = (float(each) for each in angles_of(poses.quaternion[0]))
            q, position = poses.quaternion, poses.position
            yaw = math.remainder(scene.release.psi - psi, 2.0 * math.pi)
            roll = math.remainder(scene.release.theta - theta, 2.0 * math.pi)
            if effects.point_mass is not None:
                roll = 0.0  # the mass is where it is
            if abs(yaw) > ALIKE:
                heading = np.array((math.cos(yaw / 2.0), 0.0, 0.0, math.sin(yaw / 2.0)))
                q, position = multiplied(heading, q), turned(heading, position)
                said.append(f"turned by {math.degrees(yaw):.6g} degrees about the vertical")
            if abs(roll) > ALIKE:
                own = np.array((math.cos(roll / 2.0), 0.0, 0.0, math.sin(roll / 2.0)))
                q = multiplied(q, np.broadcast_to(own, q.shape))
                said.append(f"turned by {math.degrees(roll):.6g} degrees about its axis")
            start, _ = released(scene)
            still = (start.position - position[0]) * (1.0, 1.0, 0.0)
            if np.abs(still).max() > ALIKE * scene.can.radius:
                said.append(f"moved by {still[0]:.6g} m and {still[1]:.6g} m along the plane")
            else:
                still = np.zeros(3)
            poses = replace(poses, position=position + still, quaternion=q)
        return cls(heading=heading, roll=own, shift=still, poses=poses, said=tuple(said))
