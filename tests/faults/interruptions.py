"""Kill -9 of the whole suite, at random moments, until it has come through nevertheless.

Ctrl-C and SIGTERM in the middle of a command.

A disk that is full while results are written: a message, nothing broken, and on it goes.
"""

import os
import random
import resource
import shutil
import signal
import subprocess
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from pathlib import Path

from harness.execution.cache import JOURNAL, CacheFolder
from tests.faults.journal_check import broken, differing, differing_tables, ledger, whole
from tests.faults.programs import (
    ENGINES,
    Program,
    ProgramRun,
    begin,
    killed_after,
    left_behind,
    living,
    started,
)
from tests.faults.trial import Trial

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
    def store(self) -> CacheFolder:
        return CacheFolder(folder=self.folder / "store")

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


_WORDS = ("attribute", "gentle-rock", "--engine", ENGINES[-1], "--jobs", "2")

_SIGNALS_PROGRAM = "from harness.__main__ import main; main()"

_PATIENCE = 120.0
_PROMPT = 5.0
"""s in which a command has ended that was told to."""


def signals(folder: Path, told: Callable[[str], None]) -> Trial:
    """Stop a command as a terminal does, and as a scheduler does; then let it go on."""
    began = time.monotonic()
    parts, passed = [], True
    for number, to_all in ((signal.SIGINT, True), (signal.SIGTERM, False), (signal.SIGTERM, True)):
        told(f"{number.name} to {'all processes' if to_all else 'the command alone'}")
        words, good = _stopped(folder / f"{number.name}-{to_all}", number, whole=to_all)
        parts.append(words)
        passed = passed and good
    return Trial(
        name="signals",
        done="Ctrl-C to the whole command, SIGTERM to it alone and to all of it, once the first "
        "result was kept; then the command that it prints",
        demanded="130 and 143 within seconds; no process left; what is done and how to go on; the "
        "second run does the rest",
        found=tuple(parts),
        passed=passed,
        seconds=time.monotonic() - began,
    )


def _stopped(folder: Path, number: signal.Signals, *, whole: bool) -> tuple[str, bool]:
    """Stop a command with a signal; return what came of it, and whether it is as it must be."""
    folder.mkdir(parents=True)
    store = CacheFolder(folder=folder / "store")
    words = [*_WORDS, "--store", str(store.folder)]
    process = begin(_SIGNALS_PROGRAM, words, folder, ())
    _wait_for_kept(store, process)
    asked = time.monotonic()
    if whole:
        for each in living(process.pid):
            with suppress(ProcessLookupError):  # the command may end its workers meanwhile
                os.kill(each, number)
    else:
        process.send_signal(number)
    _, complained = process.communicate(timeout=_PATIENCE)
    seconds = time.monotonic() - asked
    orphans = left_behind(process.pid)
    kept = sum(1 for _ in store.folder.glob("evaluations/??/*.result"))
    again = begin(_SIGNALS_PROGRAM, words, folder, ())
    _, said = again.communicate(timeout=_PATIENCE)
    book = ledger(store)
    resume = f"To go on: rockingcan {' '.join(words)}"
    good = (
        process.returncode == 128 + number
        and seconds < _PROMPT
        and not orphans
        and resume in complained
        and "are done and kept" in complained
        and again.returncode == 0
        and f"{kept} of {book.tasks} already in the store" in said
        and not book.again
        and not broken(store)
    )
    to = "all processes" if whole else "the command alone"
    text = (
        f"{number.name} to {to}: code {process.returncode} after {seconds:.1f} s, {kept} kept, "
        f"{orphans} processes left; second run: code {again.returncode}, {book.again} kept ones "
        "run again"
    )
    return text, good


def _wait_for_kept(store: CacheFolder, process: Program) -> None:
    """Wait until the first result is kept."""
    until = time.monotonic() + _PATIENCE
    journal = store.folder / JOURNAL
    while time.monotonic() < until and process.poll() is None:
        if journal.exists() and '"kept"' in journal.read_text(encoding="utf-8"):
            return
        time.sleep(0.01)


_SMALL, _LARGE = "900k", "64m"

_FILE = 2**19
"""Bytes of the largest file that may be written, where no file system can be mounted."""

_CASES = tuple(
    ("gentle-rock", engine, "matched", timestep)
    for engine in ENGINES
    for timestep in (1e-3, 3e-4, 1e-4, 3e-5)
)

_WRONG = 2


def disk(folder: Path, told: Callable[[str], None]) -> Trial:
    """Fill the disk under a running suite; then make room and start it again."""
    began = time.monotonic()
    told("a disk that is full")
    order = ProgramRun(store=str(folder / "roomy"), cases=_CASES)
    started(order).communicate()
    place = folder / "small"
    with _small(place) as (how, widen):
        store = CacheFolder(folder=place / "store")
        full = started(replace(order, store=str(store.folder)))
        _, complained = full.communicate()
        sound, spoilt = whole(store), broken(store)
        widen()
        again = started(replace(order, store=str(store.folder)))
        again.communicate()
        book = ledger(store)
        other = differing(store, CacheFolder(folder=Path(order.store)))
        spoilt += broken(store)
    clear = complained.startswith("cannot write to the store") and "make room" in complained
    return Trial(
        name="disk full",
        done=f"a suite on {how}; then room made, and the suite started again",
        demanded="a clear message and code 2; nothing broken; the second run does the rest",
        found=(
            f"code {full.returncode}, with this on standard error: {_last(complained, store)}",
            f"{sound} of {len(_CASES)} kept, {spoilt} broken",
            f"second run: code {again.returncode}, {book.again} kept ones run again",
            f"{other} results differ from an undisturbed run",
        ),
        passed=clear
        and (full.returncode, again.returncode) == (_WRONG, 0)
        and 0 < sound < len(_CASES)
        and not (spoilt or other or book.again),
        seconds=time.monotonic() - began,
    )


def _last(said: str, store: CacheFolder) -> str:
    """Return the last line of what was said, the folder of the store left out."""
    lines = said.strip().splitlines() or ["nothing"]
    return lines[-1].replace(str(store.folder), "STORE")


@contextmanager
def _small(place: Path) -> Iterator[tuple[str, Callable[[], None]]]:
    """Give what has little room, in words, and what makes more of it."""
    place.mkdir(parents=True)
    if os.geteuid() == 0 and _mounted(place):
        try:
            yield (
                f"a file system of {_SMALL}B",
                lambda: _mount("-o", f"remount,size={_LARGE}", str(place)),
            )
        finally:
            umount = shutil.which("umount") or "umount"
            subprocess.run([umount, "--lazy", str(place)], check=False)  # noqa: S603 - our words
        return
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (_FILE, before[1]))
    try:
        yield (
            f"a disk that takes no file above {_FILE // 1024} KiB",
            lambda: resource.setrlimit(resource.RLIMIT_FSIZE, before),
        )
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


def _mounted(place: Path) -> bool:
    """Mount a small file system, if that is allowed here."""
    try:
        _mount("-t", "tmpfs", "-o", f"size={_SMALL}", "tmpfs", str(place))
    except (OSError, subprocess.CalledProcessError):
        return False
    return True


def _mount(*words: str) -> None:
    mount = shutil.which("mount") or "mount"
    subprocess.run([mount, *words], check=True, capture_output=True)  # noqa: S603 - our words
