"""The survey of an engine: every probe in turn, each in a world of its own.

Engines are probed as they ship and matched, each profile once.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TypeGuard

from harness.core.case import Case
from harness.core.errors import InvalidSettingError
from harness.engines.base import Engine, features_of
from harness.engines.probes.contact import compliance, creep, points, rim, stabilisation
from harness.engines.probes.fixture import Opener, Reading
from harness.engines.probes.flight import clamp, damping, gyroscopic, turn
from harness.engines.registry import engine
from models import load


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


@dataclass(frozen=True, slots=True)
class Probe:
    """One effect, the question that isolates it, and what answers it."""

    effect: str
    question: str
    readings: Callable[[Opener, Case], Iterator[Reading]]

    def measure(self, chosen: Opener, case: Case) -> Iterator[ProbeFinding]:
        """Yield what the probe finds in an engine, with the settings of a case."""
        for quantity, unit, value, expected, how in self.readings(chosen, case):
            yield ProbeFinding(
                effect=self.effect,
                quantity=quantity,
                unit=unit,
                value=value,
                expected=expected,
                how=how,
            )


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
    findings : tuple of ProbeFinding
    """

    case: Case
    engine_version: str
    timestep: float
    findings: tuple[ProbeFinding, ...]


PROBES = (
    Probe("compliance", "How deep does the rim sink under the can's weight?", compliance),
    Probe(
        "friction compliance",
        "How fast does the rim creep under a force that true friction would hold?",
        creep,
    ),
    Probe("rim", "How far is the collider from a sharp circle?", rim),
    Probe("contact points", "Below which tilt does the rim touch in several points?", points),
    Probe("damping", "What does free flight lose?", damping),
    Probe("velocity clamp", "Which velocities does a step let pass?", clamp),
    Probe("orientation update", "How far can a step turn the can?", turn),
    Probe("gyroscopic term", "What does a spinning can, free of torque, gain or lose?", gyroscopic),
    Probe("stabilisation", "What motion does the engine make of an overlap?", stabilisation),
)
"""Every probe, in the order of the report."""


def opens_worlds(candidate: Engine) -> TypeGuard[Opener]:
    """Whether an engine compiles cases into worlds, which probes need."""
    return features_of(candidate).open is not None


def measure(case: Case) -> Measurement:
    """Return all that the probes find in the engine of a case with its settings.

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
    chosen = engine(case.engine)
    if not opens_worlds(chosen):
        allowed = "an engine that steps a world; the reference solves equations and imposes nothing"
        raise InvalidSettingError("engine", case.engine, allowed)
    if case.scene.gravity == 0.0:
        raise InvalidSettingError("gravity", 0.0, "greater than zero, to load the can")
    # said outright, since a timestep that goes with gravity would change with the load
    stated = replace(case, timestep=chosen.timestep(case))
    return Measurement(
        case=case,
        engine_version=chosen.version,
        timestep=chosen.timestep(case),
        findings=tuple(found for probe in PROBES for found in probe.measure(chosen, stated)),
    )


PROFILES = ("default", "matched")
"""Adaptive is matched with other timesteps, and probes take one timestep."""

SCENE = "gentle-rock"
"""Whose can and gravity are probed; the release is each probe's own."""


def design(
    engines: Sequence[str], profiles: Sequence[str] = PROFILES, timestep: float | None = None
) -> tuple[Case, ...]:
    """Return the cases to measure.

    Parameters
    ----------
    engines : sequence of str
        Names of engines that step a world.
    profiles : sequence of str
    timestep : float, optional
        s; each profile's own if left out.
    """
    scene = load(SCENE)
    return tuple(
        Case(scene=scene, engine=engine, profile=profile, timestep=timestep)
        for engine in engines
        for profile in profiles
    )
