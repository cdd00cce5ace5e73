"""What an engine hands over: a sound simulation, with the settings in force, that travels.

What an engine says of itself: name, version, settings, capabilities.

Determinism, bit for bit: whatever ran before, beside it, and in whatever process.

The sampling grid: from the release on, forwards, dense by angle, up to the horizon.
"""

import os
import pickle
import re
import subprocess
import sys
from dataclasses import fields, replace

import numpy as np

from harness.core.case import PROFILES, Case
from harness.core.simulation import Outcome
from harness.engines.base import Capabilities, Setting, resolve
from harness.engines.conformance.fingerprint import fingerprint
from harness.engines.conformance.fixture import (
    BRIEF,
    FINE,
    ClauseEvidence,
    Fixture,
    holds,
    not_applicable,
    within,
)
from harness.engines.contract import contract_violation
from harness.engines.registry import names
from models.effects import Effects
from models.kinematics import angle_rates, angles, principal
from models.record import RESOLVED_STEP
from models.scene import Horizon


def trajectory(bench: Fixture) -> ClauseEvidence:
    """Run the brief release: it ends at its horizon, with a trajectory that is sound."""
    case = bench.case(bench.brief)
    samples = len(bench.trajectory(case))
    outcome = bench.run(case).outcome
    finished = outcome is Outcome.FINISHED
    return holds("" if finished else f"ended with {outcome.value}", f"{samples} samples")


def reported(bench: Fixture) -> ClauseEvidence:
    """Compare what a simulation says of itself with what was asked."""
    case = bench.case(bench.brief)
    simulation, engine = bench.run(case), bench.engine
    timestep = engine.timestep(case)
    asked = resolve(case, engine.settings, timestep or 0.0)
    wrong = []
    if dict(simulation.settings) != asked:
        different = {
            key
            for key in asked.keys() | simulation.settings.keys()
            if asked.get(key, ...) != simulation.settings.get(key, ...)
        }
        wrong.append(f"settings differ in {', '.join(sorted(different))}")
    if simulation.timestep != timestep:
        wrong.append(f"timestep {simulation.timestep} instead of {timestep}")
    if simulation.engine_version != engine.version:
        wrong.append(f"version {simulation.engine_version} instead of {engine.version}")
    if simulation.steps < (1 if bench.steps else 0):  # a closed form takes none
        wrong.append(f"{simulation.steps} steps")
    if min(simulation.setup_s, simulation.wall_s, simulation.cpu_s) < 0.0:
        wrong.append("a negative time")
    return holds("; ".join(wrong), f"{len(asked)} settings, {simulation.steps} steps")


def pickling(bench: Fixture) -> ClauseEvidence:
    """Send a simulation through pickle: it goes to and from other processes."""
    simulation = bench.run(bench.case(bench.brief))
    back = pickle.loads(pickle.dumps(simulation))  # noqa: S301 - our own bytes
    if back.case != simulation.case or dict(back.settings) != dict(simulation.settings):
        return holds("the case or its settings changed on the way", "")
    same = fingerprint(back) == fingerprint(simulation)
    return holds("" if same else "the arrays changed on the way", "equal bits")


_NAME = r"[a-z][a-z0-9_.-]{0,31}"


def name(bench: Fixture) -> ClauseEvidence:
    """Look at the name: what a command line, a file name and a table key alike can hold."""
    found: object = bench.engine.name
    fits = isinstance(found, str) and re.fullmatch(_NAME, found) is not None
    wrong = "" if fits else f"{found!r} is not lower-case letters, digits, dots and dashes"
    return holds(wrong, str(found))


def version(bench: Fixture) -> ClauseEvidence:
    """Look at the version, which goes into the digest of every case."""
    found: object = bench.engine.version
    fits = isinstance(found, str) and found.strip() != ""
    return holds("" if fits else f"{found!r} is no text", str(found))


