"""Compiled kernels: numba where it is installed (the extra `fast`), and never without being asked.

A kernel is plain Python in scalars and small arrays, decorated with `jit`. Modules of kernels are
imported where they are used: numba takes as long to import as a hundred bounces take to solve.
Compiled code is kept in a cache beside the source, or in the user's own where that is read-only.
"""

from collections.abc import Callable
from functools import cache
from importlib.util import find_spec
from typing import Any, TypeVar, cast

F = TypeVar("F", bound=Callable[..., Any])


@cache
def available() -> bool:
    """Return whether kernels can be compiled here; numba is not imported for it."""
    return find_spec("numba") is not None


def jit(function: F) -> F:
    """Return a function compiled to machine code when it is first called.

    Division by zero gives infinity as in numpy; operations are never reordered, so that the same
    machine gives the same bits.
    """
    import numba

    compile_first = numba.njit(cache=True, nogil=True, error_model="numpy", fastmath=False)
    return cast("F", compile_first(function))
