"""PyBullet, imported without the lines that it prints.

PyBullet prints a line on standard error, from C, when it is imported, and on standard output when
it changes its solver. A command whose output is one JSON object, or whose standard error holds one
message, must not contain these lines, so the descriptors point elsewhere meanwhile.
"""

import ctypes
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager

__all__ = ["pybullet", "silence"]


@contextmanager
def silence() -> Iterator[None]:
    """Discard what is printed meanwhile, by C too, whose buffers are flushed before and after."""
    flush = ctypes.CDLL(None).fflush
    sys.stdout.flush()
    sys.stderr.flush()
    flush(None)
    copies = {descriptor: os.dup(descriptor) for descriptor in (1, 2)}
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        for descriptor in copies:
            os.dup2(nowhere, descriptor)
        yield
        flush(None)
    finally:
        for descriptor, copy in copies.items():
            os.dup2(copy, descriptor)
            os.close(copy)
        os.close(nowhere)


with silence():
    import pybullet
