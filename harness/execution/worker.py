"""A worker process seen from its owner: started once, given a task at a time, watched, ended.

The memory of processes that a worker started counts as its own, and they end with it. A worker
leads a process group, in which its children are unless they leave it; those that left are known by
their parents. A process that left the group and whose parent has ended outlives the worker.
"""

import math
import os
import signal
import subprocess
import sys
import threading
import time
from concurrent.futures import BrokenExecutor
from contextlib import suppress
from dataclasses import replace
from enum import Enum
from multiprocessing import Pipe
from typing import TYPE_CHECKING

import psutil

from harness.core.environments import Environment, this_environment
from harness.execution.limits import Limits
from harness.execution.source_fingerprint import OUR_PACKAGES, ROOT, sources_fingerprint
from harness.execution.worker_main import COMPILED, COMPILING, READY, compiling

if TYPE_CHECKING:
    from collections.abc import Callable


class Loss(Enum):
    """Why a task has no result; the outcome of a case that was lost has the same name."""

    CRASHED = "its process died"
    HUNG = "it took longer than it may"
    OUT_OF_MEMORY = "it used more memory than it may"
    STOPPED = "its process was stopped from outside"


class LostTaskError(BrokenExecutor):
    """A task has no result, because its process died or had to be stopped.

    Parameters
    ----------
    loss : Loss
    reason : str
        What happened, in a sentence.
    """

    def __init__(self, loss: Loss, reason: str) -> None:
        super().__init__(loss, reason)
        self.loss = loss
        self.reason = reason

    def __str__(self) -> str:
        """Return the sentence."""
        return self.reason


class WorkerStartError(LostTaskError):
    """The interpreter of an environment is there, and no worker of this program."""

    def __init__(self, reason: str) -> None:
        super().__init__(Loss.STOPPED, reason)
        self.args = (reason,)


class OtherSourcesError(WorkerStartError):
    """A worker is of another version of the program than its owner; the reason is both."""


_FAULTS = {
    signal.SIGSEGV: "segmentation fault",
    signal.SIGBUS: "bus error",
    signal.SIGABRT: "abort",
    signal.SIGILL: "illegal instruction",
    signal.SIGFPE: "arithmetic fault",
}


def loss_of_exit(code: int) -> LostTaskError:
    """Return the loss of a worker that died by itself, from its exit code of `subprocess`."""
    if code >= 0:
        return LostTaskError(Loss.CRASHED, f"killed: the engine left its process with code {code}")
    known = {number.value: number for number in signal.Signals}.get(-code)
    name = f"signal {-code}" if known is None else known.name
    if known is not None and known in _FAULTS:
        return LostTaskError(Loss.CRASHED, f"killed: {name}, {_FAULTS[known]}")
    more = ", as the system does when its memory runs out" if known is signal.SIGKILL else ""
    return LostTaskError(Loss.STOPPED, f"killed: {name} from outside{more}")


def run_stopped() -> LostTaskError:
    """Return the loss of a worker that was ended because the run was stopped."""
    return LostTaskError(Loss.STOPPED, "killed: the run was stopped")


_TICK = 0.05
"""s between looks at a worker: at 3 GB/s it oversteps its memory by 0.15 GB meanwhile."""

_PARTING = 1.0
"""s for a process to end whose connection is closed."""

_LONGEST_COMPILATION = 1800.0
"""s: no engine takes a tenth of it, on a machine that is busy too."""

_LOOK = os.WEXITED | os.WNOHANG | os.WNOWAIT

_PATIENCE = 120.0  # s: a machine that is busy starts Python and imports the engines in some seconds

_PROGRAM = """\
import sys
from importlib.machinery import PathFinder
from multiprocessing.connection import Connection
class Running:
    @staticmethod
    def find_spec(name, path=None, target=None):
        return PathFinder.find_spec(name, [{root!r}]) if name in {packages!r} else None
sys.meta_path.insert(0, Running)
if {paths!r}:
    sys.path[:] = {paths!r}
try:
    from harness.execution.worker_main import serve
except BaseException as error:
    Connection({handle}).send_bytes(f"{{type(error).__name__}}: {{error}}".encode())
    sys.exit()
serve({handle}, {owner}, {imports!r}, {environment!r})
"""
"""The program of a worker: its packages of this project are those that run here, from where they
are, whatever its interpreter has under their names."""


