"""Executors: processes with limits, where a task that crashes fails alone, or this process.

The pools of the standard library and of loky fail all pending tasks when one process dies. Pebble
fails the right task, but its workers share a pipe and its lock: a worker that is killed while it
sends a result stalls the others. So here each worker has a pipe and a thread of its own. The thread
is a daemon, unlike those of `ThreadPoolExecutor`: a program that ends does not wait for a task.

A background process serves one thread, such as that of a cluster's worker, and ends with this one.
"""

import atexit
import pickle
import signal
import threading
from collections.abc import Callable, Hashable
from concurrent.futures import Executor, Future
from functools import cache
from types import TracebackType
from typing import Any, ParamSpec, TypeAlias, TypeVar

from harness.core.environments import Environment
from harness.execution.limits import NO_LIMITS, Limits, default_limits
from harness.execution.signals import SIGNALS, delay_signals
from harness.execution.worker import Loss, LostTaskError, Worker, run_stopped

P = ParamSpec("P")
T = TypeVar("T")


_Task: TypeAlias = tuple["Future[Any]", bytes, tuple[str, ...], int]
"""Future of a task; its function and arguments, pickled; names of their modules; its topic."""

_CHOICE = 64
"""Tasks that wait, among which a worker finds one about a topic that it has had."""


