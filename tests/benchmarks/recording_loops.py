"""The leanest loop of an engine that keeps each state and its contact: what an adapter is held to.

In C where the engine has such a loop, else in Python.
"""

from struct import Struct
from typing import Any

import numpy as np
from mujoco import rollout

from harness.engines.mujoco.steps import control, state_of
from harness.engines.world import World

_PIECE = 16384
"""Steps in a call of MuJoCo, as in a run: few enough to be held, 180 bytes each."""


def recording_loop(world: Any, steps: int) -> None:
    """Step a world so many times and keep each state and contact."""
    _LOOPS.get(type(world).__name__, _in_python)(world, steps)


def _in_python(world: World, steps: int) -> None:
    """Keep what the role `World` reads."""
    kept = []
    for _ in range(steps):
        state = world.pose(), world.twist()
        world.step()
        kept.append((*state, world.contact()))


def _of_mujoco(world: Any, steps: int) -> None:
    """Keep each state and the sensors of its contact, in C."""
    state = state_of(world)
    for first in range(0, steps, _PIECE):
        times = np.arange(first, min(first + _PIECE, steps)) * np.float64(world.timestep)
        states, _ = rollout.rollout(
            world.model,
            world.data,
            state[None],
            **control(world, times),
            initial_warmstart=world.data.qacc_warmstart.copy()[None],
        )
        state = states[0, -1]


def _of_pybullet(world: Any, steps: int) -> None:
    """Keep what PyBullet says of each state and contact, in bytes.

    Kept as PyBullet returns it, in tuples, it takes a quarter longer: the collector of garbage
    walks them.
    """
    import pybullet  # noqa: PLC0415 - may not be installed; its world is one of the adapter's

    step = world.stepper(np.arange(steps) * np.float64(world.timestep))
    can, ground, client = world.can, world.ground, world.client
    kept, state, contact = bytearray(), Struct("13d").pack, Struct("19d").pack
    for _ in range(steps):
        position, quaternion = pybullet.getBasePositionAndOrientation(can, client)
        velocity, spin = pybullet.getBaseVelocity(can, client)
        step(client)
        kept += state(*position, *quaternion, *velocity, *spin)
        for point in pybullet.getContactPoints(can, ground, -2, -2, client):
            own, other, normal, distance, force, first, along, second, across = point[5:14]
            kept += contact(*own, *other, *normal, distance, force, first, *along, second, *across)


_LOOPS = {"MujocoWorld": _of_mujoco, "PybulletWorld": _of_pybullet}
