"""Time of a case that runs alone, and the overhead of a step with nothing to solve.

A case is timed serially, after a warm-up, several times over. Processor time counts, since a clock
also sees the other programs of the machine; both are recorded, and where they differ another
program ran at the same time. A lock of the machine prevents two timings at once, and a worker
started for timing alone has one thread for linear algebra. The program takes the lock, not its
worker, so that the limits of the worker hold for the work without the wait.

The overhead of a step is that of one free body aloft, without contact, stepped in a loop of Python
and in the engine's own loop where it has one. The difference is the cost of the language and not of
the engine; a comparison of engines at small scenes measures mostly that difference.
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

import numpy as np

from harness.core.case import Case
from harness.core.errors import BrokenEngineError
from harness.engines.base import features_of
from harness.engines.ladder import takes_timestep
from harness.engines.reference.truth import solve_case
from harness.engines.registry import engine, is_ours
from harness.engines.remote import call_at_engine
from harness.engines.stepping.horizon import natural_time
from harness.engines.stepping.schedule import Fixed
from harness.engines.stepping.settling import above_origin, moving
from harness.engines.world import World
from harness.evaluation.evaluation import Record
from harness.execution.isolated_pool import local_executor
from harness.execution.limits import Limits, default_limits
from harness.execution.worker import LostTaskError
from models.scene import Horizon, Scene

P = ParamSpec("P")
T = TypeVar("T")

FEWEST = 3
"""Repeats of any case: a minimum and a median that differ."""

_MOST = 9
"""Repeats of a short one."""

PATIENCE = 0.08
"""s by the clock, set-up included, after which the fewest repeats are enough."""

_WARM_STEPS, _WARM_SHARE = 200, 0.02
"""Timesteps of the warm-up, at most so many natural times: each branch of a step has been taken."""

_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


def time_alone(case: Case) -> Record:
    """Return the times of repeated runs of a case, s; on `single_thread_executor` it runs alone.

    Parameters
    ----------
    case : Case
        An exception of another project's engine leaves it untimed.

    Returns
    -------
    dict
        `cpu_s`, `wall_s`: a list each, of stepping only; `setup_s`: the shortest of compiling,
        parity and settling; None where the engine did not start.
    """
    return _unless_it_raises(_timed, case, untimed(case))


def _unless_it_raises(measure: Callable[[Case], Record], case: Case, nothing: Record) -> Record:
    """Return a measurement of a case, or `nothing` where another project's engine raises."""
    try:
        return call_at_engine(case.engine, measure, case)
    except (BrokenEngineError, LostTaskError):  # it cannot even be made here, or ends its process
        return nothing
    except Exception:
        if is_ours(engine(case.engine)):
            raise
        return nothing


def _timed(case: Case) -> Record:
    """Return the times of repeated runs of a case."""
    once = _work(case)
    _warm_up(case)
    runs: list[tuple[float, float, float]] = []
    started = time.perf_counter()
    while len(runs) < FEWEST or (time.perf_counter() - started < PATIENCE and len(runs) < _MOST):
        runs.append(once())
    cpu, wall, setup = map(list, zip(*runs, strict=True))
    return {"cpu_s": cpu, "wall_s": wall, "setup_s": min(setup)}


def untimed(case: Case, error: LostTaskError | None = None) -> Record:
    """Return the record of a case that could not be timed."""
    del case, error
    return {"cpu_s": [], "wall_s": [], "setup_s": None}


def _work(case: Case) -> Callable[[], tuple[float, float, float]]:
    """Return a function that runs the case once: processor time, clock time and set-up, s."""
    if case.engine == "reference":

        def solve() -> tuple[float, float, float]:
            # the motion, known at every instant; sampling it for a comparison is no part of it
            wall, cpu = time.perf_counter(), time.process_time()
            solve_case(case)
            return time.process_time() - cpu, time.perf_counter() - wall, 0.0

        return solve
    chosen = engine(case.engine)

    def simulate() -> tuple[float, float, float]:
        simulation = chosen.simulate(case)
        return simulation.cpu_s, simulation.wall_s, simulation.setup_s

    return simulate


def _warm_up(case: Case) -> None:
    """Run the beginning of a case, so that its code is loaded and in the processor's caches."""
    timestep = engine(case.engine).timestep(case)
    longest = _WARM_SHARE * natural_time(case.scene)
    seconds = longest if timestep is None else min(longest, _WARM_STEPS * timestep)
    seconds = max(seconds, timestep or 0.0)
    _work(replace(case, scene=replace(case.scene, horizon=Horizon(seconds=seconds))))()


