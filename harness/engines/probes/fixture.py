"""How probes get at a world, place a can in it and follow it, every reading of the same instant.

What a probe finds: numbers, each beside what the ideal can has, and curves.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from harness.core.case import Case
from harness.core.trajectory import Floats
from harness.engines.base import Contact, Setting, World
from harness.engines.stepping.settling import settle
from models.effects import IDEAL
from models.rim import release_state
from models.state import Pose, Release, Twist

ALOFT = 10.0
"""m: out of reach of any contact."""

UPRIGHT = np.array((1.0, 0.0, 0.0, 0.0))
STILL = Twist(velocity=np.zeros(3), angular_velocity=np.zeros(3))


class Opener(Protocol):
    """An engine that compiles a case into a world that can be placed, stepped and read."""

    settings: tuple[Setting, ...]

    @property
    def version(self) -> str:
        """The version of the engine's package."""
        ...

    def timestep(self, case: Case) -> float:
        """Return the timestep of a case, s."""
        ...

    def open(self, case: Case) -> World:
        """Compile the scene of a case."""
        ...


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Instant:
    """A state, and the contact that the engine solved in it."""

    pose: Pose
    twist: Twist
    contact: Contact


def follow(world: World, steps: int) -> Iterator[Instant]:
    """Yield so many states of a world, each with its own contact, stepping after each."""
    for _ in range(steps):
        pose, twist = world.pose(), world.twist()
        world.step()
        yield Instant(pose=pose, twist=twist, contact=world.contact())


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


@dataclass(frozen=True, slots=True, kw_only=True)
class ProbeFinding:
    """One imposed effect in one number.

    Parameters
    ----------
    effect : str
        Such as "compliance" or "damping".
    quantity, unit : str
    value : float
        As measured in the engine.
    expected : float
        What the ideal can has, or the closed form of rigid-body mechanics.
    how : str
        One sentence: what was done.
    """

    effect: str
    quantity: str
    unit: str
    value: float
    expected: float
    how: str


def findings(effect: str, how: str, *rows: tuple[str, str, float, float]) -> Iterator[ProbeFinding]:
    """Yield the findings of a probe, each given as quantity, unit, value and expected value."""
    for quantity, unit, value, expected in rows:
        yield ProbeFinding(
            effect=effect, quantity=quantity, unit=unit, value=value, expected=expected, how=how
        )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Trace:
    """One imposed effect as a curve, y against x, each of shape (n,), labels with units."""

    effect: str
    x_label: str
    y_label: str
    x: Floats
    y: Floats


Evidence = ProbeFinding | Trace


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Measurement:
    """All that the probes found in one engine with one choice of settings.

    Parameters
    ----------
    case : Case
        Its can, gravity, profile, timestep and options were probed; its release was not.
    engine_version : str
    timestep : float
        s.
    findings : tuple of Finding
    traces : tuple of Trace
    """

    case: Case
    engine_version: str
    timestep: float
    findings: tuple[ProbeFinding, ...]
    traces: tuple[Trace, ...]
