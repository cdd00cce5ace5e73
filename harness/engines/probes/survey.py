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
from harness.engines.probes.fixture import Evidence, Measurement, Opener, ProbeFinding, Trace
from harness.engines.probes.flight import clamp, damping, gyroscopic, turn
from harness.engines.registry import engine
from models.catalogue import load


@dataclass(frozen=True, slots=True)
class Probe:
    """One effect, the question that isolates it, and what answers it."""

    effect: str
    question: str
    measure: Callable[[Opener, Case], Iterator[Evidence]]


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
    evidence = [each for probe in PROBES for each in probe.measure(chosen, stated)]
    return Measurement(
        case=case,
        engine_version=chosen.version,
        timestep=chosen.timestep(case),
        findings=tuple(each for each in evidence if isinstance(each, ProbeFinding)),
        traces=tuple(each for each in evidence if isinstance(each, Trace)),
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
