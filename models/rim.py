"""The rim and the plane: where an ideal can touches, how it moves there, and how it is released.

From the centre of mass G the lowest point of the rim is at (-R, 0, -H) in the paper's frame B
(sec01:derivation). This is the contact point P of a rigid can on the plane z = 0; for an engine's
can, which may sink or hover, it is the point to compare with.
"""

import numpy as np
from numpy.typing import ArrayLike

from models.can import Can
from models.kinematics import Floats, angles, angular_velocity, quaternion
from models.state import Pose, Release, Twist


def contact_offset(can: Can, phi: ArrayLike, psi: ArrayLike) -> Floats:
    """Return the vector from the centre of mass to the lowest point of the can.

    Parameters
    ----------
    can : Can
    phi, psi : array_like, shape (...)
        rad. Past phi = pi/2 the can lies lower on its other rim, and that one is taken.

    Returns
    -------
    ndarray, shape (..., 3)
        In world coordinates, m.
    """
    phi, psi = np.broadcast_arrays(phi, psi)
    sin, cos = np.sin(phi), np.cos(phi)
    R, H = can.radius, np.where(cos < 0.0, -can.half_height, can.half_height)
    outwards = H * sin - R * cos
    return np.stack((outwards * np.cos(psi), outwards * np.sin(psi), -R * sin - H * cos), axis=-1)


def contact_point(can: Can, position: ArrayLike, quaternion: ArrayLike) -> Floats:
    """Return the lowest point of the can: on the plane z = 0, the contact point of a rigid can.

    Parameters
    ----------
    can : Can
    position : array_like, shape (..., 3)
        The centre of mass in the world, m.
    quaternion : array_like, shape (..., 4)
        From body to world, scalar first.

    Returns
    -------
    ndarray, shape (..., 3)
        In world coordinates, m. Its height, [..., 2], is the gap to the plane, or minus the depth.
    """
    phi, psi, _ = angles(quaternion)
    return np.asarray(position, dtype=np.float64) + contact_offset(can, phi, psi)


def contact_velocity(
    can: Can, quaternion: ArrayLike, velocity: ArrayLike, angular_velocity: ArrayLike
) -> Floats:
    """Return the velocity of the material point that is the lowest of the can.

    Parameters
    ----------
    can : Can
    quaternion : array_like, shape (..., 4)
        From body to world, scalar first.
    velocity, angular_velocity : array_like, shape (..., 3)
        Of the centre of mass and of the body, in world coordinates, m/s and rad/s.

    Returns
    -------
    ndarray, shape (..., 3)
        m/s; zero in rolling (eq01:constraint), its horizontal part is the slip.
    """
    phi, psi, _ = angles(quaternion)
    spin = np.asarray(angular_velocity, dtype=np.float64)
    return np.asarray(velocity, dtype=np.float64) + np.cross(spin, contact_offset(can, phi, psi))


def rolling_velocity(
    can: Can, phi: ArrayLike, psi: ArrayLike, angular_velocity: ArrayLike
) -> Floats:
    """Return the velocity of the centre of mass of a can that rolls without slipping.

    Parameters
    ----------
    can : Can
    phi, psi : array_like, shape (...)
        rad.
    angular_velocity : array_like, shape (..., 3)
        In world coordinates, rad/s.

    Returns
    -------
    ndarray, shape (..., 3)
        In world coordinates, m/s (eq01:com_velocity).
    """
    spin = np.asarray(angular_velocity, dtype=np.float64)
    velocity: Floats = np.cross(contact_offset(can, phi, psi), spin)
    return velocity


def release_state(can: Can, release: Release) -> tuple[Pose, Twist]:
    """Return the can at its release: the lowest point of its rim at rest, at z = `height`.

    Parameters
    ----------
    can : Can
    release : Release

    Returns
    -------
    Pose, Twist
        The centre of mass is above the origin of the world.
    """
    r = release
    height = r.height - contact_offset(can, r.phi, r.psi)[2]
    omega = angular_velocity(r.phi, r.psi, r.phi_dot, r.psi_dot, r.theta_dot)
    pose = Pose(position=np.array((0.0, 0.0, height)), quaternion=quaternion(r.phi, r.psi, r.theta))
    velocity = rolling_velocity(can, r.phi, r.psi, omega)
    return pose, Twist(velocity=velocity, angular_velocity=omega)