class Worker:
    """A process that runs tasks one after the other.

    Starting it takes a second or so, which does not count as time of a task. Processes that a task
    starts share its memory limit and end with it, as far as `_family` knows them, when this program
    ends the worker. When this program is killed, Linux ends the worker, but not what it started.

    Parameters
    ----------
    limits : Limits
        Of each task.
    imports : tuple of str
        Modules that it imports at its start.
    environment : Environment, optional
        In whose interpreter it runs; in this one if left out.

    Raises
    ------
    OSError
        If the system has no process, memory or file left to start it with, or the interpreter is
        not there.
    """

    def __init__(
        self,
        limits: Limits,
        imports: tuple[str, ...] = (),
        environment: Environment | None = None,
    ) -> None:
        self._limits = limits
        self.on_compiling: Callable[[str], object] = lambda _: None
        """Called with the name of an engine that begins to compile itself."""
        self._elsewhere = environment is not None
        self._mine, theirs = Pipe()
        own = this_environment() if environment is None else environment
        program = _PROGRAM.format(
            root=str(ROOT),
            packages=OUR_PACKAGES,
            paths=[] if self._elsewhere else sys.path,
            handle=theirs.fileno(),
            owner=os.getpid(),
            imports=imports,
            environment="" if own is None else own.to_json(),
        )
        # apart from this interpreter's packages, which the variables of Python may lead to
        words = [sys.executable] if environment is None else [environment.interpreter, "-I"]
        # not `multiprocessing`: what a daemon of a cluster may not start, and no guard in scripts
        try:
            self._process = subprocess.Popen(  # noqa: S603 - our own program
                [*words, "-c", program],
                stdin=subprocess.DEVNULL,
                pass_fds=[theirs.fileno()],
                process_group=0,
            )
        except OSError:
            self._mine.close()
            raise
        finally:
            theirs.close()
        self._ready = False
        self._stopped = False
        self._ending = threading.Lock()

    def do(self, task: bytes) -> bytes:
        """Send a task, as bytes, and return the answer.

        Raises
        ------
        LostTaskError
            If the process dies or is stopped for its limits; the worker cannot be used again.
        """
        if not self._ready:
            self._start(self._answer(Limits(seconds=_PATIENCE)))
        try:
            self._mine.send_bytes(task)
        except OSError as error:
            raise self._connection_lost() from error
        return self._answer(self._limits)

    def _start(self, said: bytes) -> None:
        """Take the first words of the process: that it is ready, and from which sources."""
        word, _, sources = said.partition(b" ")
        if word != READY:
            self.stop()
            raise WorkerStartError(said.decode(errors="replace"))
        # the sources may have been edited while this program runs
        if self._elsewhere and sources.decode() != sources_fingerprint():
            self.stop()
            raise OtherSourcesError(f"{sources.decode()}, and here {sources_fingerprint()}")
        self._ready = True

    def _answer(self, limits: Limits) -> bytes:
        """Wait for the answer of the process, as long as it keeps its limits.

        While an engine compiles itself the clock of the task stands, and another runs. So does that
        of the task of this process, if it is a worker itself: the engine is in an environment then.
        """
        spent = 0.0
        while True:
            said, seconds = self._words(limits, spent)
            if said.startswith(COMPILING):
                spent = seconds
                engine = said.removeprefix(COMPILING).decode()
                self.on_compiling(engine)
                with compiling(engine):
                    said, _ = self._words(replace(limits, seconds=_LONGEST_COMPILATION), 0.0)
            if said != COMPILED:
                return said

    def _words(self, limits: Limits, spent: float) -> tuple[bytes, float]:
        """Wait for what the process says next; return it, and the seconds spent until then."""
        started = time.monotonic() - spent
        try:
            while not self._mine.poll(_TICK):
                lost = self._over_limit(limits, time.monotonic() - started)
                if lost is not None:
                    raise lost
            return self._mine.recv_bytes(), time.monotonic() - started
        except (EOFError, OSError) as error:
            raise self._connection_lost() from error

    def _over_limit(self, limits: Limits, seconds: float) -> LostTaskError | None:
        """Stop the process if it exceeds a limit; return the loss, also if it died."""
        if self._has_ended() and not self._mine.poll():
            return self._connection_lost()
        if seconds > limits.seconds:
            self.stop()
            reason = f"killed: it ran longer than the {limits.seconds:g} s allowed"
            return LostTaskError(Loss.HUNG, reason)
        used = 0 if math.isinf(limits.memory) else memory_used(self._process.pid, limits.memory)
        if used > limits.memory:
            self.stop()
            reason = f"killed: it used more than the {limits.memory / 2**30:.3g} GiB allowed"
            return LostTaskError(Loss.OUT_OF_MEMORY, reason)
        return None

    def _connection_lost(self) -> LostTaskError:
        """End a process that no longer answers, and return the loss."""
        until = time.monotonic() + _PARTING
        while not self._has_ended() and time.monotonic() < until:
            time.sleep(_PARTING / 100.0)
        closed = not self._has_ended()
        code = self.stop()
        if closed:
            reason = "killed: the engine closed its process's connection to the run"
            return LostTaskError(Loss.CRASHED, reason)
        return run_stopped() if self._stopped else loss_of_exit(code)

    def _has_ended(self) -> bool:
        """Whether the process has ended; it is not waited for, and so keeps its number."""
        try:
            return os.waitid(os.P_PID, self._process.pid, _LOOK) is not None
        except ChildProcessError:  # it was waited for
            return True

    def stop(self) -> int:
        """End the process at once, and what it started; return its exit code."""
        with self._ending:
            if self._process.returncode is None:
                self._stopped = not self._has_ended()
                end_tree(self._process.pid)
            return self._process.wait()

    def close(self) -> None:
        """End an idle process."""
        self.stop()
        self._mine.close()