def lock_file() -> Path:
    """Return one file for the machine and user, not one a folder: the processor is shared."""
    return Path(tempfile.gettempdir()) / f"rockingcan-timing-{os.getuid()}.lock"


@contextmanager
def timing_lock() -> Iterator[None]:
    """Wait until no other program on this machine times, and lock them out while this one does."""
    with lock_file().open("a") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        yield


class AloneExecutor(Executor):
    """Runs one task after the other, each while no other program on this machine times.

    Parameters
    ----------
    executor : Executor
        Runs the tasks.
    """

    window = 1
    """Number of tasks that keep it busy."""

    def __init__(self, executor: Executor) -> None:
        self._executor = executor

    def submit(self, fn: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> "Future[T]":
        """Run a task once no other program times; its exception, if any, is in the future."""
        lock = ExitStack()
        lock.enter_context(timing_lock())
        try:
            future = self._executor.submit(fn, *args, **kwargs)
        except BaseException:
            lock.close()
            raise
        future.add_done_callback(lambda _: lock.close())
        return future


def _ready() -> None:
    """Do nothing: the process that does it has imported this module."""


@contextmanager
def single_thread_executor(limits: Limits | None = None) -> Iterator[Executor]:
    """Yield an executor of one process that has one thread for linear algebra, and times alone.

    Parameters
    ----------
    limits : Limits, optional
        Of one run of a case; the repeats together may take as much for each.
    """
    before = {name: os.environ[name] for name in _THREADS if name in os.environ}
    os.environ.update(dict.fromkeys(_THREADS, "1"))
    try:
        # two jobs would be two processes; a spawned one reads the environment when it starts
        usual = default_limits(1) if limits is None else limits
        all_repeats = Limits(seconds=(1 + _MOST) * usual.seconds, memory=usual.memory)
        with local_executor(1, spawned=True, limits=all_repeats) as executor:
            executor.submit(_ready).result()  # imported, so that no case's time is that of imports
            yield AloneExecutor(executor)
    finally:
        for name in _THREADS:
            os.environ.pop(name, None)
        os.environ.update(before)


_ALOFT_STEPS = 4000
"""A few milliseconds in C."""

_ALOFT_TIMESTEP = 1e-5
"""s: in all steps together the can falls by 8 mm."""

_HEIGHT = 10.0
"""m."""

_LEANEST = "the engine's loop that steps and keeps nothing: in C where it has one"

_REPEATS = 3 * FEWEST


def aloft(scene: Scene, name: str) -> Case:
    """Return the case whose world is stepped aloft."""
    return Case(
        scene=scene, engine=name, timestep=_ALOFT_TIMESTEP if takes_timestep(name) else None
    )


def overhead(chosen: Case) -> Record:
    """Return processor seconds of one step aloft, by the loop that takes it.

    Parameters
    ----------
    chosen : Case
        Of an engine that opens a world.

    Returns
    -------
    dict
        `ways`: for each way of stepping, the repeats in s a step; empty for an engine without a
        world, and for an engine of another project that raises.
    """
    return _unless_it_raises(_overheads, chosen, {"ways": {}})


def _overheads(chosen: Case) -> Record:
    """Time each way of stepping that an engine has."""
    chosen_engine = engine(chosen.engine)
    features = features_of(chosen_engine)
    opens, chunks, bare_loop = features.open, features.chunks, features.bare_loop
    if opens is None or not takes_timestep(chosen.engine):  # own steps aloft are of any length
        return {"ways": {}}
    world = opens(chosen)

    def python() -> None:
        for _ in range(_ALOFT_STEPS):
            world.step()

    def harness() -> None:
        schedule = Fixed(_ALOFT_TIMESTEP, _ALOFT_TIMESTEP * (_ALOFT_STEPS - 1), _ALOFT_STEPS)
        for _ in chunks(world, schedule, _ALOFT_STEPS):  # type: ignore[misc]
            pass

    ways: dict[str, Callable[[], None]] = {"a call of Python for each step, nothing read": python}
    if chunks is not None:
        ways["every step read, as in a run where the can races"] = harness
    if bare_loop is not None:
        ways[_LEANEST] = lambda: bare_loop(world, _ALOFT_STEPS)
    return {"ways": {name: _repeated(world, way) for name, way in ways.items()}}


def _repeated(world: World, way: Callable[[], None]) -> list[float]:
    """Return the seconds a step of each repeat; a first one warms up."""
    taken = []
    for _ in range(_REPEATS + 1):
        world.place(above_origin(_HEIGHT), moving(spin=np.array((1.0, 0.0, 2.0))))
        started = time.process_time()
        way()
        taken.append((time.process_time() - started) / _ALOFT_STEPS)
    return taken[1:]
