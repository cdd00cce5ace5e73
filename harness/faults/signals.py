"""Ctrl-C and SIGTERM in the middle of a command."""

import os
import signal
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

from harness.faults.ledger import broken, ledger
from harness.faults.processes import Program, begin, left_behind, living
from harness.faults.trial import Trial
from harness.store import Store
from harness.store.folder import JOURNAL

_WORDS = ("attribute", "gentle-rock", "--engine", "pybullet", "--jobs", "2")

_PROGRAM = "from harness.__main__ import main; main()"

_PATIENCE = 120.0
_PROMPT = 5.0
"""s in which a command has ended that was told to."""


def signals(folder: Path, told: Callable[[str], None]) -> Trial:
    """Stop a command as a terminal does, and as a scheduler does; then let it go on."""
    began = time.monotonic()
    parts, passed = [], True
    for number, whole in ((signal.SIGINT, True), (signal.SIGTERM, False), (signal.SIGTERM, True)):
        told(f"{number.name} to {'all processes' if whole else 'the command alone'}")
        words, good = _stopped(folder / f"{number.name}-{whole}", number, whole=whole)
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
    store = Store(folder=folder / "store")
    words = [*_WORDS, "--store", str(store.folder)]
    process = begin(_PROGRAM, words, folder, ())
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
    kept = sum(1 for _ in store.folder.glob("evaluations/??/*.json"))
    again = begin(_PROGRAM, words, folder, ())
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


def _wait_for_kept(store: Store, process: Program) -> None:
    """Wait until the first result is kept."""
    until = time.monotonic() + _PATIENCE
    journal = store.folder / JOURNAL
    while time.monotonic() < until and process.poll() is None:
        if journal.exists() and '"kept"' in journal.read_text(encoding="utf-8"):
            return
        time.sleep(0.01)
