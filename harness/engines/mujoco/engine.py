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
from typing import Any, TypeAlias

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
    LinearisedMotion,
    Outcome,
    PhysicsEngine,
    SamplingInterval,
    Schedule,
    Simulation,
    Stage,
    Value,
    record,
    settle,
    step_by_stages,
    take_stage,
)
from harness.engines.mujoco import DESCRIPTION
from harness.engines.mujoco import settings as declared
from harness.engines.mujoco.colliders import COLLIDERS, MESH_COLLIDERS
from harness.engines.mujoco.compiled_scene import alike, chunk_of
from harness.engines.mujoco.linearised import linearised
from harness.engines.mujoco.world import MujocoWorld
from models.rim import released

STATE = mujoco.mjtState.mjSTATE_FULLPHYSICS
"""Which state of MuJoCo: time, qpos and qvel, 14 numbers for a can."""


def control(world: MujocoWorld, times: Floats) -> dict[str, Any]:
    """Return the arguments of `mujoco.rollout` for the steps from these times (n,) on."""
    forces = world.forces(times)
    if forces is None:
        return {"nstep": len(times)}
    return {"control": forces[None], "control_spec": mujoco.mjtState.mjSTATE_XFRC_APPLIED}


def chunk_of_states(
    world: MujocoWorld,
    times: Floats,
    states: Floats,
    sensors: Floats,
    spans: Integers | None = None,
) -> Chunk:
    """Return the steps from states (n, 14) with the sensors of the same instants (n, 8).

    Where not every step was read, `spans` says for how many each stands.
    """
    count, sound = _sound(states), not _unstable(world.data)
    return chunk_of(world, times, states[:, 1:], sensors, count=count, sound=sound, spans=spans)


_BROKEN = (
    mujoco.mjtWarning.mjWARN_BADQPOS,
    mujoco.mjtWarning.mjWARN_BADQVEL,
    mujoco.mjtWarning.mjWARN_BADQACC,
)


def _unstable(data: mujoco.MjData) -> bool:
    """Whether MuJoCo itself has warned of numbers that are not finite, or huge."""
    return any(data.warning[kind].number for kind in _BROKEN)


def _sound(states: Floats) -> int:
    """Return how many states from the first on are valid: finite, at increasing times."""
    # without autoreset a number that breaks stays broken: the last state speaks for all before it;
    # time that has stopped starts again with the next stage, whose warnings MuJoCo has cleared
    if np.isfinite(states[-1]).all() and (states[1:, 0] > states[:-1, 0]).all():
        return len(states)
    good = np.isfinite(states).all(axis=1)
    good &= np.diff(states[:, 0], prepend=-np.inf) > 0.0
    return int(np.argmin(good))


WORTH_IT = 32
"""Steps between two readings, where no angle moves, from which reading less often pays: a reading
costs what three steps do."""

_SENSORS_OFF = int(mujoco.mjtDisableBit.mjDSBL_SENSOR)


def sparse_sampling(world: MujocoWorld, schedule: Schedule) -> SamplingInterval | None:
    """Return the sampling interval of a run of which few steps are read; None to read every step.

    Every step is read where forces change from step to step: MuJoCo takes those in its batched loop
    alone.
    """
    sampling = schedule.sampling
    if sampling is None or not isinstance(schedule, Fixed) or world.forces(np.zeros(1)) is not None:
        return None
    return sampling if sampling.steps(schedule.largest) >= WORTH_IT else None


def state_of(world: MujocoWorld) -> Floats:
    """Return the state of MuJoCo, shape (14,)."""
    state = np.empty(mujoco.mj_stateSize(world.model, STATE))
    mujoco.mj_getState(world.model, world.data, state, STATE)
    return state


Readings: TypeAlias = tuple[Floats, ...]
"""Times (n,) before steps, the states (n, 14) then, and the sensors (n, 8) of these states."""


_NOTHING, _ROOM = np.empty((1, 0, 0)), 16384  # steps


