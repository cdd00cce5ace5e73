"""Two runs of a case: equal bits whatever ran before, and samples on one grid in time.

The sampling grid starts at the release, runs forwards, is dense by angle and ends at the horizon.
"""

import os
import subprocess
import sys
from dataclasses import replace

import numpy as np

from harness.engines.base import features_of
from harness.engines.conformance.fingerprint import fingerprint
from harness.engines.conformance.fixture import (
    BRIEF,
    FINE,
    ClauseResult,
    Fixture,
    clause,
    holds,
    not_applicable,
    within,
)
from harness.engines.contract import contract_violation
from harness.engines.registry import names
from models.kinematics import angle_rates, angles, principal
from models.record import RESOLVED_STEP
from models.scene import Horizon

_PATIENCE = 120.0  # s: a fresh process imports an engine and runs 20 steps


@clause("repeats", "A case run twice gives equal bits.")
def repeats(bench: Fixture) -> ClauseResult:
    """Run a case twice."""
    case = bench.case(bench.brief)
    same = fingerprint(bench.run(case)) == fingerprint(bench.run_anew(case))
    return holds("" if same else "two runs of one case differ", "equal bits")


@clause("repeats after another", "A case run after another case gives equal bits.")
def repeats_after_another(bench: Fixture) -> ClauseResult:
    """Run a case again after one with another can, gravity, release and timestep."""
    case = bench.case(bench.brief)
    first = fingerprint(bench.run(case))
    can = replace(bench.brief.can, mass=2.0 * bench.brief.can.mass)
    other = replace(bench.thrown, can=can, gravity=1.62)
    bench.run_anew(bench.case(other, FINE))
    same = fingerprint(bench.run_anew(case)) == first
    return holds("" if same else "a case runs otherwise after another case", "equal bits")


@clause("repeats in a batch", "Cases run together give the same bits as one by one.")
def repeats_in_a_batch(bench: Fixture) -> ClauseResult:
    """Run cases together: two cans, two timesteps, and one case twice."""
    together = features_of(bench.engine).simulate_many
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


@clause("repeats in a fresh process", "A case run in a process of its own gives equal bits.")
def repeats_in_a_fresh_process(bench: Fixture) -> ClauseResult:
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


@clause("starts", "Samples start at t = 0 and time increases strictly.")
def starts(bench: Fixture) -> ClauseResult:
    """Look at the first instant and at the smallest distance between two."""
    time = bench.trajectory(bench.case(bench.brief)).time
    # the release is at zero exactly: nothing is summed up to there
    if len(time) > 1 and not np.diff(time).min() > 0.0:
        return within(-float(np.diff(time).min()), 0.0, "s", "time runs backwards or stands still")
    return within(abs(float(time[0])), 0.0, "s", f"first instant of {len(time)}, all increasing")


@clause("dense", "Samples are dense by angle, so that turns can be counted.")
def dense(bench: Fixture) -> ClauseResult:
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


@clause("ends", "Samples end at the horizon, whether or not the timestep divides it.")
def ends(bench: Fixture) -> ClauseResult:
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


@clause("horizon", "A longer horizon does not change what happens before.")
def grows(bench: Fixture) -> ClauseResult:
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
