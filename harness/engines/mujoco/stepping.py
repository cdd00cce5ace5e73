"""Steps of MuJoCo as chunks: each step read, steps between looks unread, or many releases at once.

`mujoco.rollout` gives the state after each step and the sensors of the state before it; the caller
has put both at the same instant.

At a fine timestep hundreds of steps pass between two samples, and `mujoco.rollout` writes the state
and the sensors of each. For a slow motion MuJoCo therefore steps from look to look in C and writes
nothing, with its sensors off, which no step depends on: the same steps, fewer numbers.

A batch of releases of one model is stepped in one call. It gives bit for bit what its cases give
alone: the same model, each release at its own static penetration, each run in one piece from a cold
start. A batch holds every step in memory, so it is for short runs; a case that has not ended when
the batch has is run again alone.
"""

import time
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import mujoco
import numpy as np
from mujoco import rollout

from harness.core.case import Case
from harness.core.simulation import Outcome, Simulation
from harness.core.trajectory import Integers, Trajectory
from harness.engines.base import Floats
from harness.engines.mujoco.world import MujocoWorld
from harness.engines.stepping.recording import Chunk, Looks, record
from harness.engines.stepping.schedule import Fixed, Schedule, Stage
from harness.engines.stepping.settling import settle
from models.kinematics import to_world
from models.rim import released

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
        angular_velocity=to_world(quaternion, states[:, 11:14]),
        contact_point=point,
        contact_force=force,
        penetration=penetration,
        contact_count=count.astype(np.int64),
    )


WORTH_IT = 32
"""Steps between two looks, where no angle moves, from which looking less often pays: a look costs
what three steps do."""

_OFF = int(mujoco.mjtDisableBit.mjDSBL_SENSOR)


def spares(world: MujocoWorld, schedule: Schedule) -> bool:
    """Whether most steps of a run are to be taken without a look.

    Not where forces change from step to step: MuJoCo takes those in its batched loop alone.
    """
    looks = schedule.looks
    still = world.forces(np.zeros(1)) is None
    fixed = looks is not None and isinstance(schedule, Fixed)
    return still and fixed and looks.steps(schedule.largest) >= WORTH_IT  # type: ignore[union-attr]


def glanced(
    world: MujocoWorld, stage: Stage, looks: Looks
) -> tuple[Floats, Floats, Integers, Integers]:
    """Step through a stage from where the world is.

    Returns
    -------
    states, sensors : ndarray, shape (n, 14) and (n, 8)
        Before each of the steps that were looked at.
    places, spans : ndarray of int, shape (n,)
        Which steps these are, and for how many each stands.
    """
    model, data, option = world.model, world.data, world.model.opt
    seen = int(option.disableflags)
    state, spin = np.empty(mujoco.mj_stateSize(model, STATE)), np.empty(3)
    states, sensors, places, spans = [], [], [], []
    count, last = len(stage.times), stage.ahead - 1
    place, left = min(looks.left, count), max(looks.left - count, 0)
    option.disableflags = seen | _OFF
    if place > 0:
        mujoco.mj_step(model, data, nstep=place)
    while place < count:
        mujoco.mj_getState(model, data, state, STATE)
        option.disableflags = seen
        mujoco.mj_step(model, data)
        option.disableflags = seen | _OFF
        states.append(state.copy())
        sensors.append(data.sensordata.copy())
        places.append(place)
        after = place + 1
        if place < last:
            # the last step of all is looked at, whatever the motion
            w, x, y, z = state[4:8].tolist()
            mujoco.mju_rotVecQuat(spin, state[11:14], state[4:8])
            after = min(place + looks.pause((x, y, z, w), spin.tolist(), stage.timestep), last)
        spans.append(after - place)
        if after > count:
            left = after - count
        unseen = min(after, count) - place - 1
        if unseen > 0:
            mujoco.mj_step(model, data, nstep=unseen)
        place = after
    option.disableflags = seen
    looks.left = left
    rows = np.array(states).reshape(len(states), len(state))
    read = np.array(sensors).reshape(len(states), len(data.sensordata))
    return rows, read, np.array(places, dtype=np.int64), np.array(spans, dtype=np.int64)


MOST_STEPS = 4096
"""Steps of a run, 180 bytes each, up to which it is batched."""

LARGEST = 256
"""Cases in a batch: two hundred megabytes at the most steps."""

_MARGIN = 1.25  # share of the first run's steps that the others get


def run_batch(
    world: MujocoWorld, first: Simulation, cases: Sequence[Case], steps: int
) -> list[Simulation | None]:
    """Run cases that are alike; None for a case that has to be run by itself.

    Parameters
    ----------
    world : MujocoWorld
        With the model of the cases; is placed and stepped.
    first : Simulation
        A finished one of a case alike: version, settings and parity are the same for all.
    cases : sequence of Case
    steps : int
        That each is given.
    """
    wall, cpu = time.perf_counter(), time.process_time()
    model, data = world.model, world.data
    states = np.empty((len(cases), mujoco.mj_stateSize(model, STATE)))
    depths = []
    for row, case in enumerate(cases):
        pose, twist = released(case.scene)
        depth, pose = settle(world, case.scene, pose, twist)
        world.place(pose, twist)
        mujoco.mj_getState(model, data, states[row], STATE)
        depths.append(depth)
    mujoco.mj_resetData(model, data)
    times = np.arange(steps) * np.float64(world.timestep)
    after, sensors = rollout.rollout(model, data, states, **control(world, times))
    done: list[Simulation | None] = []
    for row, case in enumerate(cases):
        before = np.vstack((states[row], after[row, :-1]))
        prepared = replace(first, case=case, static_penetration=depths[row])
        run = record(prepared, [chunk_of(world, times, before, sensors[row])])
        ended = run.outcome not in {Outcome.TIMED_OUT, Outcome.DIVERGED}
        done.append(run if ended and case.scene.horizon.seconds is None else None)
    share_wall = (time.perf_counter() - wall) / len(cases)
    share_cpu = (time.process_time() - cpu) / len(cases)
    return [
        None if run is None else replace(run, wall_s=share_wall, cpu_s=share_cpu, setup_s=0.0)
        for run in done
    ]


def steps_for(first: Simulation) -> int | None:
    """Return the steps that cases like a finished one get in a batch; None if too many."""
    if first.outcome is not Outcome.FINISHED or first.case.scene.horizon.seconds is not None:
        return None
    steps = int(first.steps * _MARGIN) + 16
    return steps if steps <= MOST_STEPS else None
