"""PyBullet as an engine: open a world of its own, compare, settle, then step and read.

There is no batched stepping: each step is a call, and so is each of the three readings. The
contacts that a step leaves are paired with the state before it.
"""

from collections.abc import Iterator
from importlib.metadata import version
from typing import TypeAlias

import numpy as np
import pybullet

from harness.case import Case
from harness.engines.base import Capabilities, Floats
from harness.engines.chunk import Chunk
from harness.engines.pybullet.gaps import EFFORTS, GAPS
from harness.engines.pybullet.settings import (
    DEFAULT_TIMESTEP,
    IMPOSED_BY_DEFAULT,
    MATCHED_TIMESTEP,
    SETTINGS,
)
from harness.engines.pybullet.world import PybulletWorld, resultant
from harness.engines.schedule import Schedule, Stage
from harness.engines.stepping import PhysicsEngine
from harness.trajectory import Integers, Trajectory

Row: TypeAlias = tuple[float, ...]

_STATE = 13  # numbers of pose and twist
_ROWS_PER_CONTACT = 3  # the normal and two directions of friction


class PybulletEngine(PhysicsEngine[PybulletWorld]):
    """PyBullet: sequential impulses on contacts that are kept from step to step."""

    name = "pybullet"
    settings = SETTINGS
    default_timestep = DEFAULT_TIMESTEP
    matched_timestep = MATCHED_TIMESTEP
    gaps = GAPS
    efforts = EFFORTS
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

    def chunks(self, world: PybulletWorld, schedule: Schedule, size: int) -> Iterator[Chunk]:
        """Step by a schedule from where the world is, yielding after `size` steps or more."""
        stage = _next(schedule, world)
        while stage is not None:
            times: list[Floats] = []
            rows: list[Row] = []
            while stage is not None and len(rows) < size:
                world.set_timestep(stage.timestep)
                _step(world, len(stage.times), rows)
                times.append(stage.times)
                stage = _next(schedule, world)
            yield _chunk(np.concatenate(times), np.array(rows, dtype=np.float64))


def _next(schedule: Schedule, world: PybulletWorld) -> Stage | None:
    """Return the stage that the world's state calls for."""
    _, (x, y, z, w) = pybullet.getBasePositionAndOrientation(world.can, world.client)
    _, spin = pybullet.getBaseVelocity(world.can, world.client)
    return schedule.next((w, x, y, z), spin)


def _chunk(times: Floats, rows: Floats) -> Chunk:
    """Return the rows of consecutive steps, shape (n, 22)."""
    good = np.isfinite(rows[:, :_STATE]).all(axis=1)
    count = len(rows) if good.all() else int(np.argmin(good))
    points = rows[:, -1].copy()
    points[count:] = 0.0

    def read(keep: Integers) -> Trajectory:
        return _read(times[keep], rows[keep])

    return Chunk(
        times=times,
        quaternions=rows[:count, [6, 3, 4, 5]],
        constraint_rows=points.astype(np.int64) * _ROWS_PER_CONTACT,
        sound=count == len(rows),
        read=read,
    )


def _step(world: PybulletWorld, count: int, rows: list[Row]) -> None:
    """Step so many times; append the state before each step and its contacts, 22 numbers each."""
    client, can, ground = world.client, world.can, world.ground
    step, pose_of = pybullet.stepSimulation, pybullet.getBasePositionAndOrientation
    velocity_of, contacts_of = pybullet.getBaseVelocity, pybullet.getContactPoints
    for _ in range(count):
        position, quaternion = pose_of(can, client)
        velocity, spin = velocity_of(can, client)
        step(client)
        contact = resultant(contacts_of(can, ground, physicsClientId=client))
        rows.append((*position, *quaternion, *velocity, *spin, *contact))


def _read(times: Floats, rows: Floats) -> Trajectory:
    """Return the rows of consecutive steps as a trajectory."""
    return Trajectory(
        time=times,
        position=rows[:, :3],
        quaternion=rows[:, [6, 3, 4, 5]],
        velocity=rows[:, 7:10],
        angular_velocity=rows[:, 10:13],
        contact_point=rows[:, 13:16],
        contact_force=rows[:, 16:19],
        penetration=rows[:, 19],
        contact_count=rows[:, 20].astype(np.int64),
    )
