"""MuJoCo as an engine: compile, compare, settle, then step in C and record by angle.

`mujoco.rollout` steps in C and returns the state after each step and the sensors of the state
before it; the engine puts both at the same instant. Forces and the locus come from MuJoCo's contact
sensors.
"""

from collections.abc import Iterator, Sequence

import mujoco
import numpy as np
from mujoco import rollout

from harness.engines import (
    Capabilities,
    Case,
    Chunk,
    Fixed,
    PhysicsEngine,
    Schedule,
    Simulation,
    Stage,
    Value,
)
from harness.engines.base import Floats
from harness.engines.mujoco import settings as declared
from harness.engines.mujoco.stepping import (
    LARGEST,
    MOST_STEPS,
    STATE,
    chunk_of,
    control,
    run_batch,
    spares,
    steps_for,
    take_sparsely,
)
from harness.engines.mujoco.world import MujocoWorld, alike
from harness.engines.stepping.physics_engine import MOST
from models.mjcf_contact import pair, surface

_ADAPTIVE = """\
<!-- The timestep follows the motion. Before each mj_step of a can with these measures:
from harness.engines import Adaptive           # schedule = Adaptive(can, largest={largest!r}, ...)
model.opt.timestep = step                      # of schedule.next(quaternion, angular velocity)
model.geom_solref[:] = (2 * step, 1)           # the contact is tied to it
-->
"""


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
        if spares(world, schedule) and schedule.looks is not None:
            while (stage := _next(schedule, state)) is not None:
                world_chunk = take_sparsely(world, stage, schedule.looks)
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
        """Step, and return the iterations of the solver, of the last stage of RK4, over all islands."""
        world.step()
        data = world.data
        return int(data.solver_niter[: max(1, int(data.nisland))].sum())

    def export_settings(self, case: Case) -> str:
        """Return the settings of a case as MJCF: `option`, and `default` for the geoms.

        Both belong right under `mujoco`, and so does the `contact` of a scene whose contact is a
        spring, for geoms named as in the model files.
        """
        timestep = self.timestep(case)
        # not the stages that are left out: a model of one's own may need them, and no number does
        option, geom, flag = declared.attributes(case, self.resolve(case))
        option = {"timestep": repr(timestep)} | option
        lines = [f"<option {_spelled(option)}/>"]
        if flag:
            lines = [f"<option {_spelled(option)}>", f"  <flag {_spelled(flag)}/>", "</option>"]
        if geom:
            lines += ["<default>", f"  <geom {_spelled(geom)}/>", "</default>"]
        if declared.soft_solref(case, timestep) is not None:
            springy = pair(surface(case.scene) | geom, timestep)
            lines += ["<contact>", f"  <pair {_spelled(springy)}/>", "</contact>"]
        head = _ADAPTIVE.format(largest=timestep) if case.profile == "adaptive" else ""
        return head + "\n".join(lines) + "\n"

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


def _spelled(attributes: dict[str, str]) -> str:
    return " ".join(f'{name}="{value}"' for name, value in attributes.items())


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