class MujocoSteps:
    """Steps a world in C; holds the states before the steps that it reads, with their sensors.

    Parameters
    ----------
    world : MujocoWorld
    sampling : SamplingInterval or None
        Of a run of which most steps are not read; None reads every step.
    """

    def __init__(self, world: MujocoWorld, sampling: SamplingInterval | None) -> None:
        self._world, self._sampling = world, sampling
        self._state = state_of(world)
        self._times: list[Floats] = []
        self._states = self._sensors = _NOTHING
        self._parts: list[Readings] = []
        self._spans: list[int] = []

    def state(self) -> tuple[list[float], list[float]]:
        """Return quaternion (scalar first) and angular velocity; fixed steps do not ask for it."""
        spin = np.empty(3)
        mujoco.mju_rotVecQuat(spin, self._state[11:14], self._state[4:8])
        return self._state[4:8].tolist(), spin.tolist()

    def take(self, stage: Stage) -> bool:
        """Take the steps of a stage."""
        if self._sampling is not None:
            self._parts += self._take_sparsely(stage, self._sampling)
        else:
            self._roll(stage)
        return True

    def _roll(self, stage: Stage) -> None:
        """Step through a stage in one call of MuJoCo, which writes a reading of every step."""
        world, count = self._world, len(stage.times)
        states, sensors = self._room(count)
        world.set_timestep(stage.timestep)
        rollout.rollout(
            [world.model],
            [world.data],
            self._state[None],
            **{"nstep": count} | control(world, stage.times),
            initial_warmstart=world.data.qacc_warmstart.copy()[None],
            state=states[:, 1:],
            sensordata=sensors,
            skip_checks=True,  # they and their copies cost what twenty steps do
        )
        self._state = states[0, -1]
        self._times.append(stage.times)

    def _room(self, count: int) -> tuple[Floats, Floats]:
        """Return where to write states, after the one from which they go on, and sensors."""
        held = sum(map(len, self._times))
        if held + count >= self._states.shape[1]:
            states = np.empty((1, max(held + count, _ROOM) + 1, len(self._state)))
            sensors = np.empty((1, states.shape[1], self._world.model.nsensordata))
            if held:
                states[:, :held] = self._states[:, :held]
                sensors[:, :held] = self._sensors[:, :held]
            self._states, self._sensors = states, sensors
        self._states[0, held] = self._state
        return self._states[:, held : held + count + 1], self._sensors[:, held : held + count]

    def _take_sparsely(self, stage: Stage, sampling: SamplingInterval) -> list[Readings]:
        """Step through a stage with sensors in the steps that are read; return these, if any."""
        model, data, option = self._world.model, self._world.data, self._world.model.opt
        seen, spin = int(option.disableflags), np.empty(3)
        states: list[Floats] = []
        sensors: list[Floats] = []

        def read_and_step() -> tuple[list[float], list[float]]:
            state = state_of(self._world)
            option.disableflags = seen
            mujoco.mj_step(model, data)
            option.disableflags = seen | _SENSORS_OFF
            states.append(state)
            sensors.append(data.sensordata.copy())
            mujoco.mju_rotVecQuat(spin, state[11:14], state[4:8])
            return state[[5, 6, 7, 4]].tolist(), spin.tolist()

        option.disableflags = seen | _SENSORS_OFF
        skip = partial(mujoco.mj_step, model, data)
        places, spans = take_stage(stage, sampling, read_and_step, skip)
        option.disableflags = seen
        self._spans += spans
        return [(stage.times[places], np.array(states), np.array(sensors))] if places else []

    def chunk(self) -> Chunk | None:
        """Return the readings since the last chunk; None without any."""
        spans = None
        if self._sampling is None and self._times:
            times, held = np.concatenate(self._times), sum(map(len, self._times))
            states, sensors = self._states[0, :held], self._sensors[0, :held]
            # they belong to the chunk now
            self._times, self._states, self._sensors = [], _NOTHING, _NOTHING
        elif self._parts:
            times, states, sensors = map(np.concatenate, zip(*self._parts, strict=True))
            spans = np.array(self._spans)
            self._parts, self._spans = [], []
        else:
            return None
        return chunk_of_states(self._world, times, states, sensors, spans)


MOST_STEPS = 4096
"""Steps of a run, 180 bytes each, up to which it is batched."""

LARGEST = 256
"""Cases in a batch: two hundred megabytes at the most steps."""
_MARGIN = 1.25  # share of the first run's steps that the others get