_FRESH = 0.5
"""s for which a list of all processes is used again: listing them takes some milliseconds."""

_Relations = dict[int, tuple[int, int]]
"""Parent and group of each process."""

_lock = threading.Lock()
_listed: tuple[float, _Relations] = (-_FRESH, {})


def memory_used(leader: int, limit: float) -> int:
    """Return the bytes of memory of a worker and the processes it started; zero if unknown.

    Shared memory is counted once, which takes longer to measure: only where the simple sum of the
    resident memory exceeds the limit.
    """
    leading = _memory(leader)
    others = _family(leader, _FRESH) - {leader}
    simple = leading + sum(map(_memory, others))
    if not others or simple <= limit:
        return simple
    return sum(_memory(process, share=True) for process in {leader} | others)


def end_tree(leader: int) -> None:
    """Kill a worker and the processes it started, before the worker is waited for.

    Until then its number is its own. A worker that has ended by itself may have left others in its
    group, and one that runs may have left the group itself.
    """
    strays = _family(leader, 0.0) - {leader}
    with suppress(ProcessLookupError, PermissionError):
        os.killpg(leader, signal.SIGKILL)
    for process in (leader, *strays):
        with suppress(ProcessLookupError, PermissionError):
            os.kill(process, signal.SIGKILL)


def _family(leader: int, age: float) -> set[int]:
    """Return the members of the group that a process leads, and all their descendants."""
    relations = _relations(age)
    members = {process for process, (_, group) in relations.items() if group == leader}
    new = members | {leader}
    while new:
        new = {process for process, (parent, _) in relations.items() if parent in new} - members
        members |= new
    return members


def _relations(age: float) -> _Relations:
    """Return parent and group of every process, as they were at most `age` seconds ago.

    A program without free file descriptors lists nothing, and can still end a worker and its group.
    """
    global _listed  # noqa: PLW0603 - one list for all threads that ask
    with _lock:
        if time.monotonic() - _listed[0] >= age:
            relations = {}
            with suppress(OSError):
                # names alone: of paths a listing takes three times as long
                for process in filter(str.isdecimal, os.listdir(_PROCESSES)):  # noqa: PTH208
                    with suppress(OSError):  # it has gone meanwhile
                        # after the name, which may hold anything: state, parent, group
                        told = _told(process, "stat").rpartition(b")")[2].split(maxsplit=3)
                        relations[int(process)] = int(told[1]), int(told[2])
            _listed = time.monotonic(), relations
        return _listed[1]


_PROCESSES = "/proc"
_PAGE = os.sysconf("SC_PAGE_SIZE")


def _told(process: int | str, what: str) -> bytes:
    """Return what the system tells of a process: a tenth of the time that psutil takes.

    Raises
    ------
    OSError
        If the process is gone.
    """
    file = os.open(f"{_PROCESSES}/{process}/{what}", os.O_RDONLY)
    try:
        return os.read(file, 4096)  # they are some hundred bytes
    finally:
        os.close(file)


def _memory(process: int, *, share: bool = False) -> int:
    """Return the bytes that a process has in memory, or its share of them; zero if it is gone."""
    if share:
        with suppress(OSError, psutil.Error, AttributeError):  # where it is not to be known
            return int(psutil.Process(process).memory_full_info().pss)
    with suppress(OSError):
        return int(_told(process, "statm").split()[1]) * _PAGE
    return 0
