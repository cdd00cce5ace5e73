"""MuJoCo as an engine: compile, compare, settle, then step in C and record by angle.

`mujoco.rollout` steps in C and returns the state after each step and the sensors of the state
before it; the engine puts both at the same instant. Forces and the locus come from MuJoCo's contact
sensors.

At a fine timestep hundreds of steps pass between two samples, and `mujoco.rollout` writes the state
and the sensors of each. For a slow motion MuJoCo therefore steps from reading to reading in C and
writes nothing, with its sensors off, which no step depends on: the same steps, fewer numbers.

A batch of releases of one model is stepped in one call. It gives bit for bit what its cases give
alone: the same model, each release at its own static penetration, each run in one piece from a cold
start. A batch holds every step in memory, so it is for short runs; a case that has not ended when
the batch has is run again alone.
"""

import time
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import mujoco
import numpy as np
from mujoco import rollout

from harness.engines import (
    Capabilities,
    Case,
    Chunk,
    Fixed,
    Floats,
    Integers,
    Outcome,
    PhysicsEngine,
    SamplingInterval,
    Schedule,
    Simulation,
    Stage,
    Trajectory,
    Value,
    record,
    settle,
    take_stage,
    trajectory_of,
)
from harness.engines.mujoco import settings as declared
from harness.engines.mujoco.world import MujocoWorld, alike
from harness.engines.stepping.physics_engine import MOST
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
"""Steps between two readings, where no angle moves, from which reading less often pays: a reading
costs what three steps do."""

_OFF = int(mujoco.mjtDisableBit.mjDSBL_SENSOR)


def spares(world: MujocoWorld, schedule: Schedule) -> bool:
    """Whether most steps of a run are to be taken without a reading.

    Not where forces change from step to step: MuJoCo takes those in its batched loop alone.
    """
    sampling = schedule.sampling
    still = world.forces(np.zeros(1)) is None
    fixed = sampling is not None and isinstance(schedule, Fixed)
    return still and fixed and sampling.steps(schedule.largest) >= WORTH_IT  # type: ignore[union-attr]


def take_sparsely(world: MujocoWorld, stage: Stage, sampling: SamplingInterval) -> Chunk | None:
    """Step through a stage from where the world is; return what was read, if anything."""
    model, data, option = world.model, world.data, world.model.opt
    seen = int(option.disableflags)
    state, spin = np.empty(mujoco.mj_stateSize(model, STATE)), np.empty(3)
    states: list[Floats] = []
    sensors: list[Floats] = []

    def read_and_step() -> tuple[list[float], list[float]]:
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
    places, spans = take_stage(stage, sampling, read_and_step, skip)
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


