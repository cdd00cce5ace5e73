"""States at many instants, a block of instants after the other.

A series is summed with all its terms at all its instants side by side: of a thousand bounces that
is gigabytes. Of a block it fits into the processor's cache, and is summed faster.
"""

from collections.abc import Callable

import numpy as np

from reference.problem.states import Floats, States

# Some thirty terms of ten quantities at so many instants are five megabytes.
BLOCK = 2048


def in_blocks(at: Callable[[Floats], States], times: Floats) -> States:
    """States at the given times, shape (n,), by a function that is given a block of them at most.

    Parameters
    ----------
    at : callable
        States at times, each by itself whatever the others are.
    times : ndarray, shape (n,)
    """
    if times.size <= BLOCK:
        return at(times)
    parts = [at(times[start : start + BLOCK]) for start in range(0, times.size, BLOCK)]

    def column(name: str) -> Floats | None:
        arrays = [getattr(part, name) for part in parts]
        return None if arrays[0] is None else np.concatenate(arrays)

    return States(**{name: column(name) for name in States.__slots__})  # type: ignore[arg-type]
