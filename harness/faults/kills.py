"""Kill -9 of the whole suite, at random moments, until it has come through nevertheless."""

import random
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from harness.faults.ledger import broken, differing, differing_tables, ledger, whole
from harness.faults.processes import Program, begin, killed_after, left_behind
from harness.faults.trial import Trial
from harness.store import Store

_SEED = 20_230_208

SUITE = ("validate", "--suite", "quick")
"""The main job, as it is typed."""

_PROGRAM = "from harness.__main__ import main; main()"

_A_SUITE = 10
"""Kills of one suite, which then comes through: by then most of its cases are kept."""

_EARLY, _LATE = 0.35, 0.6
"""Of the time of an undisturbed run, the range of a moment: where results are kept, and, once for
each suite, so that it reaches the end of the report, which takes half of the time."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Place:
    """Where one suite keeps its results and writes its report."""

    folder: Path

    @property
    def store(self) -> Store:
        return Store(folder=self.folder / "store")

    @property
    def tables(self) -> Path:
        return self.folder / "report" / "tables"

    def started(self, command: Sequence[str]) -> Program:
        """Start the command as the leader of a process group of its own."""
        self.folder.mkdir(parents=True, exist_ok=True)
        words = ("--store", str(self.store.folder), "--out", str(self.tables.parent))
        return begin(_PROGRAM, [*command, *words], self.folder, ())


@dataclass(slots=True, kw_only=True)
class _Tally:
    """What the suites came to, together."""

    kills: int = 0
    suites: int = 0
    through: int = 0
    orphans: int = 0
    results: int = 0
    other: int = 0
    again: int = 0
    in_flight: int = 0
    spoilt: int = 0
    tables: int = 0

    def add(self, place: _Place, undisturbed: _Place) -> None:
        """Look at a suite that came to its end."""
        book = ledger(place.store)
        self.suites += 1
        self.results += whole(place.store)
        self.other += differing(place.store, undisturbed.store)
        self.again += book.again
        self.in_flight += book.begun - book.tasks
        self.spoilt += broken(place.store)
        self.tables += differing_tables(place.tables, undisturbed.tables)


def kills(
    count: int, folder: Path, told: Callable[[str], None], command: Sequence[str] = SUITE
) -> Trial:
    """Kill the command so many times; each time it is started again as it was.

    When it has come through, its results are compared with those of a run that nothing disturbed,
    and another starts from nothing.
    """
    began = time.monotonic()
    told("the suite that nothing disturbs")
    undisturbed = _Place(folder=folder / "undisturbed")
    whole_run = undisturbed.started(command)
    _, complained = whole_run.communicate()
    length = time.monotonic() - began
    chance = random.Random(_SEED)  # noqa: S311 - moments, not secrets
    tally = _Tally()
    while tally.kills < count and whole_run.returncode == 0:
        place = _Place(folder=folder / f"suite-{tally.suites}")
        for number in range(min(_A_SUITE, count - tally.kills)):
            latest = _LATE if number == _A_SUITE - 1 else _EARLY
            process = place.started(command)
            killed = killed_after(process, chance.uniform(0.0, latest * length))
            tally.orphans += left_behind(process.pid)
            if not killed:
                break
            tally.kills += 1
            told(f"kill {tally.kills} of {count}")
        last = place.started(command)
        _, complained = last.communicate()
        tally.through += last.returncode == 0
        tally.orphans += left_behind(last.pid)
        tally.add(place, undisturbed)
    expected = tally.suites * whole(undisturbed.store)
    return Trial(
        name="kill -9",
        done=f"`rockingcan {' '.join(command)}` killed, all its processes, at {tally.kills} random "
        f"moments of {tally.suites} suites, and started again each time",
        demanded="results and tables as of an undisturbed run, bit for bit but for the times they "
        "took; no case that was kept run again",
        found=(
            f"{tally.through} of {tally.suites} suites came through{_said(tally, complained)}",
            f"{tally.results} results of {expected}, of which {tally.other} differ",
            f"{tally.tables} tables of their reports differ",
            f"{tally.again} kept ones run again",
            f"{tally.in_flight} on their way at a kill and begun again",
            f"{tally.spoilt} entries broken, {tally.orphans} processes left behind",
        ),
        passed=tally.kills == count
        and tally.through == tally.suites
        and tally.results == expected > 0
        and not (tally.other or tally.tables or tally.again or tally.spoilt or tally.orphans),
        seconds=time.monotonic() - began,
    )


def _said(tally: _Tally, complained: str) -> str:
    """Return what a program that did not come through said last."""
    lines = complained.strip().splitlines()
    return f" ({lines[-1]})" if lines and tally.through < max(tally.suites, 1) else ""
