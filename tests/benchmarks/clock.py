"""Two pieces of work timed in turns, so that a noisy machine disturbs both alike."""

import time
from collections.abc import Callable
from dataclasses import dataclass

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
        Processor time of each, s, the shortest of the repeats.
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


def seconds(work: Callable[[], object]) -> float:
    """Return the processor time of a piece of work, s."""
    started = time.process_time()
    work()
    return time.process_time() - started