def settings(bench: Fixture) -> ClauseEvidence:
    """Look at the settings: each named once, explained, and taking its own values."""
    declared: object = bench.engine.settings
    if not isinstance(declared, tuple) or not all(isinstance(s, Setting) for s in declared):
        return holds("`settings` is not a tuple of Setting", "")
    names = [setting.name for setting in declared]
    twice = sorted({each for each in names if names.count(each) > 1})
    if twice:
        return holds(f"declared twice: {', '.join(twice)}", "")
    mute = [s.name for s in declared if len(s.meaning.split()) < 2]  # noqa: PLR2004 - a sentence
    if mute:
        return holds(f"without a sentence of meaning: {', '.join(mute)}", "")
    for profile in PROFILES:
        case = Case(scene=bench.brief, engine=bench.engine.name, profile=profile)
        timestep = bench.engine.timestep(case) or 0.0
        chosen = resolve(case, declared, timestep)
        own = {key: value for key, value in chosen.items() if value is not None}
        again = Case(
            scene=case.scene, engine=case.engine, profile=profile, options=tuple(own.items())
        )
        resolve(again, declared, timestep)  # raises where a setting does not take its own value
    return holds("", f"{len(names)} settings")


def capabilities(bench: Fixture) -> ClauseEvidence:
    """Look at the capabilities: effects that exist, and a sentence for each imposed one."""
    found: object = bench.engine.capabilities
    if not isinstance(found, Capabilities):
        return holds(f"`capabilities` is {type(found).__name__}, not Capabilities", "")
    unknown = sorted(set(found.honours) - {field.name for field in fields(Effects)})
    if unknown:
        return holds(f"honours what is no effect of a scene: {', '.join(unknown)}", "")
    mute = [key for key, sentence in found.imposes.items() if not sentence.strip()]
    honours = ", ".join(sorted(found.honours)) or "nothing"
    imposes = ", ".join(found.imposes) or "nothing"
    return holds(
        f"imposes without a sentence: {', '.join(mute)}" if mute else "",
        f"honours {honours}, imposes {imposes}",
    )


_PATIENCE = 120.0  # s: a fresh process imports an engine and runs 20 steps


def repeats(bench: Fixture) -> ClauseEvidence:
    """Run a case twice."""
    case = bench.case(bench.brief)
    same = fingerprint(bench.run(case)) == fingerprint(bench.run_anew(case))
    return holds("" if same else "two runs of one case differ", "equal bits")


def repeats_after_another(bench: Fixture) -> ClauseEvidence:
    """Run a case again after one with another can, gravity, release and timestep."""
    case = bench.case(bench.brief)
    first = fingerprint(bench.run(case))
    can = replace(bench.brief.can, mass=2.0 * bench.brief.can.mass)
    other = replace(bench.thrown, can=can, gravity=1.62)
    bench.run_anew(bench.case(other, FINE))
    same = fingerprint(bench.run_anew(case)) == first
    return holds("" if same else "a case runs otherwise after another case", "equal bits")


def repeats_in_a_batch(bench: Fixture) -> ClauseEvidence:
    """Run cases together: two cans, two timesteps, and one case twice."""
    together = getattr(bench.engine, "simulate_many", None)
    if together is None:
        return not_applicable("the engine runs cases one by one")
    case, finer = bench.case(bench.brief), bench.case(bench.brief, FINE)
    can = replace(bench.brief.can, mass=2.0 * bench.brief.can.mass)
    other = bench.case(replace(bench.brief, can=can))
    cases = [case, finer, other, case]
    answers = list(together(cases))
    if len(answers) != len(cases):
        return holds(f"{len(answers)} answers to {len(cases)} cases", "")
    for index, (asked, answer) in enumerate(zip(cases, answers, strict=True)):
        reason = contract_violation(answer, asked)
        if not reason and fingerprint(answer) != fingerprint(bench.run(asked)):
            reason = "differs from its run alone"
        if reason:
            return holds(f"case {index + 1} of {len(cases)}: {reason}", "")
    return holds("", f"equal bits in {len(cases)} cases")


