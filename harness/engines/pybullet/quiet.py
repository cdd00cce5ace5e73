"""PyBullet without its greeting.

It prints a line on standard error, from C, when it is imported; a command whose standard error
holds one clear message cannot have that. So the descriptor points elsewhere while it is loaded.
"""

import os
import sys


def load() -> None:
    """Import `pybullet` for the first time, and let nothing be printed."""
    if "pybullet" in sys.modules:
        return
    sys.stderr.flush()
    kept = os.dup(2)
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nowhere, 2)
        import pybullet  # noqa: F401, PLC0415 - the import is the point
    finally:
        os.dup2(kept, 2)
        os.close(kept)
        os.close(nowhere)


load()
