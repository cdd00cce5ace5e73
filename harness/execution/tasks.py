"""Run tasks on any executor: results are stored as they come, and those stored before are read.

Stored results are read while tasks run. A few more tasks are submitted than run at once, or some
dozens among which a worker can choose; no more are pending when the program ends, however it ends.
"""

import time
from collections import deque
from collections.abc import Callable, Hashable, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, wait
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from functools import cache
from typing import Generic, TypeVar

from harness.core.provenance import processor
from harness.execution.cache import CacheFolder
from harness.execution.cache_entry import Metadata
from harness.execution.estimate import Taken, processor_time
from harness.execution.isolated_pool import IsolatedProcessPool
from harness.execution.signals import delay_signals
from harness.execution.worker import Loss, LostTaskError

T = TypeVar("T")
R = TypeVar("R")


@dataclass(frozen=True, slots=True, kw_only=True)
class ResultCache(Generic[T, R]):
    """The part of a store that holds the results of one kind of task.

    Parameters
    ----------
    store : CacheFolder
    kind : str
        One word.
    key : callable
        Returns the digest of everything that decides the result of a task.
    metadata : callable
        Returns the origin of a result; time and machine are filled in.
    """

    store: CacheFolder
    kind: str
    key: Callable[[T], str]
    metadata: Callable[[T], Metadata]

    def has(self, task: T) -> bool:
        """Whether the result of a task is stored."""
        return self.store.has(self.kind, self.key(task))

    def get(self, task: T) -> R | None:
        """Return the result of a task, or None if there is none that can be read."""
        result: R | None = self.store.get(self.kind, self.key(task))
        return result

    def put(self, task: T, result: R) -> None:
        """Store the result of a task."""
        when = datetime.now(UTC).isoformat(timespec="seconds")
        metadata = replace(self.metadata(task), kept=when, machine=_machine())
        self.store.put(self.kind, self.key(task), metadata, result)

    def begun(self, task: T) -> None:
        """Write into the journal that a task is submitted."""
        self.store.note("begun", self.kind, self.key(task))


@cache
def _machine() -> str:
    """Return the processor of this machine."""
    return processor()


@dataclass(frozen=True, slots=True, kw_only=True)
class ProgressListener(Generic[T, R]):
    """Callbacks for the progress of tasks.

    Parameters
    ----------
    kept : callable
        Called before anything runs with the number of stored results and that of tasks.
    done : callable
        Called with each task, its result, and what it took: None if it was stored or lost.
    """

    kept: Callable[[int, int], None] = field(default=lambda *_: None)
    done: Callable[[T, R, Taken | None], None] = field(default=lambda *_: None)


def timed(work: Callable[[T], R], task: T) -> tuple[R, Taken]:
    """Return the result of a task and what it took, where it runs."""
    wall, cpu = time.perf_counter(), processor_time()
    result = work(task)
    return result, Taken(processor_time() - cpu, time.perf_counter() - wall)


_TICK = 0.1
"""s between looks at whether a signal came."""


def run_queue(
    queue: deque[T],
    submit: Callable[[T], Future[R]],
    take: Callable[[T, Future[R]], None],
    window: int,
    meanwhile: Callable[[], bool] = lambda: False,
) -> None:
    """Submit the tasks of a queue and take their results, until nothing is left.

    Parameters
    ----------
    queue : deque
        Is emptied from the left; `take` and `meanwhile` may add to it.
    submit : callable
        Submits a task.
    take : callable
        Called with each task and its future once that is done.
    window : int
        Most tasks that are pending at a time.
    meanwhile : callable
        Does something else while tasks run; returns whether there was anything to do.

    Raises
    ------
    BaseException
        What any of these raises, Ctrl-C too, after which nothing more is begun.
    """
    pending: dict[Future[R], T] = {}
    try:
        while True:
            while queue and len(pending) < window:
                task = queue.popleft()
                pending[submit(task)] = task
            busy = meanwhile()
            if not (queue or pending or busy):
                return
            # an interrupt while `wait` takes the locks of the futures would leave them taken;
            # while there is something else to do, do not wait
            with delay_signals():
                done, _ = wait(pending, 0.0 if busy else _TICK, FIRST_COMPLETED)
            for future in done:
                take(pending.pop(future), future)
    except BaseException:
        for future in pending:
            future.cancel()
        raise