class MujocoEngine(PhysicsEngine[MujocoWorld]):
    """MuJoCo: soft contact by convex optimisation, generalised coordinates."""

    name = "mujoco"
    settings = declared.SETTINGS
    default_timestep = declared.DEFAULT_TIMESTEP
    matched_timestep = declared.MATCHED_TIMESTEP
    model_differences = declared.MODEL_DIFFERENCES
    solver_efforts = declared.SOLVER_EFFORTS
    variants = declared.VARIANTS
    capabilities = Capabilities(
        honours=frozenset(
            {
                "slip",
                "compliance",
                "drilling",
                "rolling_resistance",
                "damping",
                "tilt",
                "shake",
                "point_mass",
            }
        ),
        imposes={
            "compliance": "contact is soft: it yields by solref and solimp, and so does friction",
            "rebound": "a stiff contact gives a part of an impact back, as its damping leaves it",
            "shared cone": "drilling and rolling resistance share one cone with friction, and "
            "rolling resistance brings drilling of 1e-5 m",
            "several contacts": "near the flat state three points of the rim bear the load",
            "gyroscopic term": "Euler takes it explicitly, and a free spin gains energy",
        },
        least=dict.fromkeys(
            ("slip.mu", "drilling.length", "rolling_resistance.length"), declared.FAINTEST
        ),
    )
    # as shipped the cone is a pyramid, in which sliding and turning share even more
    imposed_by_default = frozenset({"arm of drilling", "arm of rolling resistance"})

    @property
    def version(self) -> str:
        """The version of MuJoCo."""
        return str(mujoco.mj_versionString())

    def resolve(self, case: Case) -> dict[str, Value]:
        """Return every setting in force for a case: an option, else what an effect asks for."""
        return declared.in_force(case, self.timestep(case))

    def open(self, case: Case) -> MujocoWorld:
        """Compile the scene of a case."""
        return MujocoWorld(case, self.resolve(case), self.timestep(case))

    def chunks(self, world: MujocoWorld, schedule: Schedule, size: int) -> Iterator[Chunk]:
        """Step by a schedule from where the world is, yielding after `size` steps or more."""
        state = np.empty(mujoco.mj_stateSize(world.model, STATE))
        mujoco.mj_getState(world.model, world.data, state, STATE)
        if spares(world, schedule) and schedule.sampling is not None:
            while (stage := _next(schedule, state)) is not None:
                world_chunk = take_sparsely(world, stage, schedule.sampling)
                if world_chunk is not None:
                    yield world_chunk
            return
        # the schedule is asked after a chunk was seen: what is seen may change what comes
        while (stage := _next(schedule, state)) is not None:
            befores, sensors, times = [], [], []
            count = 0
            while stage is not None:
                states, seen = _roll(world, stage, state)
                befores.append(states[:-1])
                sensors.append(seen)
                times.append(stage.times)
                count += len(stage.times)
                state = states[-1]
                stage = _next(schedule, state) if count < size else None
            yield chunk_of(world, _joined(times), _joined(befores), _joined(sensors))

    def bare_loop(self, world: MujocoWorld, steps: int) -> None:
        """Step so many times in C and do nothing else: no sensor, no reading, no record.

        Under forces that change, states are kept: MuJoCo takes those in its batched loop alone.
        """
        world.model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_SENSOR
        times = np.arange(steps) * np.float64(world.timestep)
        told = control(world, times)
        if set(told) == {"nstep"}:
            mujoco.mj_step(world.model, world.data, nstep=steps)
            return
        state = np.empty(mujoco.mj_stateSize(world.model, STATE))
        mujoco.mj_getState(world.model, world.data, state, STATE)
        rollout.rollout(world.model, world.data, state[None], **told)

    def recording_loop(self, world: MujocoWorld, steps: int) -> None:
        """Step so many times in C and keep each state and the sensors of its contact."""
        state = np.empty(mujoco.mj_stateSize(world.model, STATE))
        mujoco.mj_getState(world.model, world.data, state, STATE)
        schedule = Fixed(world.timestep, world.timestep * (steps - 1), MOST)
        while (stage := _next(schedule, state)) is not None:
            state = _roll(world, stage, state)[0][-1]

    def counted_step(self, world: MujocoWorld) -> int:
        """Step, and return the solver's iterations over all islands, of RK4 in its last stage."""
        world.step()
        data = world.data
        return int(data.solver_niter[: max(1, int(data.nisland))].sum())

    def export_settings(self, case: Case) -> str:
        """Return the settings of a case as MJCF."""
        return declared.as_mjcf(case, self.resolve(case), self.timestep(case))

    def simulate_many(self, cases: Sequence[Case]) -> list[Simulation]:
        """Run cases; those that differ in their release alone are stepped together, in C."""
        families: dict[Case, list[int]] = {}
        for place, case in enumerate(cases):
            families.setdefault(alike(case), []).append(place)
        done: dict[int, Simulation] = {}
        for places in families.values():
            done[places[0]] = self.simulate(cases[places[0]])
            done |= self._family(done[places[0]], {n: cases[n] for n in places[1:]})
        return [done[place] for place in range(len(cases))]

    def _family(self, first: Simulation, others: dict[int, Case]) -> dict[int, Simulation]:
        """Run cases that are alike to a finished one, by their places."""
        done: dict[int, Simulation] = {}
        steps = None if first.case.profile == "adaptive" else steps_for(first)
        left = list(others)
        while steps is not None and steps <= MOST_STEPS and left:
            for start in range(0, len(left), LARGEST):
                batch = left[start : start + LARGEST]
                cases = [others[place] for place in batch]
                runs = run_batch(self.open(first.case), first, cases, steps)
                done |= {n: run for n, run in zip(batch, runs, strict=True) if run is not None}
            left = [place for place in left if place not in done]
            steps *= 2
        return done | {place: self.simulate(others[place]) for place in left}


def _roll(world: MujocoWorld, stage: Stage, state: Floats) -> tuple[Floats, Floats]:
    """Step through a stage in C; return its states with the first, and the sensors before each."""
    steps = len(stage.times)
    states = np.empty((1, steps + 1, len(state)))
    states[0, 0] = state
    world.set_timestep(stage.timestep)
    _, sensors = rollout.rollout(
        world.model,
        world.data,
        state[None],
        **control(world, stage.times),
        initial_warmstart=world.data.qacc_warmstart.copy()[None],
        state=states[:, 1:],
    )
    return states[0], sensors[0]


def _joined(parts: list[Floats]) -> Floats:
    """Return arrays one after the other; a single one as it is."""
    return parts[0] if len(parts) == 1 else np.concatenate(parts)


def _next(schedule: Schedule, state: Floats) -> Stage | None:
    """Return the stage that a state calls for."""
    spin = np.empty(3)
    mujoco.mju_rotVecQuat(spin, state[11:14], state[4:8])
    return schedule.next(state[4:8].tolist(), spin.tolist())
