"""Rigid-body mechanics of the rolling can at one instant, told from Newton and Euler anew.

Neither the reference nor an engine has a part in it. The centre has acceleration a, the body has
angular acceleration e, the plane pushes with F at the offset r of the contact point:

    m a = F - m g z
    I e + omega x I omega = r x F
    a + e x r + omega x r' = 0

The last line is the rolling condition v + omega x r = 0, once differentiated; r' is how the
contact offset moves as the contact point runs round the rim. With the axis n, its tilt phi
(c = cos phi = n_z, s = sin phi), and the direction d = (n c - z)/s from the middle of the base to
its lowest point,

    r = R d - H n,    n' = omega x n,    d' = (n' c + n n_z' + d n_z' c/s)/s

since s' = -c n_z'/s. Nine equations are linear in the nine components of a, e and F.
"""

import math

import numpy as np

from harness.trajectory import Floats
from models.can import Can
from models.kinematics import to_body
from models.state import Pose, Twist

_UP = np.array((0.0, 0.0, 1.0))


def rolling_acceleration(
    can: Can, gravity: float, pose: Pose, twist: Twist
) -> tuple[Floats, Floats, Floats]:
    """Return a, e and F of a can that rolls without slipping on the plane.

    Parameters
    ----------
    can : Can
    gravity : float
        m/s^2.
    pose : Pose
        Tilted, so that the lowest point is one.
    twist : Twist
        Its velocity has no part in the answer: rolling gives it from the angular velocity.

    Returns
    -------
    a, e, F : ndarray, shape (3,)
        m/s^2, rad/s^2 and N, in world coordinates.
    """
    R_WB = to_body(pose.quaternion, np.eye(3))  # row i is the world's axis i in the body's frame
    moments = np.array((can.transverse_inertia, can.transverse_inertia, can.axial_inertia))
    inertia, omega = R_WB @ np.diag(moments) @ R_WB.T, twist.angular_velocity
    n = R_WB[:, 2]
    c, s = n[2], math.hypot(n[0], n[1])
    d = (n * c - _UP) / s
    n_dot = np.cross(omega, n)
    d_dot = (n_dot * c + n * n_dot[2] + d * n_dot[2] * c / s) / s
    r = can.radius * d - can.half_height * n
    r_dot = can.radius * d_dot - can.half_height * n_dot
    one, none, arm = np.eye(3), np.zeros((3, 3)), _cross(r)
    matrix = np.block(
        [
            [can.mass * one, none, -one],
            [none, inertia, -arm],
            [one, -arm, none],
        ]
    )
    right = np.concatenate(
        (
            -can.mass * gravity * _UP,
            -np.cross(omega, inertia @ omega),
            -np.cross(omega, r_dot),
        )
    )
    found: Floats = np.linalg.solve(matrix, right)
    return found[:3], found[3:6], found[6:]


def _cross(vector: Floats) -> Floats:
    """Return the matrix that takes w to vector x w."""
    matrix: Floats = np.cross(vector, np.eye(3)).T
    return matrix
