"""The time that a case takes alone: serially, after a warm-up, several times over.

Processor time is what counts, since a clock also sees the other programs of the machine; both are
kept, and where they differ the machine was not alone. A lock on the machine keeps two programs that
time from running at once, and a worker started for timing alone has one thread for linear algebra.
The program takes the lock, not its worker, whose limits so are those of the work without the wait.
"""

import fcntl
import os
import tempfile
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from pathlib import Path
from typing import ParamSpec, TypeVar

from harness.core.case import Case
from harness.core.errors import BrokenEngineError
from harness.engines.reference.truth import solve_case
from harness.engines.registry import engine, is_ours
from harness.engines.stepping.horizon import natural_time
from harness.evaluation.evaluation import Record
from harness.execution.isolated_pool import local_executor
from harness.execution.limits import Limits, default_limits
from harness.execution.worker import LostTaskError
from models.scene import Horizon

P = ParamSpec("P")
T = TypeVar("T")

FEWEST = 3
"""Repeats of any case: a minimum and a median that differ."""

_MOST = 9
"""Repeats of a short one."""

_PATIENCE = 0.08
"""s by the clock, set-up included, after which the fewest repeats are enough."""

_WARM_STEPS, _WARM_SHARE = 200, 0.02
"""Timesteps of the warm-up, at most so many natural times: each branch of a step has been taken."""

_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")

LOCK = Path(tempfile.gettempdir()) / f"rockingcan-timing-{os.getuid()}.lock"
"""One for the machine and user, not one a folder: what is shared is the processor."""


def time_alone(case: Case) -> Record:
    """Return the times of repeated runs of a case, s; on what `one_thread` gives, they are alone.

    Parameters
    ----------
    case : Case
        What an engine of somebody else's raises leaves it untimed.

    Returns
    -------
    dict
        `cpu_s`, `wall_s`: a list each, of stepping only; `setup_s`: the shortest of compiling,
        parity and settling; None where the engine did not start.
    """
    try:
        return _timed(case)
    except BrokenEngineError:  # it cannot even be made here
        return untimed(case)
    except Exception:
        if is_ours(engine(case.engine)):
            raise
        return untimed(case)


def _timed(case: Case) -> Record:
    """Return the times of repeated runs of a case."""
    once = _work(case)
    _warm_up(case)
    cpu: list[float] = []
    wall: list[float] = []
    setup: list[float] = []
    started = time.perf_counter()
    while len(cpu) < FEWEST or (time.perf_counter() - started < _PATIENCE and len(cpu) < _MOST):
        taken = once()
        cpu.append(taken[0])
        wall.append(taken[1])
        setup.append(taken[2])
    return {"cpu_s": cpu, "wall_s": wall, "setup_s": min(setup)}


def untimed(case: Case, error: LostTaskError | None = None) -> Record:
    """Return the record of a case that could not be timed."""
    del case, error
    return {"cpu_s": [], "wall_s": [], "setup_s": None}


def _work(case: Case) -> Callable[[], tuple[float, float, float]]:
    """Return what runs the case once: processor time, clock time and setup, s."""
    if case.engine == "reference":

        def solve() -> tuple[float, float, float]:
            # the motion, known at every instant; sampling it for a comparison is no part of it
            wall, cpu = time.perf_counter(), time.process_time()
            solve_case(case)
            return time.process_time() - cpu, time.perf_counter() - wall, 0.0

        return solve
    chosen = engine(case.engine)

    def simulate() -> tuple[float, float, float]:
        found = chosen.simulate(case)
        return found.cpu_s, found.wall_s, found.setup_s

    return simulate


def _warm_up(case: Case) -> None:
    """Run the beginning of a case: the code is loaded, the caches know it."""
    timestep = engine(case.engine).timestep(case)
    longest = _WARM_SHARE * natural_time(case.scene)
    seconds = longest if timestep is None else min(longest, _WARM_STEPS * timestep)
    seconds = max(seconds, timestep or 0.0)
    _work(replace(case, scene=replace(case.scene, horizon=Horizon(seconds=seconds))))()


@contextmanager
def timing_lock() -> Iterator[None]:
    """Wait until nothing else on this machine times, and hold it while this does."""
    with LOCK.open("a") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        yield


class AloneExecutor(Executor):
    """Has one task after the other done, each while nothing else on this machine times.

    Parameters
    ----------
    executor : Executor
        Does them.
    """

    window = 1
    """How many tasks keep it busy."""

    def __init__(self, executor: Executor) -> None:
        self._executor = executor

    def submit(self, fn: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> "Future[T]":
        """Have a task done, once nothing else times; its exception, if any, is in the future."""
        held = ExitStack()
        held.enter_context(timing_lock())
        try:
            future = self._executor.submit(fn, *args, **kwargs)
        except BaseException:
            held.close()
            raise
        future.add_done_callback(lambda _: held.close())
        return future


@contextmanager
def single_thread_executor(limits: Limits | None = None) -> Iterator[Executor]:
    """Give an executor of one process that has one thread for linear algebra, and times alone.

    Parameters
    ----------
    limits : Limits, optional
        Of one run of a case; of the repeats together it is as much for each.
    """
    kept = {name: os.environ.get(name) for name in _THREADS}
    os.environ.update(dict.fromkeys(_THREADS, "1"))
    try:
        # two jobs would be two processes; a spawned one reads the environment when it starts
        usual = default_limits(1) if limits is None else limits
        whole = Limits(seconds=(1 + _MOST) * usual.seconds, memory=usual.memory)
        with local_executor(1, spawned=True, limits=whole) as executor:
            executor.submit(os.getpid).result()
            yield AloneExecutor(executor)
    finally:
        for name, value in kept.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value
