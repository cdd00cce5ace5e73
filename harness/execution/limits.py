"""How long a task may take and how much memory it may use.

How much memory there is for this program: the machine's, or what a container is given of it.
"""

import math
import os
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from harness.core.errors import InvalidSettingError

_ROOT = Path("/")


def available(root: Path = _ROOT) -> float:
    """Return the bytes of memory that this program and all that it starts may use.

    Parameters
    ----------
    root : Path
        Of the file system in which Linux tells of control groups.
    """
    machine = float(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES"))
    return min([machine, *_limits(root)])


def _limits(root: Path) -> Iterator[float]:
    """Yield the limits of the control groups that this process is in, of both versions of them."""
    with suppress(OSError):
        for line in (root / "proc/self/cgroup").read_text("utf-8").splitlines():
            number, kinds, group = line.split(":", 2)
            if number == "0" and not kinds:
                yield from _along(root / "sys/fs/cgroup", group, "memory.max")
            elif "memory" in kinds.split(","):
                yield from _along(root / "sys/fs/cgroup/memory", group, "memory.limit_in_bytes")


def _along(top: Path, group: str, file: str) -> Iterator[float]:
    """Yield the limits of a group and of all that it is in.

    In a container the group may be told as the host has it, while the container sees its own as the
    top; folders that are not there have no say.
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
    """What a worker is given for one task.

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
        """Refuse what nothing could run in."""
        if not self.seconds > 0.0:
            raise InvalidSettingError("time limit", self.seconds, "a positive number of seconds")
        if not self.memory > 0.0:
            raise InvalidSettingError("memory limit", self.memory, "a positive number of bytes")


NO_LIMITS = Limits()

LONGEST = 1800.0
"""s: no case of the full suite takes a tenth of it."""


def default_limits(workers: int) -> Limits:
    """Return limits for so many workers: a half hour each, and together not all of the memory.

    None is given less than a sound case needs. So of very many all could together take more than
    there is, if they all went to their limits; then the system ends one, and its case is done
    again.
    """
    share = _SHARE * available() / workers
    return Limits(seconds=LONGEST, memory=min(_MOST_MEMORY, max(_LEAST_MEMORY, share)))