def run_tasks(
    tasks: Sequence[T],
    work: Callable[[T], R],
    executor: Executor,
    *,
    lost: Callable[[T, LostTaskError], R],
    cache: ResultCache[T, R] | None = None,
    listener: ProgressListener[T, R] | None = None,
    about: Callable[[T], Hashable] | None = None,
) -> list[R]:
    """Return the results of tasks in their order: read if stored, else computed and stored.

    The loss of a task that crashed is stored, since it would crash again. A task that was stopped,
    for its limits or from outside, may succeed the next time, and so it is run again.

    Parameters
    ----------
    tasks : sequence
    work : callable
        A function of a module, so that it can be sent to a process.
    executor : Executor
    lost : callable
        Returns the result of a task whose process died or was stopped.
    cache : ResultCache, optional
    listener : ProgressListener, optional
    about : callable, optional
        Returns the topic of a task: what a process works out for a task serves it for others about
        the same, and so they go to the same process where the executor can choose.

    Raises
    ------
    Exception
        Raised by `work`; nothing more is begun, and a note says how many results are stored.
    """
    run = _Run(tasks, work, executor, lost, cache, listener or ProgressListener(), about)
    try:
        run.find()
        run_queue(run.left, run.submit, run.take, run.window(), run.read)
    except BaseException as error:  # Ctrl-C too
        error.add_note(run.account())
        raise
    return [run.results[index] for index in range(len(tasks))]


@dataclass(slots=True)
class _Run(Generic[T, R]):
    """The state of one call of `run_tasks`; tasks by their numbers."""

    tasks: Sequence[T]
    work: Callable[[T], R]
    executor: Executor
    lost: Callable[[T, LostTaskError], R]
    cache: ResultCache[T, R] | None
    listener: ProgressListener[T, R]
    about: Callable[[T], Hashable] | None
    results: dict[int, R] = field(default_factory=dict)
    stored: deque[int] = field(default_factory=deque)
    left: deque[int] = field(default_factory=deque)
    safe: int = 0

    def find(self) -> None:
        """Separate the tasks whose results are stored from those left to do."""
        for index, task in enumerate(self.tasks):
            known = self.cache is not None and self.cache.has(task)
            (self.stored if known else self.left).append(index)
        self.listener.kept(len(self.stored), len(self.tasks))

    def account(self) -> str:
        """Return in a sentence how many tasks are done, and where their results are."""
        if self.cache is None:
            return f"{len(self.results)} of {len(self.tasks)} were done, and nothing is kept."
        stored = self.safe + len(self.stored)
        return f"{stored} of {len(self.tasks)} are done and kept in '{self.cache.store.folder}'."

    def window(self) -> int:
        """Return how many tasks the executor may have at a time."""
        if self.about is not None and isinstance(self.executor, IsolatedProcessPool):
            return self.executor.window_of_topics
        return getattr(self.executor, "window", len(self.tasks))

    def submit(self, index: int) -> Future[tuple[R, Taken]]:
        """Submit a task."""
        task, executor = self.tasks[index], self.executor
        if self.cache is not None:
            self.cache.begun(task)
        try:
            if self.about is not None and isinstance(executor, IsolatedProcessPool):
                return executor.submit_about(self.about(task), timed, self.work, task)
            return executor.submit(timed, self.work, task)
        except BrokenExecutor as error:
            future: Future[tuple[R, Taken]] = Future()
            future.set_exception(error)
            return future

    def read(self) -> bool:
        """Take the next stored result; a task whose result cannot be read is done again."""
        if not self.stored or self.cache is None:
            return False
        with delay_signals():
            index = self.stored.popleft()
            result = self.cache.get(self.tasks[index])
            if result is None:
                self.left.append(index)
                return True
            self.safe += 1
        self.results[index] = result
        self.listener.done(self.tasks[index], result, None)
        return True

    def take(self, index: int, future: Future[tuple[R, Taken]]) -> None:
        """Store the result of a task."""
        task, keep = self.tasks[index], True
        taken: Taken | None = None
        try:
            result, taken = future.result()
        except BrokenExecutor as error:
            if not isinstance(error, LostTaskError):
                reason = f"its process died, or one beside it, before it was done: {error}"
                error = LostTaskError(Loss.STOPPED, reason)
            result, keep = self.lost(task, error), error.loss is Loss.CRASHED
        if self.cache is not None and keep:
            with delay_signals():  # a stored result is counted, whatever signal comes
                self.cache.put(task, result)
                self.safe += 1
        self.results[index] = result
        self.listener.done(task, result, taken)
