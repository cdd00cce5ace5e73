"""Running on this machine: here, one by one, or in processes within limits."""

from collections.abc import Callable
from concurrent.futures import Executor, Future
from typing import ParamSpec, TypeVar

from harness.isolation import Isolated, Limits
from harness.isolation.limits import sensible

P = ParamSpec("P")
T = TypeVar("T")

IMPORTS = ("harness.runner",)
"""What a worker imports at its start; engines follow with the first case that asks for them."""


class Serial(Executor):
    """Runs each task where and when it is submitted."""

    window = 1
    """How many tasks keep it busy."""

    def submit(self, fn: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> "Future[T]":
        """Run a task now; its exception, if any, is in the future."""
        future: Future[T] = Future()
        try:
            future.set_result(fn(*args, **kwargs))
        except Exception as error:  # noqa: BLE001 - handed on to whoever asks for the result
            future.set_exception(error)
        return future


def local(
    jobs: int,
    *,
    spawned: bool = False,
    limits: Limits | None = None,
    imports: tuple[str, ...] = IMPORTS,
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
    imports : tuple of str
        What a process imports at its start, before the time of a task runs.
    """
    if jobs == 1 and not spawned:
        return Serial()
    return Isolated(jobs, sensible(jobs) if limits is None else limits, imports)
