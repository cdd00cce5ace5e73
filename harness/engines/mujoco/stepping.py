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
from functools import partial
from typing import Any

import mujoco
import numpy as np
from mujoco import rollout

from harness.core.case import Case
from harness.core.simulation import Outcome, Simulation
from harness.core.trajectory import Integers, Trajectory
from harness.engines.base import Floats
from harness.engines.mujoco.world import MujocoWorld
from harness.engines.stepping.generic_stepping import take_stage
from harness.engines.stepping.recording import Chunk, Looks, record, trajectory_of
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
        motion = states[keep, 1:]
        motion[:, 10:] = to_world(motion[:, 3:7], motion[:, 10:])
        return trajectory_of(times[keep], motion, world.read_contact(sensors[keep]))

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


def take_sparsely(world: MujocoWorld, stage: Stage, looks: Looks) -> Chunk | None:
    """Step through a stage from where the world is; return what was looked at, if anything."""
    model, data, option = world.model, world.data, world.model.opt
    seen = int(option.disableflags)
    state, spin = np.empty(mujoco.mj_stateSize(model, STATE)), np.empty(3)
    states: list[Floats] = []
    sensors: list[Floats] = []

    def look() -> tuple[list[float], list[float]]:
        mujoco.mj_getState(model, data, state, STATE)
        option.disableflags = seen
        mujoco.mj_step(model, data)
        option.disableflags = seen | _OFF
        states.append(state.copy())
        sensors.append(data.sensordata.copy())
        mujoco.mju_rotVecQuat(spin, state[11:14], state[4:8])
        return state[[5, 6, 7, 4]].tolist(), spin.tolist()

    option.disableflags = seen | _OFF
    skip = partial(mujoco.mj_step, model, data)
    places, spans = take_stage(stage, looks, look, skip)
    option.disableflags = seen
    if not places:
        return None
    times = stage.times[places]
    return chunk_of(world, times, np.array(states), np.array(sensors), np.array(spans))


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
