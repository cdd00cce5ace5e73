"""What an engine declares of itself, and a sound simulation that states what was asked.

The clauses of the contract about name, version, settings, capabilities and one brief run.
"""

import pickle
import re
from dataclasses import fields, replace

from harness.core.case import PROFILES, Case
from harness.core.simulation import Outcome
from harness.engines.base import Capabilities, Setting, resolve
from harness.engines.conformance.suite import (
    ClauseResult,
    Fixture,
    clause,
    fingerprint,
    holds,
    same_bits,
)
from models import Effects
from models.effects import OPTIONAL_CONSTANTS

_NAME = r"[a-z][a-z0-9_.-]{0,31}"


@clause("The name fits a command line, a file name and a table.", needs_run=False)
def name(fixture: Fixture) -> ClauseResult:
    """Look at the name: what a command line, a file name and a table key alike can hold."""
    declared: object = fixture.engine.name
    fits = isinstance(declared, str) and re.fullmatch(_NAME, declared) is not None
    wrong = "" if fits else f"{declared!r} is not lower-case letters, digits, dots and dashes"
    return holds(wrong, str(declared))


@clause("The version is a text.", needs_run=False)
def version(fixture: Fixture) -> ClauseResult:
    """Look at the version, which goes into the digest of every case."""
    declared: object = fixture.engine.version
    fits = isinstance(declared, str) and declared.strip() != ""
    return holds("" if fits else f"{declared!r} is no text", str(declared))


@clause("Each setting is named once, explained, and takes its own values.", needs_run=False)
def settings(fixture: Fixture) -> ClauseResult:
    """Look at the settings: each named once, explained, and taking its own values."""
    declared: object = fixture.engine.settings
    if not isinstance(declared, tuple) or not all(isinstance(s, Setting) for s in declared):
        return holds("`settings` is not a tuple of Setting", "")
    known = [setting.name for setting in declared]
    if twice := sorted({each for each in known if known.count(each) > 1}):
        return holds(f"declared twice: {', '.join(twice)}", "")
    mute = [s.name for s in declared if len(s.meaning.split()) < 2]  # noqa: PLR2004 - a sentence
    if mute:
        return holds(f"without a sentence of meaning: {', '.join(mute)}", "")
    for profile in PROFILES:
        case = Case(scene=fixture.brief, engine=fixture.engine.name, profile=profile)
        timestep = fixture.engine.timestep(case) or 0.0
        chosen = resolve(case, declared, timestep)
        options = tuple((key, value) for key, value in chosen.items() if value is not None)
        # raises where a setting does not take its own value
        resolve(replace(case, options=options), declared, timestep)
    return holds("", f"{len(known)} settings")


@clause("What is honoured is an effect of scenes; what is imposed has a sentence.", needs_run=False)
def capabilities(fixture: Fixture) -> ClauseResult:
    """Look at the capabilities: effects that exist, and a sentence for each imposed one."""
    declared: object = fixture.engine.capabilities
    if not isinstance(declared, Capabilities):
        return holds(f"`capabilities` is {type(declared).__name__}, not Capabilities", "")
    known = {*(field.name for field in fields(Effects)), *OPTIONAL_CONSTANTS}
    unknown = sorted(set(declared.honours) - known)
    if unknown:
        return holds(f"honours what is no effect of a scene: {', '.join(unknown)}", "")
    mute = [key for key, sentence in declared.imposes.items() if not sentence.strip()]
    honours = ", ".join(sorted(declared.honours)) or "nothing"
    imposes = ", ".join(declared.imposes) or "nothing"
    wrong = f"imposes without a sentence: {', '.join(mute)}" if mute else ""
    return holds(wrong, f"honours {honours}, imposes {imposes}")


@clause("A case runs to its horizon and hands over a sound trajectory.", needs_run=False)
def trajectory(fixture: Fixture) -> ClauseResult:
    """Run the brief release: it ends at its horizon, with a trajectory that is sound."""
    samples, outcome = len(fixture.trajectory()), fixture.run(fixture.case()).outcome
    wrong = "" if outcome is Outcome.FINISHED else f"ended with {outcome.value}"
    return holds(wrong, f"{samples} samples")


@clause("A simulation states the settings, timestep and version that were in force.")
def report(fixture: Fixture) -> ClauseResult:
    """Compare what a simulation says of itself with what was asked."""
    case, chosen = fixture.case(), fixture.engine
    simulation, timestep = fixture.run(case), chosen.timestep(case)
    asked, stated = resolve(case, chosen.settings, timestep or 0.0), simulation.settings
    wrong = []
    if dict(stated) != asked:
        keys = asked.keys() | stated.keys()
        different = sorted(key for key in keys if asked.get(key, ...) != stated.get(key, ...))
        wrong.append(f"settings differ in {', '.join(different)}")
    if simulation.timestep != timestep:
        wrong.append(f"timestep {simulation.timestep} instead of {timestep}")
    if simulation.engine_version != chosen.version:
        wrong.append(f"version {simulation.engine_version} instead of {chosen.version}")
    if simulation.steps < (1 if fixture.steps else 0):  # a closed form takes no steps
        wrong.append(f"{simulation.steps} steps")
    times = simulation.compile_s, simulation.setup_s, simulation.wall_s, simulation.cpu_s
    if min(times) < 0.0:
        wrong.append("a negative time")
    return holds("; ".join(wrong), f"{len(asked)} settings, {simulation.steps} steps")


@clause("A simulation goes through pickle unchanged.")
def pickling(fixture: Fixture) -> ClauseResult:
    """Send a simulation through pickle: it goes to and from other processes."""
    simulation = fixture.run(fixture.case())
    back = pickle.loads(pickle.dumps(simulation))  # noqa: S301 - our own bytes
    if back.case != simulation.case or dict(back.settings) != dict(simulation.settings):
        return holds("the case or its settings changed on the way", "")
    return same_bits(fingerprint(back) == fingerprint(simulation), "the arrays changed on the way")
