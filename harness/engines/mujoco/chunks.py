"""What MuJoCo returns of consecutive steps, as a chunk.

`mujoco.rollout` gives the state after each step and the sensors of the state before it; whoever
calls has put both at the same instant.
"""

from typing import Any

import mujoco
import numpy as np

from harness.engines.base import Floats
from harness.engines.chunk import Chunk
from harness.engines.mujoco.world import MujocoWorld, from_body
from harness.trajectory import Integers, Trajectory

STATE = mujoco.mjtState.mjSTATE_FULLPHYSICS
"""Which state of MuJoCo: time, qpos and qvel, 14 numbers for a can."""


def control(world: MujocoWorld, times: Floats) -> dict[str, Any]:
    """Return what `mujoco.rollout` is told of the steps from these times (n,) on."""
    forces = world.forces(times)
    if forces is None:
        return {"nstep": len(times)}
    return {"control": forces[None], "control_spec": mujoco.mjtState.mjSTATE_XFRC_APPLIED}


def chunk_of(
    world: MujocoWorld,
    times: Floats,
    states: Floats,
    sensors: Floats,
    spans: Integers | None = None,
) -> Chunk:
    """Return the steps from states (n, 14) with the sensors of the same instants (n, 8).

    Where not every step was read, `spans` says for how many each stands.
    """
    count = _sound(states)
    contacts = sensors[:, 0].copy()
    contacts[count:] = 0.0

    def read(keep: Integers) -> Trajectory:
        return _read(world, times[keep], states[keep], sensors[keep])

    return Chunk(
        times=times,
        quaternions=states[:count, 4:8],
        constraint_rows=contacts.astype(np.int64) * world.rows_per_contact,
        sound=count == len(states) and not _unstable(world.data),
        read=read,
        spans=spans,
    )


_BROKEN = (
    mujoco.mjtWarning.mjWARN_BADQPOS,
    mujoco.mjtWarning.mjWARN_BADQVEL,
    mujoco.mjtWarning.mjWARN_BADQACC,
)


def _unstable(data: mujoco.MjData) -> bool:
    """Whether MuJoCo itself has found its numbers to be none, or huge."""
    return any(data.warning[kind].number for kind in _BROKEN)


def _sound(states: Floats) -> int:
    """Return how many of the states, from the first on, are states: finite, and time goes on."""
    # without autoreset a number that breaks stays broken, and time that has stopped stays: the last
    # two states speak for all before them
    if np.isfinite(states[-1]).all() and (len(states) == 1 or states[-1, 0] > states[-2, 0]):
        return len(states)
    good = np.isfinite(states).all(axis=1)
    good &= np.diff(states[:, 0], prepend=-np.inf) > 0.0
    return int(np.argmin(good))


def _read(world: MujocoWorld, times: Floats, states: Floats, sensors: Floats) -> Trajectory:
    """Return states and the sensors of the same instants as a trajectory."""
    point, force, penetration, count = world.read_contact(sensors)
    quaternion = states[:, 4:8]
    return Trajectory(
        time=times,
        position=states[:, 1:4],
        quaternion=quaternion,
        velocity=states[:, 8:11],
        angular_velocity=from_body(quaternion, states[:, 11:14]),
        contact_point=point,
        contact_force=force,
        penetration=penetration,
        contact_count=count.astype(np.int64),
    )
