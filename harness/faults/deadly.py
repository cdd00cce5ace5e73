"""Engines that crash, hang, eat memory and return garbage, in one suite with sound ones."""

import json
import time
from collections.abc import Callable
from pathlib import Path

from harness.faults.processes import left_behind
from harness.faults.program import Order, register, started
from harness.faults.trial import Trial

_SECONDS = 12.0
"""Allowed for a case: sound ones take tenths of a second, a gibibyte is eaten in some seconds."""

_MEMORY = 1.0 * 2**30
"""Allowed for a case: an engine and the reference use a fifth of it."""

_EXPECTED = {
    "crashing": ("CRASHED", "killed: SIGSEGV, segmentation fault"),
    "hanging": ("HUNG", f"killed: it ran longer than the {_SECONDS:g} s allowed"),
    "hungry": ("OUT_OF_MEMORY", "killed: it used more than the 1 GiB allowed"),
    "garbling": ("BROKEN", "`position` is no number at sample 1"),
    "mujoco": ("FINISHED", ""),
    "pybullet": ("FINISHED", ""),
}


def deadly(folder: Path, told: Callable[[str], None]) -> Trial:
    """Run a suite in which four of six engines fail, each in its own way."""
    began = time.monotonic()
    told("engines that crash, hang, eat memory and return garbage")
    # the sound ones last: what went before must not have hurt them
    cases = [("gentle-rock", name, "matched", 1e-3) for name in _EXPECTED]
    order = Order(
        store=str(folder / "deadly"), cases=cases, jobs=2, seconds=_SECONDS, memory=_MEMORY
    )
    process = started(order, register(folder / "entries"))
    said, complained = process.communicate()
    orphans = left_behind(process.pid)
    outcomes = json.loads(said) if process.returncode == 0 else []
    named = {engine: (outcome, note) for engine, outcome, note in outcomes}
    right = [
        name
        for name, (outcome, note) in _EXPECTED.items()
        if name in named and named[name][0] == outcome and named[name][1].startswith(note)
    ]
    found = tuple(", ".join(filter(None, (f"{name}: {o}", n))) for name, (o, n) in named.items())
    return Trial(
        name="engines that fall",
        done="one suite with an engine that crashes, one that hangs, one that allocates without "
        "end, one that returns garbage, and two sound ones",
        demanded="the suite completes and names each",
        found=(*(found or (complained.strip(),)), f"{orphans} processes left behind"),
        passed=len(right) == len(_EXPECTED) and not orphans,
        seconds=time.monotonic() - began,
    )
