"""Compiled kernels: numba where it is installed (the extra `fast`), and never without being asked.

A kernel is plain Python in scalars and small arrays, decorated with `jit`. Modules of kernels are
imported where they are used: numba takes as long to import as a hundred bounces take to solve.

Compiled code is kept in a folder that the digest of all sources of this package names, beside this
file, or in the user's own caches where that is read-only. Numba by itself would look at the file of
a kernel alone, and go on using what it compiled of a kernel or a constant of another file.
"""

import os
from collections.abc import Callable
from functools import cache
from hashlib import sha256
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path
from typing import Any, TypeVar, cast

F = TypeVar("F", bound=Callable[..., Any])


@cache
def available() -> bool:
    """Return whether kernels can be compiled here; numba is not imported for it."""
    return find_spec("numba") is not None


def path_taken(*, compiled: bool) -> str:
    """Return in words which code computes: compiled with which version of numba, or numpy."""
    return f"compiled, numba {version('numba')}" if compiled else "numpy"


def jit(function: F) -> F:
    """Return a function compiled to machine code when it is first called.

    Division by zero gives infinity as in numpy; operations are never reordered, so that the same
    machine gives the same bits.

    Raises
    ------
    ModuleNotFoundError
        If numba is not installed.
    """
    return _compiled(function)


def inner(function: F) -> F:
    """Return the same as `jit`, for kernels to call alone.

    The code by which Python would call the function is left out: it takes as long to compile as a
    short kernel itself.
    """
    return _compiled(function, inner=True)


def inlined(function: F) -> F:
    """Return the same as `jit`, made part of each kernel that calls the function.

    For algebra in numbers: a loop over a call is one instruction for several columns only where the
    call is gone. It is compiled once more with each caller.
    """
    return _compiled(function, inner=True, inlined=True)


def _compiled(function: F, *, inner: bool = False, inlined: bool = False) -> F:
    """Return a function that numba compiles when it is first called."""
    if not available():
        message = "compiled kernels need numba: pip install 'rockingcan[fast]'"
        raise ModuleNotFoundError(message, name="numba")
    import numba

    config: Any = numba.config
    own = config.CACHE_DIR
    config.CACHE_DIR = _folder(own)
    # numba's own stubs leave two of these options out
    options: Any = numba.njit
    compile_first = options(
        cache=True,
        nogil=True,
        error_model="numpy",
        fastmath=False,
        forceinline=inlined,
        no_cpython_wrapper=inner,
        no_cfunc_wrapper=inner,
    )
    try:
        return cast("F", compile_first(function))
    finally:
        config.CACHE_DIR = own


@cache
def _folder(own: str) -> str:
    """Return the folder of what is compiled from the sources as they are.

    Parameters
    ----------
    own : str
        The user's choice, `NUMBA_CACHE_DIR`, in which the folder then is; or empty.
    """
    digest = sha256()
    for source in sorted(Path(__file__).parents[1].rglob("*.py")):
        digest.update(source.read_bytes())
    beside = Path(__file__).parent
    caches = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    place = beside if os.access(beside, os.W_OK) else caches / "rockingcan"
    return str((Path(own) if own else place / "__pycache__") / f"kernels-{digest.hexdigest()[:16]}")
