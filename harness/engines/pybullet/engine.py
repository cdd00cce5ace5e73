"""PyBullet as an engine: open a world of its own, compare, settle, then step and read.

There is no batched stepping: each step is a call, and so is each of the three readings. The
contacts that a step leaves are paired with the state before it.
"""

from collections.abc import Iterator
from importlib.metadata import version

import numpy as np
import pybullet

from harness.case import Case
from harness.engines.base import Capabilities, Floats
from harness.engines.pybullet.settings import (
    DEFAULT_TIMESTEP,
    IMPOSED_BY_DEFAULT,
    MATCHED_TIMESTEP,
    SETTINGS,
)
from harness.engines.pybullet.world import PybulletWorld, resultant
from harness.engines.stepping import Chunk, PhysicsEngine
from harness.trajectory import Trajectory

_STATE = 13  # numbers of pose and twist
_ROWS_PER_CONTACT = 3  # the normal and two directions of friction


class PybulletEngine(PhysicsEngine[PybulletWorld]):
    """PyBullet: sequential impulses on contacts that are kept from step to step."""

    name = "pybullet"
    settings = SETTINGS
    default_timestep = DEFAULT_TIMESTEP
    matched_timestep = MATCHED_TIMESTEP
    capabilities = Capabilities(
        honours=frozenset({"slip"}),
        imposes={
            "stabilisation": "penetration is taken away by ERP, which adds energy",
            "cached contacts": "old points of the rim stay in the solver until they drift away",
        },
    )
    imposed_by_default = IMPOSED_BY_DEFAULT

    @property
    def version(self) -> str:
        """The version of the package."""
        return version("pybullet")

    def open(self, case: Case) -> PybulletWorld:
        """Open a world with the scene of a case."""
        return PybulletWorld(case, self.resolve(case), self.timestep(case))

    def chunks(self, world: PybulletWorld, steps: int, size: int) -> Iterator[Chunk]:
        """Step so many times from where the world is, at most `size` steps a chunk."""
        for done in range(0, steps, size):
            count = min(size, steps - done)
            rows = _step(world, count)
            sound = np.logical_and.accumulate(np.isfinite(rows[:, :_STATE]).all(axis=1))
            yield Chunk(
                trajectory=_read(world, rows[sound], done) if sound.any() else None,
                constraint_rows=np.where(sound, rows[:, -1], 0.0).astype(np.int64)
                * _ROWS_PER_CONTACT,
                sound=bool(sound.all()),
            )


def _step(world: PybulletWorld, count: int) -> Floats:
    """Step so many times; return the state before each step and its contacts, shape (count, 22)."""
    client, can, ground = world.client, world.can, world.ground
    step, pose_of = pybullet.stepSimulation, pybullet.getBasePositionAndOrientation
    velocity_of, contacts_of = pybullet.getBaseVelocity, pybullet.getContactPoints
    rows = []
    for _ in range(count):
        position, quaternion = pose_of(can, client)
        velocity, spin = velocity_of(can, client)
        step(client)
        contact = resultant(contacts_of(can, ground, physicsClientId=client))
        rows.append((*position, *quaternion, *velocity, *spin, *contact))
    return np.array(rows, dtype=np.float64)


def _read(world: PybulletWorld, rows: Floats, done: int) -> Trajectory:
    """Return the rows of consecutive steps as a trajectory."""
    return Trajectory(
        time=np.arange(done, done + len(rows)) * np.float64(world.timestep),
        position=rows[:, :3],
        quaternion=rows[:, [6, 3, 4, 5]],
        velocity=rows[:, 7:10],
        angular_velocity=rows[:, 10:13],
        contact_point=rows[:, 13:16],
        contact_force=rows[:, 16:19],
        penetration=rows[:, 19],
        contact_count=rows[:, 20].astype(np.int64),
    )
