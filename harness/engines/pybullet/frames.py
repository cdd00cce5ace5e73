"""PyBullet's frame in the can: the principal axes at the centre of mass.

The harness reads the centre of the can and its axes. Without a point mass the axes are the same;
with one they are turned and off the centre:

    R_WB = R_WI R_IB,    p = p_com - R_WB c,    v = v_com - omega x R_WB c

with c the centre of mass from the can's centre in the can's axes. Quaternions are scalar last.
"""

from collections.abc import Callable, Sequence
from typing import TypeAlias

import numpy as np

from harness.engines import Floats
from models import to_body

Numbers: TypeAlias = Sequence[float]
State: TypeAlias = tuple[Numbers, Numbers, Numbers, Numbers]
"""Position, quaternion (scalar last), velocity, angular velocity, in world coordinates."""


class Frames:
    """Where PyBullet's frame lies in a can.

    Parameters
    ----------
    centre : sequence of 3 floats
        The centre of mass in the can's axes, from the can's centre, m.
    axes : sequence of 4 floats
        Quaternion from PyBullet's frame to the can's, scalar last.
    """

    def __init__(self, centre: Numbers, axes: Numbers) -> None:
        x, y, z, w = axes
        self.centre, self._from_centre = tuple(centre), tuple(-part for part in centre)
        self._axes, self._back = (x, y, z, w), (-x, -y, -z, w)

    @property
    def rotation(self) -> Floats:
        """The principal axes as columns in the can's axes, shape (3, 3)."""
        x, y, z, w = self._axes
        return to_body((w, x, y, z), np.eye(3))

    def can(
        self, position: Numbers, quaternion: Numbers, velocity: Numbers, spin: Numbers
    ) -> State:
        """Return the state of the can's own frame, given that of PyBullet's."""
        turned = _product(quaternion, self._back)
        arm = _turned(turned, self._from_centre)
        return _shifted(position, turned, velocity, spin, arm)

    def principal(
        self, position: Numbers, quaternion: Numbers, velocity: Numbers, spin: Numbers
    ) -> State:
        """Return the state of PyBullet's frame, given that of the can's."""
        turned = _product(quaternion, self._axes)
        return _shifted(position, turned, velocity, spin, _turned(quaternion, self.centre))


def _shifted(
    position: Numbers, quaternion: Numbers, velocity: Numbers, spin: Numbers, arm: Numbers
) -> State:
    """Return the state of a point at the end of an arm, in a frame of its own orientation."""
    (x, y, z), (o_x, o_y, o_z) = arm, spin
    return (
        (position[0] + x, position[1] + y, position[2] + z),
        quaternion,
        (
            velocity[0] + o_y * z - o_z * y,
            velocity[1] + o_z * x - o_x * z,
            velocity[2] + o_x * y - o_y * x,
        ),
        spin,
    )


Reading: TypeAlias = Callable[[Numbers, Numbers, Numbers, Numbers], State]
"""Turns a state of PyBullet's frame into that of the can."""


def _product(first: Numbers, second: Numbers) -> tuple[float, float, float, float]:
    """Return the product of two quaternions, scalar last: the second turn, then the first."""
    x, y, z, w = first
    a, b, c, d = second
    return (
        w * a + x * d + y * c - z * b,
        w * b - x * c + y * d + z * a,
        w * c + x * b - y * a + z * d,
        w * d - x * a - y * b - z * c,
    )


def _turned(quaternion: Numbers, vector: Numbers) -> tuple[float, float, float]:
    """Return a vector turned by a quaternion, scalar last."""
    x, y, z, w = quaternion
    a, b, c = vector
    t_x, t_y, t_z = 2.0 * (y * c - z * b), 2.0 * (z * a - x * c), 2.0 * (x * b - y * a)
    return (
        a + w * t_x + y * t_z - z * t_y,
        b + w * t_y + z * t_x - x * t_z,
        c + w * t_z + x * t_y - y * t_x,
    )
