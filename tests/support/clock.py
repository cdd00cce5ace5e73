"""Time that passes when a test says so."""

import time
from collections.abc import Callable
from pathlib import Path

import pytest

from harness.execution import worker


class Clock:
    """The clock by which tasks are watched: it stands still, however busy the machine is."""

    def __init__(self) -> None:
        self.now = time.monotonic()

    def monotonic(self) -> float:
        """Return the time, s."""
        return self.now

    def sleep(self, seconds: float) -> None:
        """Sleep, while this clock stands still."""
        time.sleep(seconds)

    def run_until(self, done: Callable[[], bool], seconds: float) -> None:
        """Let so many seconds pass, again and again, until something is done."""
        while not done():
            self.now += seconds
            time.sleep(0.02)


def stop_clock(patch: pytest.MonkeyPatch) -> Clock:
    """Have tasks watched by a clock of the test's own, which is returned."""
    clock = Clock()
    patch.setattr(worker, "time", clock)
    patch.setattr(worker, "_listed", worker._listed)  # noqa: SLF001 - a list of another time's
    return clock


def wait_for(file: Path) -> None:
    """Wait until a file is there; two minutes are more than a busy machine takes."""
    until = time.monotonic() + 120.0
    while not file.exists():
        assert time.monotonic() < until, file
        time.sleep(0.01)
