"""MuJoCo as an engine: compile, compare, settle, then step in C and record by angle.

`mujoco.rollout` steps in C and returns the state after each step and the sensors of the state
before it; both are put at the same instant here. Forces and the locus come from MuJoCo's contact
sensors.
"""

from collections.abc import Iterator, Sequence

import mujoco
import numpy as np
from mujoco import rollout

from harness.case import Case, Value
from harness.engines.base import Capabilities, Floats
from harness.engines.chunk import Chunk
from harness.engines.mujoco.batch import LARGEST, MOST_STEPS, run_batch, steps_for
from harness.engines.mujoco.chunks import STATE, chunk_of, control
from harness.engines.mujoco.gaps import EFFORTS, GAPS
from harness.engines.mujoco.settings import (
    DEFAULT_TIMESTEP,
    FAINTEST,
    MATCHED_TIMESTEP,
    SETTINGS,
    in_force,
)
from harness.engines.mujoco.sparing import glanced, spares
from harness.engines.mujoco.variants import VARIANTS, counted_step, paste
from harness.engines.mujoco.world import MujocoWorld, alike
from harness.engines.schedule import Fixed, Schedule, Stage
from harness.engines.stepping import MOST, PhysicsEngine
from harness.simulation import Simulation


class MujocoEngine(PhysicsEngine[MujocoWorld]):
    """MuJoCo: soft contact by convex optimisation, generalised coordinates."""

    name = "mujoco"
    settings = SETTINGS
    default_timestep = DEFAULT_TIMESTEP
    matched_timestep = MATCHED_TIMESTEP
    gaps = GAPS
    efforts = EFFORTS
    variants = VARIANTS
    paste = staticmethod(paste)
    counted_step = staticmethod(counted_step)
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
        least=dict.fromkeys(("slip.mu", "drilling.length", "rolling_resistance.length"), FAINTEST),
    )
    # as shipped the cone is a pyramid, in which sliding and turning share even more
    imposed_by_default = frozenset({"arm of drilling", "arm of rolling resistance"})

    @property
    def version(self) -> str:
        """The version of MuJoCo."""
        return str(mujoco.mj_versionString())

    def resolve(self, case: Case) -> dict[str, Value]:
        """Return every setting in force for a case: an option, else what an effect asks for."""
        return in_force(case, self.timestep(case))

    def open(self, case: Case) -> MujocoWorld:
        """Compile the scene of a case."""
        return MujocoWorld(case, self.resolve(case), self.timestep(case))

    def chunks(self, world: MujocoWorld, schedule: Schedule, size: int) -> Iterator[Chunk]:
        """Step by a schedule from where the world is, yielding after `size` steps or more."""
        state = np.empty(mujoco.mj_stateSize(world.model, STATE))
        mujoco.mj_getState(world.model, world.data, state, STATE)
        if spares(world, schedule) and schedule.looks is not None:
            while (stage := _next(schedule, state)) is not None:
                states, seen, places, spans = glanced(world, stage, schedule.looks)
                if len(places):
                    yield chunk_of(world, stage.times[places], states, seen, spans)
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

    def leanest(self, world: MujocoWorld, steps: int) -> None:
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

    def keeping(self, world: MujocoWorld, steps: int) -> None:
        """Step so many times in C and keep each state and the sensors of its contact."""
        state = np.empty(mujoco.mj_stateSize(world.model, STATE))
        mujoco.mj_getState(world.model, world.data, state, STATE)
        schedule = Fixed(world.timestep, world.timestep * (steps - 1), MOST)
        while (stage := _next(schedule, state)) is not None:
            state = _roll(world, stage, state)[0][-1]

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
