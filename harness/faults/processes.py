"""Processes of a group, as the system lists them: none may outlive its program."""

import os
import signal
import subprocess
import time
from contextlib import suppress
from pathlib import Path

_PATIENCE = 5.0
"""s in which processes that were told to end are gone, on a machine that is busy."""

_DEAD = frozenset("ZX")


def living(group: int) -> list[int]:
    """Return the processes of a group that run, from Linux's list of them."""
    found = []
    for place in Path("/proc").glob("[0-9]*"):
        with suppress(OSError):
            # after the name, which may hold anything: state, parent, group
            words = (place / "stat").read_text(encoding="utf-8").rpartition(")")[2].split()
            if int(words[2]) == group and words[0] not in _DEAD:
                found.append(int(place.name))
    return found


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
        os.killpg(process.pid, signal.SIGKILL)
        process.communicate()
        return True
    return False
