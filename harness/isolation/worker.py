"""A worker as its owner sees it: started once, given one task at a time, watched."""

import math
import os
import signal
import subprocess
import sys
import time
from contextlib import suppress
from multiprocessing import Pipe
from pathlib import Path

from harness.isolation.limits import Limits
from harness.isolation.loss import LostTaskError, of_exit, of_memory, of_time
from harness.isolation.serving import READY

_TICK = 0.05
"""s between looks at a worker: at 3 GB/s it oversteps its memory by 0.15 GB meanwhile."""

_PAGE = os.sysconf("SC_PAGE_SIZE")

_PATIENCE = 120.0  # s: a machine that is busy starts Python and imports the engines in some seconds


class Worker:
    """A process that does tasks one after the other.

    Starting it takes a second or so, which no task's time counts.

    Parameters
    ----------
    limits : Limits
        Of each task.
    imports : tuple of str
        Modules that it imports at its start.
    """

    def __init__(self, limits: Limits, imports: tuple[str, ...] = ()) -> None:
        self._limits = limits
        self._mine, theirs = Pipe()
        program = (
            f"import sys; sys.path[:] = {sys.path!r}; "
            "from harness.isolation.serving import serve; "
            f"serve({theirs.fileno()}, {os.getpid()}, {imports!r})"
        )
        # not `multiprocessing`: what a daemon of a cluster may not start, and no guard in scripts
        self._process = subprocess.Popen(  # noqa: S603 - our own program
            [sys.executable, "-c", program], stdin=subprocess.DEVNULL, pass_fds=[theirs.fileno()]
        )
        theirs.close()
        self._ready = False

    def do(self, task: bytes) -> bytes:
        """Give a task, as bytes, and return the answer.

        Raises
        ------
        LostTaskError
            If the process dies over it, or is stopped for its limits; it is not to be used again.
        """
        if not self._ready:
            if self._answer(Limits(seconds=_PATIENCE)) != READY:
                raise of_exit(self.stop())
            self._ready = True
        try:
            self._mine.send_bytes(task)
        except OSError as error:
            raise of_exit(self.stop()) from error
        return self._answer(self._limits)

    def _answer(self, limits: Limits) -> bytes:
        """Wait for what the process sends, as long as it keeps to its limits."""
        started = time.monotonic()
        try:
            while not self._mine.poll(_TICK):
                lost = self._breach(limits, time.monotonic() - started)
                if lost is not None:
                    raise lost
            return self._mine.recv_bytes()
        except (EOFError, OSError) as error:
            raise of_exit(self._ended()) from error

    def _breach(self, limits: Limits, seconds: float) -> LostTaskError | None:
        """Stop the process if it is over a limit; return which, or that it died."""
        if self._process.poll() is not None:
            return of_exit(self._process.returncode)
        if seconds > limits.seconds:
            self.stop()
            return of_time(limits.seconds)
        if not math.isinf(limits.memory) and self._resident() > limits.memory:
            self.stop()
            return of_memory(limits.memory)
        return None

    def _resident(self) -> int:
        """Return the bytes of memory that the process uses; zero where the system does not tell."""
        try:
            told = Path(f"/proc/{self._process.pid}/statm").read_text(encoding="ascii")
        except OSError:
            return 0
        return int(told.split()[1]) * _PAGE

    def _ended(self) -> int:
        """Return the exit code of a process whose connection is gone."""
        with suppress(subprocess.TimeoutExpired):
            return self._process.wait(timeout=1.0)
        return self.stop()

    def stop(self) -> int:
        """End the process at once, and return its exit code."""
        if self._process.poll() is None:
            with suppress(ProcessLookupError):
                self._process.send_signal(signal.SIGKILL)
        return self._process.wait()

    def close(self) -> None:
        """End an idle process."""
        self.stop()
        self._mine.close()
