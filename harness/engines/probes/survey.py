"""The survey of an engine: every probe in turn, and how probes open and follow worlds.

A probe gets at a world, loads its can and follows it, with every reading of the same instant. It
yields readings; the survey of a case collects them over all probes.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Protocol, TypeAlias

from harness.core.case import Case, Value
from harness.core.errors import InvalidSettingError
from harness.engines.base import Engine, Setting, features_of
from harness.engines.registry import engine
from harness.engines.remote import call_at_engine
from harness.engines.stepping.settling import settle
from harness.engines.world import Contact, World
from models import IDEAL, Pose, Release, Twist, release_state

Reading: TypeAlias = tuple[str, str, float, float, str]
"""Quantity, unit, what was measured in the engine, what the ideal can has, and what was done."""


class Opener(Engine, Protocol):
    """An engine that compiles a case into a world that can be placed, stepped and read."""

    def open(self, case: Case) -> World:
        """Compile the scene of a case."""


Probe: TypeAlias = Callable[[Opener, Case], Iterator[Reading]]

PROBES: dict[str, Probe] = {}
"""Every probe by the effect that it isolates, in the order of the report: as they are written."""


OF_CONTACT: set[str] = set()
"""Effects of a contact, of which a constraint has none."""


def probe(effect: str, *, contact: bool = False) -> Callable[[Probe], Probe]:
    """Return a decorator that makes a function the probe of an effect, of a contact or not."""

    def registered(readings: Probe) -> Probe:
        PROBES[effect] = readings
        if contact:
            OF_CONTACT.add(effect)
        return readings

    return registered


def follow(world: World, steps: int) -> Iterator[tuple[Pose, Twist, Contact]]:
    """Yield states of a world before so many steps, each with the contact solved in it."""
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


def alternatives(settings: tuple[Setting, ...], case: Case) -> Iterator[tuple[str, Value]]:
    """Yield each word or truth value that a setting can take, unless the case sets it itself."""
    for setting in settings:
        if setting.name in dict(case.options):
            continue
        values: tuple[Value, ...] = setting.choices
        if isinstance(setting.default, bool):
            values = (False, True)
        for value in values:
            yield setting.name, value


@dataclass(frozen=True, slots=True)
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


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Measurement:
    """Readings of all probes in one engine with one choice of settings.

    Parameters
    ----------
    case : Case
        Its can, gravity, profile, timestep and options were probed; its release was not.
    engine_version : str
    timestep : float or None
        s; None of an engine that chooses its own steps.
    findings : tuple of ProbeFinding
    """

    case: Case
    engine_version: str
    timestep: float | None
    findings: tuple[ProbeFinding, ...]


def measure(case: Case) -> Measurement:
    """Return the readings of all probes in the engine of a case with its settings, where it lives.

    Parameters
    ----------
    case : Case
        Gives can, gravity, engine, profile, timestep and options; gravity must not be zero.

    Raises
    ------
    InvalidSettingError
        If the engine opens no worlds, or if there is no gravity to load the can.
    HarnessError
        If the engine, a setting or a value does not exist.
    """
    return call_at_engine(case.engine, _measured, case)


def _measured(case: Case) -> Measurement:
    """Return the readings of all probes, here."""
    chosen = engine(case.engine)
    if features_of(chosen).open is None:
        allowed = "an engine that steps a world; the reference solves equations and imposes nothing"
        raise InvalidSettingError("engine", case.engine, allowed)
    if case.scene.gravity == 0.0:
        raise InvalidSettingError("gravity", 0.0, "greater than zero, to load the can")
    opener: Opener = chosen  # type: ignore[assignment] # it opens worlds
    # stated in the case, since a timestep that depends on gravity would change with the load
    stated = replace(case, timestep=opener.timestep(case))
    refusal = features_of(chosen).description.method.refusal
    refused: Reading = ("what a contact does", "1", math.nan, math.nan, refusal)
    return Measurement(
        case=case,
        engine_version=opener.version,
        timestep=opener.timestep(case),
        findings=tuple(
            ProbeFinding(effect, *reading)
            for effect, readings in PROBES.items()
            for reading in (
                (refused,) if refusal and effect in OF_CONTACT else readings(opener, stated)
            )
        ),
    )
