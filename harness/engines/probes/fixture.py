"""How probes get at a world, load its can and follow it, every reading of the same instant."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Protocol, TypeAlias

from harness.core.case import Case
from harness.engines.base import Contact, Setting, World
from harness.engines.stepping.settling import settle
from models import IDEAL, Pose, Release, Twist, release_state

ALOFT = 10.0
"""m: out of reach of any contact."""

Reading: TypeAlias = tuple[str, str, float, float, str]
"""Quantity, unit, what was measured in the engine, what the ideal can has, and what was done."""


class Opener(Protocol):
    """An engine that compiles a case into a world that can be placed, stepped and read."""

    settings: tuple[Setting, ...]

    @property
    def version(self) -> str:
        """The version of the engine's package."""

    def timestep(self, case: Case) -> float:
        """Return the timestep of a case, s."""

    def open(self, case: Case) -> World:
        """Compile the scene of a case."""


def follow(world: World, steps: int) -> Iterator[tuple[Pose, Twist, Contact]]:
    """Yield so many states of a world, each with the contact that the engine solved in it."""
    for _ in range(steps):
        pose, twist = world.pose(), world.twist()
        world.step()
        yield pose, twist, world.contact()


def aloft(engine: Opener, case: Case) -> World:
    """Return a world without gravity, in which a can placed high flies free for ever."""
    return engine.open(with_gravity(case, 0.0))


def leaning(engine: Opener, case: Case, phi: float) -> tuple[World, float]:
    """Return a world with the can at rest, tilted by phi (rad), where its contact bears the load.

    Returns
    -------
    world : World
    depth : float
        Static penetration, m.
    """
    pose, twist = release_state(case.scene.can, Release(phi=phi))
    depth, pose = settle(engine.open(case), case.scene, pose, twist)
    world = engine.open(case)
    world.place(pose, twist)
    return world, depth


def with_gravity(case: Case, gravity: float) -> Case:
    """Return a case of an ideal scene with another gravity, m/s^2."""
    return replace(case, scene=replace(case.scene, gravity=gravity, effects=IDEAL))
