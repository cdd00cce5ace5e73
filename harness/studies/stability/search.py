"""The largest usable timestep, by bisection in log dt, as rounds: a study designs and never runs.

A search is what is known of a release so far: which timesteps were usable. What to try next follows
from that alone. The boundary is ragged (whether a step happens to fall into the bounce decides), so
that a timestep may be usable by luck far above others that are not, and by round-off not be usable
far below; the boundary sought is the upper end of the longest unbroken run of usable timesteps.
"""

import math
from collections.abc import Mapping, Sequence

_SAME = 1e-9  # relative: timesteps nearer than that are one


def bracket(known: Mapping[float, bool]) -> tuple[float | None, float | None]:
    """Return the largest usable timestep and the smallest above it that is not, s.

    Parameters
    ----------
    known : mapping of float to bool
        Timesteps that were tried, s, and whether each was usable.

    Returns
    -------
    usable : float or None
        None if none was usable.
    unusable : float or None
        None if none above the usable one was tried in vain; if none was usable, the smallest.
    """
    runs: list[list[float]] = []
    unbroken = False
    for step in sorted(known):
        if known[step] and unbroken:
            runs[-1].append(step)
        elif known[step]:
            runs.append([step])
        unbroken = known[step]
    if not runs:
        return None, min(known, default=None)
    best = max(runs, key=lambda run: (run[-1] / run[0], -run[0]))
    return best[-1], min((step for step in known if step > best[-1]), default=None)


def next_timestep(
    known: Mapping[float, bool], rungs: Sequence[float], ratio: float, start: float
) -> float | None:
    """Return the timestep to try next, s; None if the boundary is known, or is not on the ladder.

    Parameters
    ----------
    known : mapping of float to bool
    rungs : sequence of float
        Ladder along which a bracket is looked for, s.
    ratio : float
        Unusable over usable timestep from which on the boundary counts as known.
    start : float
        Where to begin, s.
    """
    if not known:
        return start
    usable, unusable = bracket(known)
    if usable is None:
        lower = min(known)
        return max((rung for rung in rungs if rung < lower * (1.0 - _SAME)), default=None)
    if unusable is None:
        return min((rung for rung in rungs if rung > usable * (1.0 + _SAME)), default=None)
    if unusable <= ratio * usable:
        return None
    return math.sqrt(usable * unusable)
