"""An executor whose tasks cannot hurt each other: a process each, limits, replacement.

The pools of the standard library and of loky fail all that is pending when one process dies. That
of pebble tells which task it was, but its workers share a pipe and its lock: one that is killed
while it sends a result stalls the others. So here each worker has a pipe, and a thread, of its own.
"""

import pickle
import queue
import signal
import threading
from collections.abc import Callable
from concurrent.futures import Executor, Future
from dataclasses import dataclass
from types import TracebackType
from typing import Any, ParamSpec, TypeVar

from harness.interruption import SIGNALS
from harness.isolation.limits import NO_LIMITS, Limits
from harness.isolation.loss import of_stop, of_want
from harness.isolation.worker import Worker

P = ParamSpec("P")
T = TypeVar("T")


@dataclass(frozen=True, slots=True, kw_only=True)
class _Task:
    future: "Future[Any]"
    payload: bytes


class Isolated(Executor):
    """Runs tasks in so many processes, which are started when they are needed and used again.

    Functions and their arguments are pickled, so a function is one of a module. A task whose
    process dies or has to be stopped raises `LostTaskError`, and one whose process cannot be
    started what the system said; the next has a new process.

    Parameters
    ----------
    workers : int
    limits : Limits
        Of each task.
    imports : tuple of str
        Modules that a process imports at its start, before the clock of a task runs.
    """

    def __init__(
        self, workers: int, limits: Limits = NO_LIMITS, imports: tuple[str, ...] = ()
    ) -> None:
        self.workers = workers
        self.limits = limits
        self._imports = imports
        self._tasks: queue.SimpleQueue[_Task | None] = queue.SimpleQueue()
        self._running: set[Worker] = set()
        self._threads: list[threading.Thread] = []
        self._lock = threading.Lock()
        self._closed = False
        self._stopping = False

    @property
    def window(self) -> int:
        """How many tasks keep it busy: one for each worker, and one that waits."""
        return self.workers + 1

    def submit(self, fn: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> "Future[T]":
        """Have a task done; its exception, if any, is in the future.

        Raises
        ------
        RuntimeError
            After `shutdown`.
        """
        future: Future[T] = Future()
        payload = pickle.dumps((fn, args, kwargs), pickle.HIGHEST_PROTOCOL)
        with self._lock:
            if self._closed:
                raise RuntimeError("the executor was shut down: it takes no more tasks")
            if len(self._threads) < self.workers:
                thread = threading.Thread(target=self._serve, daemon=True)
                thread.start()  # raises where the system has none left: then nothing waits for it
                self._threads.append(thread)
            self._tasks.put(_Task(future=future, payload=payload))
        return future

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:  # noqa: FBT001, FBT002 - as in the interface
        """Take no more tasks; end the processes when they have done what they have."""
        with self._lock:
            self._closed = True
            if cancel_futures:
                self._cancel_waiting()
            for _ in self._threads:
                self._tasks.put(None)
        if wait:
            for thread in self._threads:
                thread.join()

    def stop(self) -> None:
        """End at once: cancel what waits, and kill the processes of what runs."""
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
        """Wait for what was submitted; after an error, do not."""
        del error, trace
        if kind is None:
            self.shutdown()
        else:
            self.stop()

    def _cancel_waiting(self) -> None:
        """Cancel the tasks that no worker has."""
        while True:
            try:
                task = self._tasks.get_nowait()
            except queue.Empty:
                return
            if task is not None:
                task.future.cancel()

    def _serve(self) -> None:
        """Give tasks to one worker, and a new one to the task after one that took it along."""
        # a process inherits what is blocked here, until it has seen to its signals itself
        signal.pthread_sigmask(signal.SIG_BLOCK, SIGNALS)
        worker: Worker | None = None
        while (task := self._tasks.get()) is not None:
            if not task.future.set_running_or_notify_cancel():
                continue
            try:
                worker = worker or self._started()
                answer = worker.do(task.payload)
            except Exception as error:  # noqa: BLE001 - handed on to whoever asks for the result
                task.future.set_exception(error)
                self._ended(worker)
                worker = None
                continue
            _settle(task.future, answer)
        self._ended(worker)

    def _started(self) -> Worker:
        """Return a new worker, unless all is being stopped."""
        with self._lock:
            if self._stopping:
                raise of_stop()
            try:
                worker = Worker(self.limits, self._imports)
            except OSError as error:
                raise of_want(error) from error
            self._running.add(worker)
        return worker

    def _ended(self, worker: Worker | None) -> None:
        """Clear up after a worker."""
        if worker is not None:
            with self._lock:
                self._running.discard(worker)
            worker.close()


def _settle(future: "Future[Any]", answer: bytes) -> None:
    """Hand on what a worker answered."""
    try:
        result, error = pickle.loads(answer)  # noqa: S301 - from a process of our own
    except Exception as unreadable:  # noqa: BLE001 - handed on to whoever asks for the result
        result, error = None, unreadable
    if error is None:
        future.set_result(result)
    else:
        future.set_exception(error)
