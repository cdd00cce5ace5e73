"""Processes of a session, as the system lists them: none may outlive its program."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

Program = subprocess.Popen[str]

_begun: list[subprocess.Popen[str]] = []

_PATIENCE = 5.0
"""s in which processes that were told to end are gone, on a machine that is busy."""

_DEAD = frozenset("ZX")


def begin(program: str, words: Sequence[str], folder: Path, paths: Sequence[str]) -> Program:
    """Start a program of Python as the leader of a process group of its own.

    Parameters
    ----------
    program : str
    words : sequence of str
        Its arguments.
    folder : Path
        Where it runs.
    paths : sequence of str
        Where it looks for packages first; then where this program does.
    """
    found = [*paths, *(path for path in sys.path if path)]
    process = subprocess.Popen(  # noqa: S603 - our own program
        [sys.executable, "-c", program, *words],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": os.pathsep.join(found)},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    _begun.append(process)
    return process


def end_all() -> None:
    """Kill what was begun and still runs, with all its processes: a trial was interrupted."""
    for process in _begun:
        if process.poll() is None:
            with suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
            process.communicate()
    _begun.clear()


def living(group: int) -> list[int]:
    """Return the processes of a session that run, from Linux's list of them.

    A program that `begin` started leads a group and a session; workers leave the group.
    """
    found = []
    for place in Path("/proc").glob("[0-9]*"):
        with suppress(OSError):
            # after the name, which may hold anything: state, parent, group, session
            words = (place / "stat").read_text(encoding="utf-8").rpartition(")")[2].split()
            if int(words[3]) == group and words[0] not in _DEAD:
                found.append(int(place.name))
    return found


def resident(group: int) -> int:
    """Return the bytes that the processes of a group hold in memory, shared ones each time.

    A child with exactly its parent's sizes is between fork and exec: its memory is its parent's.
    """
    sizes, parents = {}, {}
    for process in living(group):
        place = Path("/proc", str(process))
        with suppress(OSError):  # it has gone meanwhile
            sizes[process] = (place / "statm").read_text(encoding="utf-8")
            words = (place / "stat").read_text(encoding="utf-8").rpartition(")")[2].split()
            parents[process] = int(words[1])
    own = [s for process, s in sizes.items() if sizes.get(parents.get(process, 0)) != s]
    return sum(int(size.split()[1]) for size in own) * os.sysconf("SC_PAGE_SIZE")


def left_behind(group: int) -> int:
    """Return how many processes of a group still run some seconds after their program has ended."""
    until = time.monotonic() + _PATIENCE
    while (left := living(group)) and time.monotonic() < until:
        time.sleep(0.05)
    for process in left:
        with suppress(ProcessLookupError):
            os.kill(process, signal.SIGKILL)
    return len(left)


def killed_after(process: subprocess.Popen[str], seconds: float) -> bool:
    """Kill a program and all its processes after so many seconds; return False if it had ended."""
    try:
        process.communicate(timeout=seconds)
    except subprocess.TimeoutExpired:
        for each in (process.pid, *living(process.pid)):  # workers lead groups of their own
            with suppress(ProcessLookupError):
                os.kill(each, signal.SIGKILL)
        process.communicate()
        return True
    return False
