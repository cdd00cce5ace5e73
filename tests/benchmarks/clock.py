"""Two pieces of work timed in turns, so that a noisy machine disturbs both alike."""

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

REPEATS = 5

_TAIL = 0.025
"""Of an interval of 95 %, outside on either side."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Ratio:
    """A claim about speed and what was measured of it.

    Parameters
    ----------
    what : str
        What is compared with what.
    ratio : float
    claim : str
        The bound that the project holds itself to; empty where it only reports.
    holds : bool
    first_s, second_s : float
        Processor time of each, s: the shortest of the repeats, or the median where the ratio is one
        of pairs.
    note : str
        What the two have in common: the error that both meet, the number of cases.
    """

    what: str
    ratio: float
    claim: str
    holds: bool
    first_s: float
    second_s: float
    note: str


def in_turns(
    first: Callable[[], object], second: Callable[[], object], repeats: int = REPEATS
) -> tuple[float, float]:
    """Return the shortest processor times of two pieces of work, s, warmed up and run in turns."""
    first()
    second()
    pairs = [(seconds(first), seconds(second)) for _ in range(repeats)]
    return min(pair[0] for pair in pairs), min(pair[1] for pair in pairs)


def median_of_pairs(ratios: Sequence[float]) -> tuple[float, float, float]:
    """Return the median of ratios of pairs, and its interval of 95 %.

    The ends are ratios themselves, as far from both ends of the list as a fair coin allows:
    whatever disturbs the machine, a pair is as likely above the true median as below it. Of fewer
    than six pairs the interval is all of them.
    """
    ordered, n = sorted(ratios), len(ratios)
    skipped, tail = 0, 2.0**-n
    while tail <= _TAIL:
        skipped += 1
        tail += math.comb(n, skipped) * 2.0**-n
    outer = max(skipped - 1, 0)
    middle = (ordered[(n - 1) // 2] + ordered[n // 2]) / 2.0
    return middle, ordered[outer], ordered[n - 1 - outer]


def seconds(work: Callable[[], object]) -> float:
    """Return the processor time of a piece of work, s."""
    started = time.process_time()
    work()
    return time.process_time() - started
