"""Where cases run: anything with the interface of `concurrent.futures.Executor`."""

import multiprocessing
import signal
from collections.abc import Callable
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from typing import Any, ParamSpec, TypeVar

P = ParamSpec("P")
T = TypeVar("T")


class Serial(Executor):
    """Runs each task where and when it is submitted."""

    def submit(self, fn: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> "Future[T]":
        """Run a task now; its exception, if any, is in the future."""
        future: Future[T] = Future()
        try:
            future.set_result(fn(*args, **kwargs))
        except Exception as error:  # noqa: BLE001 - handed on to whoever asks for the result
            future.set_exception(error)
        return future


def local(jobs: int, *, spawned: bool = False) -> Executor:
    """Return an executor of so many processes on this machine.

    Parameters
    ----------
    jobs : int
    spawned : bool
        A process of its own for a single job too; else that runs in this one.
    """
    if jobs == 1 and not spawned:
        return Serial()
    # engines hold threads and global state, which a forked child would share
    context: Any = multiprocessing.get_context("spawn")
    return ProcessPoolExecutor(max_workers=jobs, mp_context=context, initializer=_end_quietly)


def _end_quietly() -> None:
    """Let Ctrl-C, which a terminal sends to every process, end this one without a traceback."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)
