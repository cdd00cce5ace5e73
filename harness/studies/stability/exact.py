"""What a run is held against: the exact motion of its scene, where there is one.

Beside the rolling can of the runner there are three more exact motions. A scene with enough
friction to roll has the motion of its ideal twin, one without any friction that of the frictionless
equations. A can without gravity turns as a free symmetric top: with the angular momentum L, which
stays, and the axial rate w, which stays as well, its angular velocity is

    Omega = L/A + (1 - C/A) w e,    so that    R(t) = exp(L t/A) R(0) exp((1 - C/A) w t e_3).
"""

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from harness.bounce import Bounce
from harness.case import Case
from harness.engines.reference import Truth, refusal, solved
from harness.runner import Evaluation
from harness.trajectory import Floats, Trajectory
from models.effects import IDEAL
from models.kinematics import half_angles, to_body
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
    if e.motion is None or e.truth_pulls:
        return None
    if e.truth is not None:
        return Exact(time=e.truth.time, phi=e.truth.angles.phi, bounces=e.true_bounces)
    other = twin(e.simulation.case.scene)
    if other is None:
        return None
    time = e.motion.time[e.motion.time <= other.ends]
    phi, _, _ = half_angles(other.at(time).quaternion)
    return Exact(time=time, phi=phi, bounces=other.bounces)


@lru_cache(maxsize=16)
def twin(scene: Scene) -> Truth | None:
    """Return the exact motion of a scene whose only effect is slip, if it has one."""
    slip = scene.effects.slip
    if refusal(scene) or slip is None:
        return None
    model = "frictionless" if slip.mu == 0.0 else "rolling"
    ideal = replace(scene, effects=IDEAL)
    found = solved(Case(scene=ideal, engine="reference", options=(("model", model),)))
    needed = max((bounce.peak_friction_ratio for bounce in found.bounces), default=0.0)
    return found if slip.mu == 0.0 or slip.mu > needed else None


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
