"""A worker and what it started: weighed together, and ended together.

A worker leads a process group of its own, which its children are in unless they leave it; those
that left are known by their parents. Linux lists both; elsewhere the worker and its group alone are
ended. What left the group and whose parent has ended is not known here: it outlives the worker.
"""

import os
import signal
import threading
import time
from contextlib import suppress
from pathlib import Path

_PROCESSES = Path("/proc")

_PAGE = os.sysconf("SC_PAGE_SIZE")

_FRESH = 0.5
"""s for which a list of all processes is used again: making one takes some milliseconds."""

_Relations = dict[int, tuple[int, int]]
"""Parent and group of each process."""


class _Listing:
    """The list of all processes, one for all threads that ask."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._read = -_FRESH
        self._found: _Relations = {}

    def no_older(self, seconds: float) -> _Relations:
        """Return a list that was made at most so long ago."""
        with self._lock:
            if time.monotonic() - self._read >= seconds:
                self._found = _relations()
                self._read = time.monotonic()
            return self._found


_listing = _Listing()


def used(leader: int, limit: float) -> int:
    """Return the bytes of memory that a worker and what it started use; zero if it is not known.

    What they share is counted once, which takes longer to find out: only where the simple sum of
    what is resident exceeds the limit.
    """
    own = _resident(leader)
    others = _family(leader, _FRESH) - {leader}
    simple = own + sum(map(_resident, others))
    if not others or simple <= limit:
        return simple
    return sum(map(_share, {leader} | others))


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
    relations = _listing.no_older(age)
    found = {process for process, (_, group) in relations.items() if group == leader}
    new = found | {leader}
    while new:
        new = {process for process, (parent, _) in relations.items() if parent in new} - found
        found |= new
    return found


def _relations() -> _Relations:
    """Return parent and group of every process, as the system lists them.

    A program that has no file left to open reads nothing; it ends a worker and its group even so.
    """
    found = {}
    with suppress(OSError):
        for place in _PROCESSES.glob("[0-9]*"):
            with suppress(OSError):  # it has gone meanwhile
                # after the name, which may hold anything: state, parent, group
                words = (place / "stat").read_text("utf-8", "replace").rpartition(")")[2].split()
                found[int(place.name)] = int(words[1]), int(words[2])
    return found


def _resident(process: int) -> int:
    """Return the bytes that a process has in memory; zero if it is gone."""
    with suppress(OSError):
        told = (_PROCESSES / str(process) / "statm").read_text("ascii")
        return int(told.split()[1]) * _PAGE
    return 0


def _share(process: int) -> int:
    """Return the bytes that a process has in memory, of what it shares with others its part."""
    with suppress(OSError):
        told = (_PROCESSES / str(process) / "smaps_rollup").read_text("ascii", "replace")
        for line in told.splitlines():
            if line.startswith("Pss:"):
                return int(line.split()[1]) * 1024
    return _resident(process)
