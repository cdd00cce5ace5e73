"""Processes that are beside this one for as long as it runs, and end with it."""

import atexit

from harness.isolation.limits import Limits
from harness.isolation.pool import Isolated

_there: list[Isolated] = []


def beside(limits: Limits, imports: tuple[str, ...] = ()) -> Isolated:
    """Return an executor of one process that is ended when this one ends, with what it started.

    Parameters
    ----------
    limits : Limits
        Of each task.
    imports : tuple of str
        Modules that the process imports at its start.
    """
    made = Isolated(1, limits, imports)
    _there.append(made)
    return made


@atexit.register
def end_beside() -> None:
    """End what is beside this process; to be called by a program that does not end as usual."""
    for executor in tuple(_there):
        executor.stop()
