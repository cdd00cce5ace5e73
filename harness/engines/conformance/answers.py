"""What an engine hands over: declarations, refusals, a sound simulation, and the same one again."""

import math
import pickle
import re
from dataclasses import fields, replace
from typing import Any

from harness.core.case import PROFILES, Case
from harness.core.errors import InvalidSettingError, UnknownSettingError, UnsupportedEffectError
from harness.core.simulation import Outcome, Simulation
from harness.engines.base import Capabilities, Setting, features_of, resolve
from harness.engines.conformance.effects import DECLARED
from harness.engines.conformance.fixture import (
    FINE,
    ClauseResult,
    Fixture,
    fingerprint,
    holds,
    not_applicable,
    same_bits,
)
from harness.engines.contract import contract_violation
from harness.engines.registry import check_effects, engine, names
from harness.engines.stepping.horizon import Watch
from harness.execution.isolated_pool import IsolatedProcessPool
from harness.execution.limits import Limits
from models import Effects, Horizon

_NAME = r"[a-z][a-z0-9_.-]{0,31}"


def name(fixture: Fixture) -> ClauseResult:
    """Look at the name: what a command line, a file name and a table key alike can hold."""
    found: object = fixture.engine.name
    fits = isinstance(found, str) and re.fullmatch(_NAME, found) is not None
    wrong = "" if fits else f"{found!r} is not lower-case letters, digits, dots and dashes"
    return holds(wrong, str(found))


def version(fixture: Fixture) -> ClauseResult:
    """Look at the version, which goes into the digest of every case."""
    found: object = fixture.engine.version
    fits = isinstance(found, str) and found.strip() != ""
    return holds("" if fits else f"{found!r} is no text", str(found))


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
        own = tuple((key, value) for key, value in chosen.items() if value is not None)
        # raises where a setting does not take its own value
        resolve(replace(case, options=own), declared, timestep)
    return holds("", f"{len(known)} settings")


def capabilities(fixture: Fixture) -> ClauseResult:
    """Look at the capabilities: effects that exist, and a sentence for each imposed one."""
    found: object = fixture.engine.capabilities
    if not isinstance(found, Capabilities):
        return holds(f"`capabilities` is {type(found).__name__}, not Capabilities", "")
    unknown = sorted(set(found.honours) - {field.name for field in fields(Effects)})
    if unknown:
        return holds(f"honours what is no effect of a scene: {', '.join(unknown)}", "")
    mute = [key for key, sentence in found.imposes.items() if not sentence.strip()]
    honours = ", ".join(sorted(found.honours)) or "nothing"
    imposes = ", ".join(found.imposes) or "nothing"
    wrong = f"imposes without a sentence: {', '.join(mute)}" if mute else ""
    return holds(wrong, f"honours {honours}, imposes {imposes}")


def trajectory(fixture: Fixture) -> ClauseResult:
    """Run the brief release: it ends at its horizon, with a trajectory that is sound."""
    samples, outcome = len(fixture.trajectory()), fixture.run(fixture.case()).outcome
    wrong = "" if outcome is Outcome.FINISHED else f"ended with {outcome.value}"
    return holds(wrong, f"{samples} samples")


def report(fixture: Fixture) -> ClauseResult:
    """Compare what a simulation says of itself with what was asked."""
    case, chosen = fixture.case(), fixture.engine
    simulation, timestep = fixture.run(case), chosen.timestep(case)
    asked, told = resolve(case, chosen.settings, timestep or 0.0), simulation.settings
    wrong = []
    if dict(told) != asked:
        keys = asked.keys() | told.keys()
        different = sorted(key for key in keys if asked.get(key, ...) != told.get(key, ...))
        wrong.append(f"settings differ in {', '.join(different)}")
    if simulation.timestep != timestep:
        wrong.append(f"timestep {simulation.timestep} instead of {timestep}")
    if simulation.engine_version != chosen.version:
        wrong.append(f"version {simulation.engine_version} instead of {chosen.version}")
    if simulation.steps < (1 if fixture.steps else 0):  # a closed form takes none
        wrong.append(f"{simulation.steps} steps")
    if min(simulation.setup_s, simulation.wall_s, simulation.cpu_s) < 0.0:
        wrong.append("a negative time")
    return holds("; ".join(wrong), f"{len(asked)} settings, {simulation.steps} steps")


def pickling(fixture: Fixture) -> ClauseResult:
    """Send a simulation through pickle: it goes to and from other processes."""
    simulation = fixture.run(fixture.case())
    back = pickle.loads(pickle.dumps(simulation))  # noqa: S301 - our own bytes
    if back.case != simulation.case or dict(back.settings) != dict(simulation.settings):
        return holds("the case or its settings changed on the way", "")
    return same_bits(fingerprint(back) == fingerprint(simulation), "the arrays changed on the way")


def repeats(fixture: Fixture) -> ClauseResult:
    """Run a case twice."""
    case = fixture.case()
    same = fingerprint(fixture.run(case)) == fingerprint(fixture.run_anew(case))
    return same_bits(same, "two runs of one case differ")


def repeats_after_another(fixture: Fixture) -> ClauseResult:
    """Run a case again after one with another can, gravity, release and timestep."""
    first = fingerprint(fixture.run(fixture.case()))
    can = replace(fixture.brief.can, mass=2.0 * fixture.brief.can.mass)
    fixture.run_anew(fixture.case(replace(fixture.thrown, can=can, gravity=1.62), FINE))
    same = fingerprint(fixture.run_anew(fixture.case())) == first
    return same_bits(same, "a case runs otherwise after another case")


