"""The rim and the plane: where an ideal can touches, how it moves there, and how it is released.

From the centre of mass G the lowest point of the rim is at (-R, 0, -H) in the paper's frame B
(sec01:derivation). This is the contact point P of a rigid can on the plane z = 0; for an engine's
can, which may sink or hover, it is the point to compare with. A rim that is an arc of radius r
about a circle of radius R - r, H - r below the centre, touches straight below that circle:
(-(R - r), 0, -(H - r)) turned into the world, and r down.
"""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from models.can import Can
from models.effects import Effects
from models.kinematics import Floats, angles, angular_velocity, quaternion
from models.release import Release
from models.scene import Scene
from models.state import Pose, Twist


def contact_offset(can: Can, phi: ArrayLike, psi: ArrayLike, *, arc: float = 0.0) -> Floats:
    """Return the vector from the centre of mass to the lowest point of the can.

    Parameters
    ----------
    can : Can
    phi, psi : array_like, shape (...)
        rad. Past phi = pi/2 the can lies lower on its other rim, and that one is taken.
    arc : float
        Radius of the arc that rounds the rim, m; none for a sharp rim.

    Returns
    -------
    ndarray, shape (..., 3)
        In world coordinates, m.
    """
    given: Any = phi, psi
    if all(isinstance(angle, float) for angle in given):
        return _single_offset(can, given[0], given[1], arc)
    R, below = can.radius - arc, can.half_height - arc
    phi, psi = np.broadcast_arrays(phi, psi)
    sin, cos = np.sin(phi), np.cos(phi)
    H = np.where(cos < 0.0, -below, below)
    outwards, down = H * sin - R * cos, -R * sin - H * cos - arc
    return np.stack((outwards * np.cos(psi), outwards * np.sin(psi), down), axis=-1)


def _single_offset(can: Can, phi: float, psi: float, arc: float) -> Floats:
    """Return the same of one can, as probes ask: in a ninth of the time that arrays take."""
    R, below = can.radius - arc, can.half_height - arc
    # numpy's functions, which are not Python's to the last bit
    functions = np.array((np.sin(phi), np.cos(phi), np.cos(psi), np.sin(psi)))
    sin, cos, along, across = functions.tolist()
    H = -below if cos < 0.0 else below
    outwards, down = H * sin - R * cos, -R * sin - H * cos - arc
    return np.array((outwards * along, outwards * across, down))


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
    can: Can, phi: ArrayLike, psi: ArrayLike, angular_velocity: ArrayLike, *, arc: float = 0.0
) -> Floats:
    """Return the velocity of the centre of mass of a can that rolls without slipping.

    Parameters
    ----------
    can : Can
    phi, psi : array_like, shape (...)
        rad.
    angular_velocity : array_like, shape (..., 3)
        In world coordinates, rad/s.
    arc : float
        Radius of the arc that rounds the rim, m.

    Returns
    -------
    ndarray, shape (..., 3)
        In world coordinates, m/s (eq01:com_velocity).
    """
    spin = np.asarray(angular_velocity, dtype=np.float64)
    velocity: Floats = np.cross(contact_offset(can, phi, psi, arc=arc), spin)
    return velocity


def release_state(can: Can, release: Release, *, arc: float = 0.0) -> tuple[Pose, Twist]:
    """Return the can at its release: the lowest point of its rim at rest, at z = `height`.

    Parameters
    ----------
    can : Can
    release : Release
    arc : float
        Radius of the arc that rounds the rim, m.

    Returns
    -------
    Pose, Twist
        The centre of the can is above the origin of the world.
    """
    r = release
    height = r.height - contact_offset(can, r.phi, r.psi, arc=arc)[2]
    omega = angular_velocity(r.phi, r.psi, r.phi_dot, r.psi_dot, r.theta_dot)
    pose = Pose(position=np.array((0.0, 0.0, height)), quaternion=quaternion(r.phi, r.psi, r.theta))
    velocity = rolling_velocity(can, r.phi, r.psi, omega, arc=arc)
    return pose, Twist(velocity=velocity, angular_velocity=omega)


def released(scene: Scene) -> tuple[Pose, Twist]:
    """Return the can of a scene at its release, on the rim that its effects give it."""
    return release_state(scene.can, scene.release, arc=arc_of(scene.effects))


def arc_of(effects: Effects) -> float:
    """Return the radius of the arc that rounds the rim, m; zero for a sharp one."""
    return 0.0 if effects.rim is None else effects.rim.radius
