"""What a step costs when there is nothing to solve: one free body aloft, no contact.

Stepped in a loop of Python, and in the engine's own loop where it has one. The difference is what
the language costs, not the engine; who compares engines at small scenes compares mostly that.
"""

import time
from collections.abc import Callable

import numpy as np

from harness.core.case import Case
from harness.core.errors import BrokenEngineError
from harness.engines.base import World, features_of
from harness.engines.registry import engine, is_ours
from harness.engines.stepping.schedule import Fixed
from harness.evaluation.evaluation import Record
from harness.evaluation.timing import FEWEST
from models.scene import Scene
from models.state import Pose, Twist

_STEPS = 4000
"""A few milliseconds in C."""

_TIMESTEP = 1e-5
"""s: in all steps together the can falls by 8 mm."""

_ALOFT = 10.0
"""m."""

_LEANEST = "the engine's loop that steps and keeps nothing: in C where it has one"

_REPEATS = 3 * FEWEST


def case(scene: Scene, name: str) -> Case:
    """Return the case whose world is stepped aloft."""
    return Case(scene=scene, engine=name, timestep=_TIMESTEP)


def overhead(chosen: Case) -> Record:
    """Return processor seconds of one step aloft, by the loop that takes it.

    Parameters
    ----------
    chosen : Case
        Of an engine that opens a world.

    Returns
    -------
    dict
        `ways`: for each way of stepping, the repeats in s a step; empty for an engine without a
        world, and for one of somebody else's that raises.
    """
    try:
        return _measured(chosen)
    except BrokenEngineError:  # it cannot even be made here
        return {"ways": {}}
    except Exception:
        if is_ours(engine(chosen.engine)):
            raise
        return {"ways": {}}


def _measured(chosen: Case) -> Record:
    """Time each way of stepping that an engine has."""
    found = engine(chosen.engine)
    features = features_of(found)
    opens, chunks, bare_loop = features.open, features.chunks, features.bare_loop
    if opens is None:
        return {"ways": {}}
    world = opens(chosen)

    def python() -> None:
        for _ in range(_STEPS):
            world.step()

    def harness() -> None:
        schedule = Fixed(_TIMESTEP, _TIMESTEP * (_STEPS - 1), _STEPS)
        for _ in chunks(world, schedule, _STEPS):  # type: ignore[misc]
            pass

    ways: dict[str, Callable[[], None]] = {"a call of Python for each step, nothing read": python}
    if chunks is not None:
        ways["every step read, as in a run where the can races"] = harness
    if bare_loop is not None:
        ways[_LEANEST] = lambda: bare_loop(world, _STEPS)
    return {"ways": {name: _repeated(world, way) for name, way in ways.items()}}


def _repeated(world: World, way: Callable[[], None]) -> list[float]:
    """Return the seconds a step of each repeat; a first one warms up."""
    taken = []
    for _ in range(_REPEATS + 1):
        world.place(
            Pose(position=np.array((0.0, 0.0, _ALOFT)), quaternion=np.array((1.0, 0.0, 0.0, 0.0))),
            Twist(velocity=np.zeros(3), angular_velocity=np.array((1.0, 0.0, 2.0))),
        )
        started = time.process_time()
        way()
        taken.append((time.process_time() - started) / _STEPS)
    return taken[1:]
