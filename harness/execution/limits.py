"""Limits of time and memory of a task, and the memory of the machine or of its container."""

import math
import os
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from harness.core.errors import InvalidSettingError

_ROOT = Path("/")


def available(root: Path = _ROOT) -> float:
    """Return the bytes of memory that this program and its processes may use.

    Parameters
    ----------
    root : Path
        Of the file system in which Linux describes control groups.
    """
    machine = float(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES"))
    return min([machine, *_limits(root)])


def _limits(root: Path) -> Iterator[float]:
    """Yield the limits of the control groups of this process, of version 1 and 2."""
    with suppress(OSError):
        for line in (root / "proc/self/cgroup").read_text("utf-8").splitlines():
            number, kinds, group = line.split(":", 2)
            if number == "0" and not kinds:
                yield from _along(root / "sys/fs/cgroup", group, "memory.max")
            elif "memory" in kinds.split(","):
                yield from _along(root / "sys/fs/cgroup/memory", group, "memory.limit_in_bytes")


def _along(top: Path, group: str, file: str) -> Iterator[float]:
    """Yield the limits of a group and of its ancestors.

    In a container the path of the group may be that of the host, while the folders are those of the
    container; paths that do not exist are skipped.
    """
    inside = Path(group.lstrip("/"))
    for part in (inside, *inside.parents):
        # where there is no limit, version 2 says "max", and version 1 a number beyond any memory
        with suppress(OSError, ValueError):
            yield float((top / part / file).read_text("ascii"))


_MOST_MEMORY = 4 * 2**30
_LEAST_MEMORY = 0.5 * 2**30
"""An engine and the reference use 0.2 GiB."""

_SHARE = 0.8  # of all memory, for all workers together


@dataclass(frozen=True, slots=True, kw_only=True)
class Limits:
    """Limits of a task.

    Parameters
    ----------
    seconds : float
        By the clock, from when the worker has the task; infinite for no limit.
    memory : float
        Bytes of resident memory of the worker and of what it started, as the system's own
        out-of-memory killer weighs it; infinite for no limit. Address space is no measure:
        numerical libraries reserve far more than they use.

    Raises
    ------
    InvalidSettingError
        If a limit is not positive.
    """

    seconds: float = math.inf
    memory: float = math.inf

    def __post_init__(self) -> None:
        """Refuse limits in which nothing could run."""
        if not self.seconds > 0.0:
            raise InvalidSettingError("time limit", self.seconds, "a positive number of seconds")
        if not self.memory > 0.0:
            raise InvalidSettingError("memory limit", self.memory, "a positive number of bytes")


NO_LIMITS = Limits()

LONGEST = 1800.0
"""s: no case of the full suite takes a tenth of it."""


def default_limits(workers: int) -> Limits:
    """Return limits for each of so many workers: half an hour, and a share of the memory.

    No worker is given less than a sound case needs, so very many workers at their limits could
    exceed the memory; then the system ends one of them, and its case is run again.
    """
    share = _SHARE * available() / workers
    return Limits(seconds=LONGEST, memory=min(_MOST_MEMORY, max(_LEAST_MEMORY, share)))
