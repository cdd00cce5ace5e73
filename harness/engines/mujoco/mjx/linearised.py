"""Derivatives of a run by its release: the compiled loop of steps differentiated forward by JAX.

What is differentiated is the program that runs, with the iterations of its solver and their warm
start; of differences nothing is left.
"""

import numpy as np

from harness.engines import Floats, LinearisedMotion
from harness.engines.mujoco.linearised import changes_to_mujoco, changes_to_world, free_motion
from harness.engines.mujoco.mjx.world import MjxWorld

_ELLIPTIC = (
    "its line search for an elliptic cone takes the square root of the tangential force of every "
    "contact, and where a contact does not touch, that force is 0 and the root has no derivative"
)


def linearised(world: MjxWorld, changes: Floats, *, seconds: float, cone: str) -> LinearisedMotion:
    """Return a run from where a can was placed, and its derivative by changes of the release.

    Parameters
    ----------
    world : MjxWorld
        With the can resting on its contact.
    changes : ndarray, shape (12, k)
        Of the release, as `LinearisedMotion` has them.
    seconds : float
        Of the run.
    cone : str
        MJX's setting, which says why there may be no derivative.
    """
    count = round(seconds / world.timestep)
    times = np.arange(count) * np.float64(world.timestep)
    quaternion, spin = world.pose().quaternion, world.spin
    place, turn, speed, rate = np.split(changes_to_mujoco(quaternion, spin, changes), 4)
    whole = np.vstack((place, _quaternion_change(quaternion, turn), speed, rate))
    states, found = world.differentiate(whole.T, world.pushes(times), count)
    place, own, speed, rate = np.split(found, (3, 7, 10), axis=1)
    inside = np.concatenate((place, _rotation(states[:, 3:7], own), speed, rate), axis=1)
    broken = ~np.isfinite(inside).all(axis=(1, 2))
    why = ""
    if broken.any():
        step = int(np.argmax(broken))
        why = f"the derivative of the program is not a number from step {step} on"
        why += f": {_ELLIPTIC}" if cone == "elliptic" else ""
    return LinearisedMotion(
        trajectory=free_motion(times, states),
        changes=changes_to_world(states, inside),
        by_differences=False,
        why=why,
    )


def _quaternion_change(quaternion: Floats, rotation: Floats) -> Floats:
    """Return changes of a quaternion (4, k) by rotations in the body's frame (3, k)."""
    w, v = quaternion[0], quaternion[1:]
    scalar = -v @ rotation
    vector = w * rotation + np.cross(v, rotation, axisb=0, axisc=0)
    return np.vstack((scalar, vector)) / 2.0


def _rotation(quaternion: Floats, change: Floats) -> Floats:
    """Return rotations in the body's frame (n, 3, k) of changes (n, 4, k) of quaternions (n, 4)."""
    w, v = quaternion[:, :1, None], quaternion[:, 1:, None]
    scalar, vector = change[:, :1], change[:, 1:]
    return np.asarray(2.0 * (w * vector - scalar * v - np.cross(v, vector, axis=1)))
