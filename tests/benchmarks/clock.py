"""Two pieces of work timed in turns, so that a noisy machine disturbs both alike."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.stats import binom

REPEATS = 5


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
        Processor time of each, s: the shortest of the repeats, or the median of pairs. Of a whole
        job its wall time, or that of a larger one by its rate.
    note : str
        What the two have in common: the error that both meet, the number of cases.
    interval : tuple of 2 floats, or None
        Of a ratio that is the median of pairs, where it lies in 95 of 100 measurements.
    """

    what: str
    ratio: float
    claim: str
    holds: bool
    first_s: float
    second_s: float
    note: str
    interval: tuple[float, float] | None = None


def in_turns(
    first: Callable[[], object],
    second: Callable[[], object],
    repeats: int = REPEATS,
    runs: int = 1,
) -> tuple[float, float]:
    """Return the shortest processor times of two pieces of work, s, warmed up and run in turns.

    Parameters
    ----------
    first, second : callable
    repeats : int
        Turns of each.
    runs : int
        Of each in its turn: what takes less than a millisecond takes twice as long where the other
        has just filled the processor's caches.
    """
    first()
    second()

    def shortest(work: Callable[[], object]) -> float:
        return min(seconds(work) for _ in range(runs))

    pairs = [(shortest(first), shortest(second)) for _ in range(repeats)]
    return min(pair[0] for pair in pairs), min(pair[1] for pair in pairs)


def paired(first: Sequence[float], second: Sequence[float]) -> tuple[float, tuple[float, float]]:
    """Return the median ratio of times taken in turns, and its 95 % interval by order statistics.

    Whatever disturbs a machine for long disturbs both of a pair; a pair that is disturbed in one of
    its two moves the median by one place and no further.
    """
    ratios = np.sort(np.array(first) / np.array(second))
    low = max(int(binom.ppf(0.025, len(ratios), 0.5)) - 1, 0)
    return float(np.median(ratios)), (float(ratios[low]), float(ratios[-1 - low]))


def seconds(work: Callable[[], object]) -> float:
    """Return the processor time of a piece of work, s."""
    started = time.process_time()
    work()
    return time.process_time() - started
