"""MuJoCo as an engine: compile, compare, settle, then step in C and record by angle.

A batch of releases of one model is stepped in one call. It gives bit for bit what its cases give
alone: the same model, each release at its own static penetration, each run in one piece from a cold
start. A batch holds every step in memory, so it is for short runs; a case that has not ended when
the batch has is run again alone.
"""

import time
from collections.abc import Iterator, Sequence
from dataclasses import replace

import mujoco
import numpy as np
from mujoco import rollout

from harness.engines import (
    Capabilities,
    Case,
    Chunk,
    Floats,
    LinearisedMotion,
    Outcome,
    PhysicsEngine,
    Schedule,
    Simulation,
    Value,
    record,
    settle,
    step_by_stages,
)
from harness.engines.mujoco import DESCRIPTION
from harness.engines.mujoco import settings as declared
from harness.engines.mujoco.colliders import COLLIDERS, MESH_COLLIDERS
from harness.engines.mujoco.compiled_scene import alike
from harness.engines.mujoco.linearised import linearised
from harness.engines.mujoco.steps import (
    SENSORS_OFF,
    MujocoSteps,
    chunk_of_states,
    control,
    sparse_sampling,
    state_of,
)
from harness.engines.mujoco.world import MujocoWorld
from models.rim import released

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
    fewest_steps = 256
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
                "restitution",
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
            "sliding impact": "a rim that slips through an impact to a slip of w is thrown off by "
            "about mu w more than restitution gives back",
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
        world.model.opt.disableflags |= SENSORS_OFF
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
