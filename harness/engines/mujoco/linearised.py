"""Derivatives of a run by its release: `mjd_transitionFD` chained over the steps.

MuJoCo differentiates one step by differences of its own; the product of the steps' matrices is the
derivative of the run. The depth at which a soft contact rests is that of the release itself.
"""

import mujoco
import numpy as np

from harness.engines import Floats, LinearisedMotion, Trajectory
from harness.engines.mujoco.world import MujocoWorld
from models.kinematics import to_body, to_world
from models.state import Pose, Twist

_NUMBERS = 12
"""Of a change of the state of one free body: place, orientation and their velocities."""


def linearised(
    world: MujocoWorld, pose: Pose, twist: Twist, changes: Floats, *, seconds: float, step: float
) -> LinearisedMotion:
    """Return a run from a release, and its derivative by changes of the release.

    Parameters
    ----------
    world : MujocoWorld
    pose, twist : Pose, Twist
        At the release, resting on its contact.
    changes : ndarray, shape (12, k)
        Of the release, as `LinearisedMotion` has them.
    seconds : float
        Of the run.
    step : float
        Of the differences by which MuJoCo differentiates a step, in its own units.
    """
    count = round(seconds / world.timestep)
    states, found = np.empty((count, 13)), np.empty((count, _NUMBERS, changes.shape[1]))
    matrix = np.empty((_NUMBERS, _NUMBERS))
    world.place(pose, twist)
    own = changes_to_mujoco(pose.quaternion, world.data.qvel[3:], changes)
    for number in range(count):
        data = world.data
        states[number, :7], states[number, 7:] = data.qpos, data.qvel
        found[number] = own
        mujoco.mjd_transitionFD(world.model, data, step, True, matrix, None, None, None)  # noqa: FBT003 - MuJoCo's own argument: centred
        own = matrix @ own
        world.step()
    times = np.arange(count) * np.float64(world.timestep)
    return LinearisedMotion(
        trajectory=free_motion(times, states), changes=changes_to_world(states, found)
    )


def changes_to_mujoco(quaternion: Floats, spin: Floats, changes: Floats) -> Floats:
    """Return changes in MuJoCo's coordinates: rotation and angular velocity in the body's frame.

    Parameters
    ----------
    quaternion : ndarray, shape (4,)
    spin : ndarray, shape (3,)
        Angular velocity in the body's frame, rad/s.
    changes : ndarray, shape (12, k)
    """
    place, turn, speed, rate = np.split(changes.T, 4, axis=1)
    inside = to_body(quaternion, turn)
    # the frame turns too: what stays the same in the world changes in the body by -turn x spin
    turned_rate = to_body(quaternion, rate) - np.cross(inside, spin)
    return np.hstack((place, inside, speed, turned_rate)).T


def changes_to_world(states: Floats, changes: Floats) -> Floats:
    """Return changes (n, 12, k) in world coordinates, the inverse of `changes_to_mujoco`."""
    place, turn, speed, rate = np.split(np.swapaxes(changes, 1, 2), 4, axis=2)
    quaternion, spin = states[:, None, 3:7], states[:, None, 10:13]
    quaternion = np.broadcast_to(quaternion, (*turn.shape[:2], 4))
    outside = to_world(quaternion, rate + np.cross(turn, spin))
    common = np.concatenate((place, to_world(quaternion, turn), speed, outside), axis=2)
    return np.swapaxes(common, 1, 2)


def free_motion(times: Floats, states: Floats) -> Trajectory:
    """Return the motion of states (n, 13), of which no contact is read."""
    nothing = np.full((len(times), 3), np.nan)
    return Trajectory(
        time=times,
        position=states[:, :3],
        quaternion=states[:, 3:7],
        velocity=states[:, 7:10],
        angular_velocity=to_world(states[:, 3:7], states[:, 10:13]),
        contact_point=nothing,
        contact_force=nothing,
        penetration=np.full(len(times), np.nan),
        contact_count=np.ones(len(times), dtype=np.int64),
    )
