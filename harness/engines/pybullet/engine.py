"""PyBullet as an engine: open a world of its own, compare, settle, then step and read.

There is no batched stepping: each step is a call, and so is each of the three readings, so that
states are read no oftener than the recorder needs them.
"""

from collections.abc import Iterator
from importlib.metadata import version

import numpy as np
import pybullet

from harness.case import Case, Value
from harness.engines.base import Capabilities
from harness.engines.chunk import Chunk
from harness.engines.pybullet.gaps import EFFORTS, GAPS
from harness.engines.pybullet.settings import (
    DEFAULT_TIMESTEP,
    IMPOSED_BY_DEFAULT,
    MATCHED_TIMESTEP,
    SETTINGS,
    in_force,
)
from harness.engines.pybullet.steps import Steps
from harness.engines.pybullet.variants import VARIANTS, counted_step, paste
from harness.engines.pybullet.world import PybulletWorld
from harness.engines.schedule import Schedule, Stage
from harness.engines.stepping import PhysicsEngine


class PybulletEngine(PhysicsEngine[PybulletWorld]):
    """PyBullet: sequential impulses on contacts that are kept from step to step."""

    name = "pybullet"
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
                "restitution",
                "drilling",
                "rolling_resistance",
                "damping",
                "rim",
                "tilt",
                "shake",
                "point_mass",
            }
        ),
        imposes={
            "stabilisation": "penetration is taken away by ERP, which adds energy",
            "gyroscopic term": "taken explicitly, and a free spin gains energy",
            "turn in a step": "past pi/4 the body turns by less than its spin asks for",
            "friction direction": "sliding friction, and so rolling resistance, points a few "
            "hundredths of a radian astray, whatever the timestep",
            "cached contacts": "old points of the rim stay in the solver until they drift away",
        },
    )
    imposed_by_default = IMPOSED_BY_DEFAULT

    @property
    def version(self) -> str:
        """The version of the package."""
        return version("pybullet")

    def resolve(self, case: Case) -> dict[str, Value]:
        """Return every setting in force for a case: an option, else what an effect asks for."""
        return in_force(case, self.timestep(case))

    def open(self, case: Case) -> PybulletWorld:
        """Open a world with the scene of a case."""
        return PybulletWorld(case, self.resolve(case), self.timestep(case))

    def chunks(self, world: PybulletWorld, schedule: Schedule, size: int) -> Iterator[Chunk]:
        """Step by a schedule from where the world is, yielding after `size` steps or more."""
        # the schedule is asked after a chunk was seen: what is seen may change what comes
        while (stage := _next(schedule, world)) is not None:
            steps = Steps(schedule.looks)
            while stage is not None:
                world.set_timestep(stage.timestep)
                steps.take(world, stage)
                stage = None if steps.reach(size) else _next(schedule, world)
            yield steps.chunk()

    def leanest(self, world: PybulletWorld, steps: int) -> None:
        """Step so many times and do nothing else: no reading, no record."""
        times = np.arange(steps) * np.float64(world.timestep)
        step, client = world.stepper(times), world.client
        for _ in range(steps):
            step(client)

    def keeping(self, world: PybulletWorld, steps: int) -> None:
        """Step so many times and keep what PyBullet says of each state and contact, as it is."""
        step = world.stepper(np.arange(steps) * np.float64(world.timestep))
        can, ground, client = world.can, world.ground, world.client
        kept = []
        for _ in range(steps):
            pose = pybullet.getBasePositionAndOrientation(can, client)
            twist = pybullet.getBaseVelocity(can, client)
            step(client)
            contacts = pybullet.getContactPoints(can, ground, physicsClientId=client)
            kept.append((pose, twist, contacts))


def _next(schedule: Schedule, world: PybulletWorld) -> Stage | None:
    """Return the stage that the world's state calls for."""
    _, (x, y, z, w), _, spin = world.state()
    return schedule.next((w, x, y, z), spin)