def run_batch(
    world: MujocoWorld, first: Simulation, cases: Sequence[Case], steps: int
) -> list[Simulation | None]:
    """Run cases of one model; None for a case that has to be run alone.

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
    states, depths = [], []
    for case in cases:
        pose, twist = released(case.scene)
        depth, pose = settle(world, case.scene, pose, twist)
        world.place(pose, twist)
        states.append(state_of(world))
        depths.append(depth)
    mujoco.mj_resetData(world.model, world.data)
    times = np.arange(steps) * np.float64(world.timestep)
    driven = control(world, times)
    after, sensors = rollout.rollout(world.model, world.data, np.array(states), **driven)
    runs = []
    for row, case in enumerate(cases):
        before = np.vstack((states[row], after[row, :-1]))
        prepared = replace(first, case=case, static_penetration=depths[row])
        runs.append(record(prepared, [chunk_of_states(world, times, before, sensors[row])]))
    wall = (time.perf_counter() - wall) / len(cases)
    cpu = (time.process_time() - cpu) / len(cases)
    return [
        None
        if run.outcome in {Outcome.TIMED_OUT, Outcome.DIVERGED}
        else replace(run, wall_s=wall, cpu_s=cpu, setup_s=0.0)
        for run in runs
    ]


class MujocoEngine(PhysicsEngine[MujocoWorld]):
    """MuJoCo: soft contact by convex optimisation, generalised coordinates."""

    name = "mujoco"
    fewest_steps = 128
    description = DESCRIPTION
    settings = declared.SETTINGS
    default_timestep = declared.DEFAULT_TIMESTEP
    matched_timestep = declared.MATCHED_TIMESTEP
    model_differences = declared.MODEL_DIFFERENCES
    solver_efforts = declared.SOLVER_EFFORTS
    variants = declared.VARIANTS
    colliders = COLLIDERS
    mesh_colliders = MESH_COLLIDERS
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

    @property
    def version(self) -> str:
        """The version of MuJoCo."""
        return str(mujoco.mj_versionString())

    def imposed_in(self, case: Case) -> dict[str, float]:
        """Return the rows of parity in which MuJoCo goes its own way in a case."""
        return declared.imposed_in(case, self.resolve(case))

    def for_effects(self, case: Case, timestep: float) -> dict[str, Value]:
        """Return the settings that the effects of a scene decide."""
        return declared.for_effects(case, timestep)

    def open(self, case: Case) -> MujocoWorld:
        """Compile the scene of a case."""
        return MujocoWorld(case, self.resolve(case), self.timestep(case))

    def chunks(self, world: MujocoWorld, schedule: Schedule, size: int) -> Iterator[Chunk]:
        """Step by a schedule from where the world is, yielding after `size` steps or more."""
        steps = MujocoSteps(world, sparse_sampling(world, schedule))
        return step_by_stages(steps, schedule, size)

    def bare_loop(self, world: MujocoWorld, steps: int) -> None:
        """Step so many times in C and do nothing else: no sensor, no reading, no record.

        Under forces that change, states are written: MuJoCo takes forces in its batched loop alone.
        """
        world.model.opt.disableflags |= _SENSORS_OFF
        driven = control(world, np.arange(steps) * np.float64(world.timestep))
        if set(driven) == {"nstep"}:
            mujoco.mj_step(world.model, world.data, nstep=steps)
        else:
            rollout.rollout(world.model, world.data, state_of(world)[None], **driven)

    def counted_step(self, world: MujocoWorld) -> int:
        """Step, and return the solver's iterations over all islands, of RK4 in its last stage."""
        world.step()
        data = world.data
        return int(data.solver_niter[: max(1, int(data.nisland))].sum())

    def linearise(
        self, case: Case, changes: Floats, *, seconds: float, step: float
    ) -> LinearisedMotion:
        """Return a run and its derivatives by changes of the release, by `mjd_transitionFD`."""
        pose, twist = released(case.scene)
        _, pose = settle(self.open(case), case.scene, pose, twist)
        return linearised(self.open(case), pose, twist, changes, seconds=seconds, step=step)

    def export_settings(self, case: Case) -> str:
        """Return the settings of a case as MJCF."""
        return declared.as_mjcf(case, self.resolve(case), self.timestep(case))

    def simulate_many(self, cases: Sequence[Case]) -> list[Simulation]:
        """Run cases; those that differ in their release alone are stepped together, in C."""
        families: dict[Case, list[int]] = {}
        for place, case in enumerate(cases):
            families.setdefault(alike(case), []).append(place)
        done: dict[int, Simulation] = {}
        for family, (place, *left) in families.items():
            done[place] = self.simulate(cases[place])
            timed = family.profile == "adaptive" or family.scene.horizon.seconds is not None
            if left and not timed and done[place].outcome is Outcome.FINISHED:
                done |= self._batched(done[place], {n: cases[n] for n in left})
        return [done.get(n) or self.simulate(case) for n, case in enumerate(cases)]

    def _batched(self, first: Simulation, others: dict[int, Case]) -> dict[int, Simulation]:
        """Return simulations of cases of the model of a finished one, by place, if batches end."""
        done: dict[int, Simulation] = {}
        steps, left = int(first.steps * _MARGIN) + 16, list(others)
        while steps <= MOST_STEPS and left:
            for start in range(0, len(left), LARGEST):
                batch = left[start : start + LARGEST]
                cases = [others[place] for place in batch]
                runs = run_batch(self.open(first.case), first, cases, steps)
                done |= {n: run for n, run in zip(batch, runs, strict=True) if run is not None}
            left = [place for place in left if place not in done]
            steps *= 2
        return done
