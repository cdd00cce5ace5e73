"""PyBullet without what it says of itself.

It prints a line on standard error, from C, when it is imported, and on standard output when it
changes its solver; a command whose output is one JSON object, or whose standard error holds one
clear message, cannot have that. So the descriptors point elsewhere meanwhile.
"""

import ctypes
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def silence() -> Iterator[None]:
    """Let nothing be printed, by C either, which keeps what it prints until it is told."""
    said = ctypes.CDLL(None).fflush
    sys.stdout.flush()
    sys.stderr.flush()
    said(None)
    kept = {descriptor: os.dup(descriptor) for descriptor in (1, 2)}
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        for descriptor in kept:
            os.dup2(nowhere, descriptor)
        yield
        said(None)
    finally:
        for descriptor, copy in kept.items():
            os.dup2(copy, descriptor)
            os.close(copy)
        os.close(nowhere)


def load() -> None:
    """Import `pybullet` for the first time."""
    if "pybullet" in sys.modules:
        return
    with silence():
        import pybullet  # noqa: F401, PLC0415 - the import is the point


load()
