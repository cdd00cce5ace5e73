"""How much memory there is for this program: the machine's, or what a container is given of it."""

import os
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

_ROOT = Path("/")


def available(root: Path = _ROOT) -> float:
    """Return the bytes of memory that this program and all that it starts may use.

    Parameters
    ----------
    root : Path
        Of the file system in which Linux tells of control groups.
    """
    whole = float(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES"))
    return min([whole, *_limits(root)])


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
