"""How long a task may take and how much memory it may use."""

import math
from dataclasses import dataclass

from harness.errors import InvalidSettingError
from harness.isolation.memory import available

_MOST_MEMORY = 4 * 2**30
_LEAST_MEMORY = 0.5 * 2**30
"""An engine and the reference use 0.2 GiB."""

_SHARE = 0.8  # of all memory, for all workers together


@dataclass(frozen=True, slots=True, kw_only=True)
class Limits:
    """What a worker is given for one task.

    Parameters
    ----------
    seconds : float
        By the clock, from when the worker has the task; infinite for no limit.
    memory : float
        Bytes of resident memory of the worker and of what it started, as the system's own
        out-of-memory killer weighs it; infinite for no limit. Address space is no measure:
        numerical libraries reserve far more than they use.

    Raises
    ------
    InvalidSettingError
        If a limit is not positive.
    """

    seconds: float = math.inf
    memory: float = math.inf

    def __post_init__(self) -> None:
        """Refuse what nothing could run in."""
        if not self.seconds > 0.0:
            raise InvalidSettingError("time limit", self.seconds, "a positive number of seconds")
        if not self.memory > 0.0:
            raise InvalidSettingError("memory limit", self.memory, "a positive number of bytes")


NO_LIMITS = Limits()

LONGEST = 1800.0
"""s: no case of the full suite takes a tenth of it."""


def sensible(workers: int) -> Limits:
    """Return limits for so many workers: a half hour each, and together not all of the memory.

    None is given less than a sound case needs. So of very many all could together take more than
    there is, if they all went to their limits; then the system ends one, and its case is done
    again.
    """
    share = _SHARE * available() / workers
    return Limits(seconds=LONGEST, memory=min(_MOST_MEMORY, max(_LEAST_MEMORY, share)))
