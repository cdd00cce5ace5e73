"""What a run is held against: the exact motion of its scene, where there is one.

Beside the truth of the runner, whatever the effects of the scene, there is one more exact motion. A
can without gravity turns as a free symmetric top: with the angular momentum L, which stays, and the
axial rate w, which stays as well, its angular velocity is

    Omega = L/A + (1 - C/A) w e,    so that    R(t) = exp(L t/A) R(0) exp((1 - C/A) w t e_3).
"""

from dataclasses import dataclass

import numpy as np

from harness.bounce import Bounce
from harness.runner import Evaluation
from harness.trajectory import Floats, Trajectory
from models.kinematics import to_body
from models.scene import Scene


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Exact:
    """An exact motion at the instants of a run, up to where it is defined.

    Parameters
    ----------
    time, phi : ndarray, shape (n,)
        s and rad.
    bounces : tuple of Bounce
    """

    time: Floats
    phi: Floats
    bounces: tuple[Bounce, ...]


def exact(e: Evaluation) -> Exact | None:
    """Return the exact motion that a rolling or sliding can is held against, if there is one."""
    if e.truth is None or e.truth_pulls:
        return None
    return Exact(time=e.truth.time, phi=e.truth.angles.phi, bounces=e.true_bounces)


def free_rotation(trajectory: Trajectory, scene: Scene) -> Floats:
    """Return the orientations of a can that turns freely, from the first of a trajectory.

    Parameters
    ----------
    trajectory : Trajectory
        Only its times and its first sample matter.
    scene : Scene

    Returns
    -------
    ndarray, shape (n, 4)
        From body to world, scalar first.
    """
    A, C = scene.can.transverse_inertia, scene.can.axial_inertia
    start, omega = trajectory.quaternion[0], trajectory.angular_velocity[0]
    axial = float(to_body(start, omega)[2])
    axis = _rotated(start, np.array((0.0, 0.0, 1.0)))
    rate = omega - (1.0 - C / A) * axial * axis  # L/A
    t = trajectory.time - trajectory.time[0]
    spin = np.array((0.0, 0.0, (1.0 - C / A) * axial))
    return _product(_product(_turned(rate, t), start), _turned(spin, t))


def _turned(rate: Floats, time: Floats) -> Floats:
    """Return the rotations exp(rate t), shape (n, 4)."""
    speed = float(np.linalg.norm(rate))
    axis = rate / speed if speed > 0.0 else rate
    half = speed * time / 2.0
    return np.concatenate((np.cos(half)[:, None], np.sin(half)[:, None] * axis), axis=1)


def _product(p: Floats, q: Floats) -> Floats:
    """Return the products of quaternions, shapes (..., 4)."""
    p, q = np.broadcast_arrays(p, q)
    w = p[..., :1] * q[..., :1] - np.sum(p[..., 1:] * q[..., 1:], axis=-1, keepdims=True)
    v = p[..., :1] * q[..., 1:] + q[..., :1] * p[..., 1:] + np.cross(p[..., 1:], q[..., 1:])
    return np.concatenate((w, v), axis=-1)


def _rotated(q: Floats, vector: Floats) -> Floats:
    """Return a vector of the body in the world."""
    inverse = q * np.array((1.0, -1.0, -1.0, -1.0))
    turned: Floats = _product(_product(q, np.concatenate((np.zeros(1), vector))), inverse)[1:]
    return turned