def repeats_in_a_fresh_process(bench: Fixture) -> ClauseEvidence:
    """Run a case in a process of its own."""
    name = bench.engine.name
    if name not in names():
        return not_applicable("the engine is not registered, so that no other process finds it")
    done = subprocess.run(  # noqa: S603 - our own module, and a registered name
        [sys.executable, "-m", "harness.engines.conformance.fingerprint", name],
        env=os.environ | {"PYTHONPATH": os.pathsep.join(path for path in sys.path if path)},
        capture_output=True,
        check=False,
        encoding="utf-8",
        timeout=_PATIENCE,
    )
    if done.returncode != 0:
        last = (done.stderr.strip().splitlines() or ["no message"])[-1]
        return holds(f"a fresh process fails: {last}", "")
    same = done.stdout.strip() == fingerprint(bench.run(bench.case(bench.brief)))
    return holds("" if same else "a fresh process runs a case otherwise", "equal bits")


_ODD = 7e-4
"""s: a timestep that does not divide the horizon."""


def starts(bench: Fixture) -> ClauseEvidence:
    """Look at the first instant and at the smallest distance between two."""
    time = bench.trajectory(bench.case(bench.brief)).time
    # the release is at zero exactly: nothing is summed up to there
    if len(time) > 1 and not np.diff(time).min() > 0.0:
        return within(-float(np.diff(time).min()), 0.0, "s", "time runs backwards or stands still")
    return within(abs(float(time[0])), 0.0, "s", f"first instant of {len(time)}, all increasing")


def dense(bench: Fixture) -> ClauseEvidence:
    """Look at how far the precession gets between samples, through the whole bounce.

    The rates at both ends count as well, since between samples far apart psi may go round unseen.
    """
    path = bench.trajectory(bench.case(bench.gentle, FINE))
    if len(path) < 2:  # noqa: PLR2004 - one sample has no distance to another
        return within(float("inf"), float(RESOLVED_STEP), "rad", "one sample")
    phi, psi, _ = angles(path.quaternion)
    _, psi_dot, _ = angle_rates(phi, psi, path.angular_velocity)
    rate = np.maximum(np.abs(psi_dot[:-1]), np.abs(psi_dot[1:]))
    turn = np.maximum(np.abs(principal(np.diff(psi))), rate * np.diff(path.time))
    detail = f"largest turn of psi from sample to sample, of {len(path)}"
    return within(float(turn.max()), float(RESOLVED_STEP), "rad", detail)


def ends(bench: Fixture) -> ClauseEvidence:
    """Look at the last instant, where the timestep divides the horizon and where it does not."""
    worst = 0.0
    for timestep in (1e-3, _ODD) if bench.steps else (1e-3,):
        case = bench.case(bench.brief, timestep)
        left = BRIEF - float(bench.trajectory(case).time[-1])
        # a solver without timesteps ends at the horizon itself, but for round-off
        allowed = timestep if bench.steps else 1e-12 * BRIEF
        # the last state lies at the horizon or less than a timestep before it, never behind it
        worst = max(worst, left / allowed, -left / (1e-9 * BRIEF))
    return within(worst, 1.0, "timesteps", "from the last sample to a horizon of 20 ms")


def grows(bench: Fixture) -> ClauseEvidence:
    """Let the horizon double: the first half of the run stays what it was."""
    if not bench.steps:
        return not_applicable("a solver that chooses its own steps may choose others")
    short = bench.trajectory(bench.case(bench.brief))
    double = replace(bench.brief, horizon=Horizon(seconds=2.0 * BRIEF))
    long = bench.trajectory(bench.case(double))
    common = short.time[:-1]  # the last sample of a run is kept whatever the angles say
    at = np.searchsorted(long.time, common)
    if at.max() >= len(long):
        return within(float("inf"), 0.0, "m", "the longer run lacks instants of the shorter")
    off = float(np.abs(long.position[at] - short.position[:-1]).max())
    return within(off, 0.0, "m", "position at the instants of the shorter run")
