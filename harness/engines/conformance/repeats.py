"""Determinism, bit for bit: whatever ran before, beside it, and in whatever process."""

import os
import subprocess
import sys
from dataclasses import replace

from harness.engines.conformance.bench import FINE, Bench
from harness.engines.conformance.fingerprint import fingerprint
from harness.engines.conformance.verdict import Found, holds, not_applicable
from harness.engines.registry import names
from harness.engines.soundness import fault

_PATIENCE = 120.0  # s: a fresh process imports an engine and runs 20 steps


def repeats(bench: Bench) -> Found:
    """Run a case twice."""
    case = bench.case(bench.brief)
    same = fingerprint(bench.run(case)) == fingerprint(bench.run_anew(case))
    return holds("" if same else "two runs of one case differ", "equal bits")


def repeats_after_another(bench: Bench) -> Found:
    """Run a case again after one with another can, gravity, release and timestep."""
    case = bench.case(bench.brief)
    first = fingerprint(bench.run(case))
    can = replace(bench.brief.can, mass=2.0 * bench.brief.can.mass)
    other = replace(bench.thrown, can=can, gravity=1.62)
    bench.run_anew(bench.case(other, FINE))
    same = fingerprint(bench.run_anew(case)) == first
    return holds("" if same else "a case runs otherwise after another case", "equal bits")


def repeats_in_a_batch(bench: Bench) -> Found:
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
        reason = fault(answer, asked)
        if not reason and fingerprint(answer) != fingerprint(bench.run(asked)):
            reason = "differs from its run alone"
        if reason:
            return holds(f"case {index + 1} of {len(cases)}: {reason}", "")
    return holds("", f"equal bits in {len(cases)} cases")


def repeats_in_a_fresh_process(bench: Bench) -> Found:
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
