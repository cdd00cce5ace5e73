"""One task in a process of its own, from wherever this is called: a worker of a cluster, say."""

import threading
from collections.abc import Callable
from functools import cache
from typing import ParamSpec, TypeVar

from harness.isolation.beside import beside
from harness.isolation.limits import Limits
from harness.isolation.pool import Isolated

P = ParamSpec("P")
T = TypeVar("T")


def inside(
    limits: Limits,
    imports: tuple[str, ...],
    fn: Callable[P, T],
    /,
    *args: P.args,
    **kwargs: P.kwargs,
) -> T:
    """Return what a function returns that runs in a process beside this one, within limits.

    The process is kept for the next call, and ended with this one; threads that call at once have
    one each. What it imports at its start, no call's time counts.

    Raises
    ------
    LostTaskError
        If the process dies or has to be stopped.
    """
    here = _beside(threading.get_ident(), limits, tuple(imports))
    return here.submit(fn, *args, **kwargs).result()


@cache
def _beside(thread: int, limits: Limits, imports: tuple[str, ...]) -> Isolated:
    """Return the executor of a thread."""
    del thread
    return beside(limits, imports)
