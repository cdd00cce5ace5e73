"""One task in a process of its own, from wherever this is called: a worker of a cluster, say."""

import threading
from collections.abc import Callable
from functools import cache
from typing import ParamSpec, TypeVar

from harness.isolation.limits import Limits
from harness.isolation.pool import Isolated

P = ParamSpec("P")
T = TypeVar("T")


def inside(limits: Limits, fn: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> T:
    """Return what a function returns that runs in a process beside this one, within limits.

    The process is kept for the next call; threads that call at once have one each.

    Raises
    ------
    LostTaskError
        If the process dies or has to be stopped.
    """
    return _beside(threading.get_ident(), limits).submit(fn, *args, **kwargs).result()


@cache
def _beside(thread: int, limits: Limits) -> Isolated:
    """Return the executor of a thread."""
    del thread
    return Isolated(1, limits)
