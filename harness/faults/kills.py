"""Kill -9 of the whole program, at random moments, until it has come through nevertheless."""

import random
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from harness.faults.ledger import broken, differing, ledger
from harness.faults.processes import killed_after, left_behind
from harness.faults.program import Order, started
from harness.faults.trial import Trial
from harness.store import Store

_SEED = 20_230_208

_CASES = tuple(
    (scene, engine, profile, timestep)
    for engine in ("mujoco", "pybullet")
    for scene, profile, timestep in (
        ("gentle-rock", "default", None),
        ("gentle-rock", "adaptive", None),
        ("gentle-rock", "matched", 3e-4),
        ("gentle-rock", "matched", 1e-4),
        ("paper-release", "adaptive", None),
        ("paper-release", "matched", 1e-5),
        ("straight-rolling", "matched", 1e-3),
    )
)
"""Some tenths of a second each: a kill finds some kept, some on their way, some not begun."""


def kills(count: int, folder: Path, told: Callable[[str], None]) -> Trial:
    """Kill the program so many times; each time it is started again where it was.

    Whenever it has come through, its results are compared with those of a run that nothing
    disturbed, and it starts from nothing.
    """
    began = time.monotonic()
    order = Order(store=str(folder / "undisturbed"), cases=_CASES)
    started(order).communicate()
    length = time.monotonic() - began
    undisturbed = Store(folder=Path(order.store))
    chance = random.Random(_SEED)  # noqa: S311 - moments, not secrets
    done, rounds, counts = 0, 0, [0, 0, 0, 0, 0, 0]
    while done < count:
        store = Store(folder=folder / f"round-{rounds}")
        while True:
            # past the end of what is left the program comes through, and the round is over
            moment = chance.uniform(0.0, length) if done < count else 10.0 * length
            process = started(replace(order, store=str(store.folder)))
            killed = killed_after(process, moment)
            counts[0] += left_behind(process.pid)
            if not killed:
                break
            done += 1
            told(f"kill {done} of {count}")
        book = ledger(store)
        new = (book.tasks, book.begun - book.tasks, book.again, broken(store))
        counts[1:5] = [old + more for old, more in zip(counts[1:5], new, strict=True)]
        counts[5] += differing(store, undisturbed)
        rounds += 1
    orphans, tasks, in_flight, again, spoilt, other = counts
    return Trial(
        name="kill -9",
        done=f"the whole program killed at {done} random moments of {rounds} suites",
        demanded="results as of an undisturbed run, bit for bit; no case that was kept run again",
        found=(
            f"{tasks} results, of which {other} differ",
            f"{again} kept ones run again",
            f"{in_flight} on their way at a kill and begun again",
            f"{spoilt} entries broken, {orphans} processes left behind",
        ),
        passed=not (other or again or spoilt or orphans) and tasks == rounds * len(_CASES),
        seconds=time.monotonic() - began,
    )
