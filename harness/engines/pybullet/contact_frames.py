"""Between the frame that PyBullet moves and the frame of the can.

PyBullet moves the principal axes at the centre of mass. Of a can without a point mass those are the
can's own; with one they are turned and off its centre:

    R_WB = R_WI R_IB,    p = p_com - R_WB c,    v = v_com - omega x R_WB c

with c the centre of mass from the can's centre in the can's axes.
"""

from collections.abc import Callable, Sequence
from typing import TypeAlias

import numpy as np

from harness.core.trajectory import Floats

Numbers: TypeAlias = Sequence[float]
State: TypeAlias = tuple[Numbers, Numbers, Numbers, Numbers]
"""Position, quaternion (scalar last), velocity, angular velocity, in world coordinates."""


_UNITS = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


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
        self.centre = (centre[0], centre[1], centre[2])
        self._axes, self._back = (x, y, z, w), (-x, -y, -z, w)

    @property
    def rotation(self) -> Floats:
        """The principal axes as columns in the can's axes, shape (3, 3)."""
        columns: Floats = np.array([_turned(self._axes, unit) for unit in _UNITS]).T
        return columns

    def can(
        self, position: Numbers, quaternion: Numbers, velocity: Numbers, spin: Numbers
    ) -> State:
        """Return the state of the can's own frame, given that of PyBullet's."""
        turned = _product(quaternion, self._back)
        return self._shifted(-1.0, turned, position, velocity, spin, turned)

    def principal(
        self, position: Numbers, quaternion: Numbers, velocity: Numbers, spin: Numbers
    ) -> State:
        """Return the state of PyBullet's frame, given that of the can's."""
        turned = _product(quaternion, self._axes)
        return self._shifted(1.0, quaternion, position, velocity, spin, turned)

    def _shifted(  # noqa: PLR0917 - a state, and whose axes to shift it in
        self,
        sign: float,
        body: Numbers,
        position: Numbers,
        velocity: Numbers,
        spin: Numbers,
        quaternion: Numbers,
    ) -> State:
        x, y, z = _turned(body, self.centre)
        x, y, z = sign * x, sign * y, sign * z
        o_x, o_y, o_z = spin
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
"""Turns a state as PyBullet says it into that of the can."""


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
