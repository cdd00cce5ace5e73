"""Silence for engines that print of their own accord, from C, where they are imported or started.

A command whose output is one JSON object, or whose standard error holds one message, must not
contain these lines, so the descriptors point elsewhere meanwhile.
"""

import ctypes
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager


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