class IsolatedProcessPool(Executor):
    """Runs tasks in so many processes, which are started when they are needed and used again.

    Functions and their arguments are pickled, so a function is one of a module. A task whose
    process dies or has to be stopped raises `LostTaskError`, and one whose process cannot be
    started what the system said; the next has a new process.

    Parameters
    ----------
    workers : int
    limits : Limits
        Of each task. A process imports the modules of its first task before the clock runs.
    environment : Environment, optional
        In whose interpreter the processes run; in this one if left out.
    """

    def __init__(
        self, workers: int, limits: Limits = NO_LIMITS, environment: Environment | None = None
    ) -> None:
        self.workers = workers
        self.limits = limits
        self.on_compiling: Callable[[str], object] = lambda _: None
        """Called with the name of an engine that begins to compile itself, by another thread."""
        self._environment = environment
        self._tasks: list[_Task] = []
        self._topics: dict[Hashable, int] = {None: 0}
        self._taken: set[int] = set()
        self._running: set[Worker] = set()
        self._threads: list[threading.Thread] = []
        self._lock = threading.Lock()
        self._changed = threading.Condition(self._lock)
        self._closed = False
        self._stopping = False

    @property
    def window(self) -> int:
        """Number of tasks that keep the pool busy: one for each worker, and one that waits."""
        return self.workers + 1

    @property
    def window_of_topics(self) -> int:
        """The same where tasks have topics: more of them wait, so that a worker can choose."""
        return self.workers + _CHOICE

    def submit(self, fn: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> "Future[T]":
        """Submit a task; its exception, if any, is in the future.

        Raises
        ------
        RuntimeError
            After `shutdown`.
        """
        return self.submit_about(None, fn, *args, **kwargs)

    def submit_about(
        self, topic: Hashable, fn: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs
    ) -> "Future[T]":
        """Submit a task as `submit`, best done where a task about the same topic was.

        What a process has worked out for a task it need not work out for the next: of the tasks
        that wait a worker takes the first about a topic that it has had, else about one that nobody
        has had, else the first of all. None is no topic, and nobody has had it.
        """
        future: Future[T] = Future()
        payload = pickle.dumps((fn, args, kwargs), pickle.HIGHEST_PROTOCOL)
        # a signal that came while a thread starts would leave one that `shutdown` does not know
        with delay_signals(), self._lock:
            if self._closed:
                raise RuntimeError("the executor was shut down: it takes no more tasks")
            if len(self._threads) < self.workers:
                thread = threading.Thread(target=self._serve, daemon=True)
                thread.start()  # raises if the system has no thread left; no task waits then
                self._threads.append(thread)
            number = self._topics.setdefault(topic, len(self._topics))
            self._tasks.append((future, payload, _modules(fn, *args), number))
            self._changed.notify()
        return future

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:  # noqa: FBT001, FBT002 - as in the interface
        """Take no more tasks; end the processes after the tasks that were submitted."""
        with self._lock:
            self._closed = True
            if cancel_futures:
                for future, *_ in self._tasks:
                    future.cancel()
                self._tasks.clear()
            self._changed.notify_all()
        if wait:
            for thread in self._threads:
                thread.join()

    def stop(self) -> None:
        """End at once: cancel the waiting tasks, and kill the processes of the others."""
        self.shutdown(wait=False, cancel_futures=True)
        with self._lock:
            self._stopping = True
            for worker in self._running:
                worker.stop()
        for thread in self._threads:
            thread.join()

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Wait for the submitted tasks; after an error, stop at once."""
        del error, trace
        if kind is None:
            self.shutdown()
        else:
            self.stop()

    def _next(self, had: set[int]) -> _Task | None:
        """Wait for a task, best about a topic of these, and take it; None after the last."""
        with self._changed:
            while not self._tasks and not self._closed:
                self._changed.wait()
            if not self._tasks:
                return None
            topics = [topic for *_, topic in self._tasks]
            own = (place for place, topic in enumerate(topics) if topic in had)
            new = (place for place, topic in enumerate(topics) if topic not in self._taken)
            task = self._tasks.pop(next(own, next(new, 0)))
            *_, topic = task
            if topic:  # but for none
                had.add(topic)
                self._taken.add(topic)
            return task

    def _serve(self) -> None:
        """Give tasks to a worker; a task that kills its worker is followed by a new worker."""
        # a process inherits what is blocked here, until it has seen to its signals itself
        signal.pthread_sigmask(signal.SIG_BLOCK, SIGNALS)
        worker: Worker | None = None
        had: set[int] = set()
        while (task := self._next(had)) is not None:
            future, payload, modules, _ = task
            if not future.set_running_or_notify_cancel():
                continue
            try:
                worker = worker or self._started(modules)
                answer = worker.do(payload)
            except Exception as error:  # noqa: BLE001 - handed on to whoever asks for the result
                future.set_exception(error)
                self._ended(worker)
                worker = None
                had.clear()  # a new process has worked out nothing
                continue
            _settle(future, answer)
        self._ended(worker)

    def _started(self, modules: tuple[str, ...]) -> Worker:
        """Return a new worker that imports these modules first, unless the pool is stopped."""
        with self._lock:
            if self._stopping:
                raise run_stopped()
            try:
                worker = Worker(self.limits, modules, self._environment)
                worker.on_compiling = self.on_compiling
            except OSError as error:
                reason = f"never begun: no process can be started: {error}"
                raise LostTaskError(Loss.STOPPED, reason) from error
            self._running.add(worker)
        return worker

    def _ended(self, worker: Worker | None) -> None:
        """End a worker and forget it."""
        if worker is not None:
            with self._lock:
                self._running.discard(worker)
            worker.close()


def _modules(*things: object) -> tuple[str, ...]:
    """Return the names of the modules of all functions among these objects."""
    names = (getattr(thing, "__module__", None) for thing in things if callable(thing))
    return tuple(name for name in names if isinstance(name, str))


def _settle(future: "Future[Any]", answer: bytes) -> None:
    """Copy the answer of a worker into the future."""
    try:
        result, error = pickle.loads(answer)  # noqa: S301 - from our worker
    except Exception as unreadable:  # noqa: BLE001 - handed on to whoever asks for the result
        result, error = None, unreadable
    if error is None:
        future.set_result(result)
    else:
        future.set_exception(error)


_background: list[IsolatedProcessPool] = []


def background_worker(
    limits: Limits, environment: Environment | None = None
) -> IsolatedProcessPool:
    """Return an executor of one process that is ended when this one ends, with what it started.

    Parameters
    ----------
    limits : Limits
        Of each task.
    environment : Environment, optional
        In whose interpreter the process runs; in this one if left out.
    """
    executor = IsolatedProcessPool(1, limits, environment)
    _background.append(executor)
    return executor


@atexit.register
def end_background_worker() -> None:
    """End the background processes, also where a program skips the handlers of `atexit`."""
    for executor in tuple(_background):
        executor.stop()


def run_isolated(limits: Limits, fn: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> T:
    """Return the result of a function that runs in a background process, within limits.

    The process serves the next call too, and ends with this one; each calling thread has its own.

    Raises
    ------
    LostTaskError
        If the process dies or has to be stopped.
    """
    return _worker_of(threading.get_ident(), limits).submit(fn, *args, **kwargs).result()


@cache
def _worker_of(thread: int, limits: Limits) -> IsolatedProcessPool:
    """Return the background process of a thread."""
    del thread
    return background_worker(limits)


class SerialExecutor(Executor):
    """Runs each task where and when it is submitted."""

    window = 1
    """Number of tasks that keep the executor busy."""

    def submit(self, fn: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> "Future[T]":
        """Run a task now; its exception, if any, is in the future."""
        future: Future[T] = Future()
        try:
            future.set_result(fn(*args, **kwargs))
        except Exception as error:  # noqa: BLE001 - handed on to whoever asks for the result
            future.set_exception(error)
        return future


def local_executor(
    jobs: int,
    *,
    spawned: bool = False,
    limits: Limits | None = None,
) -> Executor:
    """Return an executor of so many processes on this machine.

    Parameters
    ----------
    jobs : int
    spawned : bool
        A process of its own for a single job too; else that runs in this one, where nothing can
        stop it and a crash ends the program.
    limits : Limits, optional
        Of each task in a process; half an hour, and together most of the memory, if left out.
    """
    if jobs == 1 and not spawned:
        return SerialExecutor()
    return IsolatedProcessPool(jobs, default_limits(jobs) if limits is None else limits)