def repeats_in_a_batch(fixture: Fixture) -> ClauseResult:
    """Run cases together: two cans, two timesteps, and one case twice."""
    together = features_of(fixture.engine).simulate_many
    if together is None:
        return not_applicable("the engine runs cases one by one")
    can = replace(fixture.brief.can, mass=2.0 * fixture.brief.can.mass)
    case, other = fixture.case(), fixture.case(replace(fixture.brief, can=can))
    cases = [case, fixture.case(timestep=FINE), other, case]
    answers = list(together(cases))
    if len(answers) != len(cases):
        return holds(f"{len(answers)} answers to {len(cases)} cases", "")
    for index, (asked, answer) in enumerate(zip(cases, answers, strict=True)):
        reason = contract_violation(answer, asked)
        if not reason and fingerprint(answer) != fingerprint(fixture.run(asked)):
            reason = "differs from its run alone"
        if reason:
            return holds(f"case {index + 1} of {len(cases)}: {reason}", "")
    return holds("", f"equal bits in {len(cases)} cases")


_PATIENCE = Limits(seconds=120.0)  # a fresh process imports an engine and runs 20 steps


def repeats_in_a_fresh_process(fixture: Fixture) -> ClauseResult:
    """Run a case in a process of its own."""
    own = fixture.engine.name
    if own not in names():
        return not_applicable("the engine is not registered, so that no other process finds it")
    with IsolatedProcessPool(1, _PATIENCE) as alone:
        there = alone.submit(_brief_fingerprint, own).result()
    same = there == fingerprint(fixture.run(fixture.case()))
    return same_bits(same, "a fresh process runs a case otherwise")


def _brief_fingerprint(own: str) -> str:
    """Return the fingerprint of a registered engine's run of the brief release."""
    fixture = Fixture(engine(own))
    return fingerprint(fixture.run(fixture.case()))


_ODD = (math.nan,) * 17
"""A value that no setting takes: seventeen numbers that are none."""


def unknown_setting(fixture: Fixture) -> ClauseResult:
    """Ask for a setting that no engine has."""
    try:
        fixture.engine.simulate(fixture.case(no_such_setting=1.0))
    except UnknownSettingError as error:
        named = "no_such_setting" in str(error)
        return holds("" if named else f"the message does not name it: {error}", str(error))
    return holds("a setting that does not exist was taken", "")


def wrong_value(fixture: Fixture) -> ClauseResult:
    """Give every setting a value of another kind."""
    if not fixture.engine.settings:
        return not_applicable("the engine has no settings")
    taken = []
    for setting in fixture.engine.settings:
        odd: dict[str, Any] = {setting.name: _ODD}
        try:
            fixture.engine.simulate(fixture.case(**odd))
        except InvalidSettingError:
            continue
        taken.append(setting.name)
    wrong = f"took a value of another kind: {', '.join(taken)}" if taken else ""
    return holds(wrong, f"{len(fixture.engine.settings)} settings")


def unsupported_effect(fixture: Fixture) -> ClauseResult:
    """Declare every effect that the engine neither honours nor imposes."""
    own = fixture.engine.capabilities
    represented = {*own.honours, *own.imposes}
    missing = [field.name for field in fields(Effects) if field.name not in represented]
    if not missing:
        return not_applicable("the engine honours or imposes every effect")
    if fixture.engine.name not in names():
        return not_applicable("the engine is not registered, so that no case reaches it")
    taken = []
    for effect in missing:
        try:
            check_effects(fixture.engine.name, replace(fixture.brief, effects=DECLARED[effect]))
        except UnsupportedEffectError:
            continue
        taken.append(effect)
    wrong = f"not refused: {', '.join(taken)}" if taken else ""
    return holds(wrong, f"refused: {', '.join(missing)}")


_VIOLENT = 1e8
"""rad/s: the can would turn a hundred thousand times in a timestep of the suite."""

_COARSEST = 0.5
"""s: a timestep of a whole rocking."""

_DEPTH, _SHORT = 1e-3, 5e-6
"""m and s: a penetration that is pushed out within some steps."""


def divergence(fixture: Fixture) -> ClauseResult:
    """Ask for what few engines can do, and see that they say so.

    Violent rates; a timestep as long as the motion; and a rim that starts inside the plane, which a
    contact tied to a short timestep throws out at any speed.
    """
    if not fixture.steps:
        return not_applicable("a solver that chooses its own steps takes as many as it needs")
    release = fixture.brief.release
    violent = replace(release, phi_dot=_VIOLENT, theta_dot=_VIOLENT)
    sunk = replace(release, height=-_DEPTH)
    told = []
    for scene, timestep in (
        (replace(fixture.brief, release=violent), 1e-3),
        (replace(fixture.gentle, horizon=Horizon(seconds=20.0)), _COARSEST),
        (replace(fixture.brief, release=sunk), _SHORT),
    ):
        # raises where the answer is no simulation
        simulation = fixture.run_anew(fixture.case(scene, timestep))
        outcome: object = simulation.outcome
        if not isinstance(outcome, Outcome):
            return holds(f"`outcome` is {outcome!r}, not an Outcome", "")
        if _exploded(simulation) and outcome is not Outcome.DIVERGED:
            return holds(f"the speed grows without bound, and the outcome is {outcome.name}", "")
        told.append(simulation.outcome.name.lower().replace("_", " "))
    return holds("", ", ".join(told))


def _exploded(simulation: Simulation) -> bool:
    """Whether the record reaches a speed that no fall gives."""
    path = simulation.trajectory
    return path is not None and Watch(simulation.case.scene).over(path) is Outcome.DIVERGED
