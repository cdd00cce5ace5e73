"""A worker and what it started: weighed together, and ended together.

A worker leads a process group of its own, which its children are in unless they leave it; those
that left are known by their parents. What left the group and whose parent has ended is not known
here: it outlives the worker.
"""

import os
import signal
import threading
import time
from contextlib import suppress

import psutil

_FRESH = 0.5
"""s for which a list of all processes is used again: making one takes some milliseconds."""

_Relations = dict[int, tuple[int, int]]
"""Parent and group of each process."""

_lock = threading.Lock()
_listed: tuple[float, _Relations] = (-_FRESH, {})


def used(leader: int, limit: float) -> int:
    """Return the bytes of memory that a worker and what it started use; zero if it is not known.

    What they share is counted once, which takes longer to find out: only where the simple sum of
    what is resident exceeds the limit.
    """
    own = _memory(leader)
    others = _family(leader, _FRESH) - {leader}
    simple = own + sum(map(_memory, others))
    if not others or simple <= limit:
        return simple
    return sum(_memory(process, share=True) for process in {leader} | others)


def end(leader: int) -> None:
    """Kill a worker that was not waited for yet, so that its number is still its own; and its own.

    One that has ended by itself may have left others in its group, and one that runs may have
    left the group itself.
    """
    strays = _family(leader, 0.0) - {leader}
    with suppress(ProcessLookupError, PermissionError):
        os.killpg(leader, signal.SIGKILL)
    for process in (leader, *strays):
        with suppress(ProcessLookupError, PermissionError):
            os.kill(process, signal.SIGKILL)


def _family(leader: int, age: float) -> set[int]:
    """Return who is in the group that a process leads, or descends from one who is."""
    relations = _relations(age)
    found = {process for process, (_, group) in relations.items() if group == leader}
    new = found | {leader}
    while new:
        new = {process for process, (parent, _) in relations.items() if parent in new} - found
        found |= new
    return found


def _relations(age: float) -> _Relations:
    """Return parent and group of every process, as they were at most `age` seconds ago.

    A program that has no file left to open reads nothing; it ends a worker and its group even so.
    """
    global _listed  # noqa: PLW0603 - one list for all threads that ask
    with _lock:
        if time.monotonic() - _listed[0] >= age:
            found = {}
            with suppress(OSError, psutil.Error):
                for process in psutil.process_iter():
                    with suppress(OSError, psutil.Error):  # it has gone meanwhile
                        found[process.pid] = process.ppid(), os.getpgid(process.pid)
            _listed = time.monotonic(), found
        return _listed[1]


def _memory(process: int, *, share: bool = False) -> int:
    """Return the bytes that a process has in memory, or its share of them; zero if it is gone."""
    with suppress(OSError, psutil.Error):
        known = psutil.Process(process)
        if share:
            with suppress(OSError, psutil.Error, AttributeError):  # where it is not to be known
                return int(known.memory_full_info().pss)
        return int(known.memory_info().rss)
    return 0
