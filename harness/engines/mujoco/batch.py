"""Many releases of one model at once: MuJoCo steps them in C, in one call.

A batch gives bit for bit what its cases give one by one: the same model, each release at its own
static penetration, each run in one piece from a cold start. It holds every step in memory, so it is
for short runs; a case that has not ended when the batch has is run again by itself.
"""

import time
from collections.abc import Sequence
from dataclasses import replace

import mujoco
import numpy as np
from mujoco import rollout

from harness.case import Case
from harness.engines.mujoco.chunks import STATE, chunk_of, control
from harness.engines.mujoco.world import MujocoWorld
from harness.engines.recording import record
from harness.engines.settling import settle
from harness.simulation import Outcome, Simulation
from models.rim import released

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
