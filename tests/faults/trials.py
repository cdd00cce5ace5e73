"""The trials in their order."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType

from tests.faults.interruptions import disk, kills, signals
from tests.faults.sweeps import Sizes, sweeps
from tests.faults.trial import Trial
from tests.faults.workers import deadly, lost_worker


@dataclass(frozen=True, slots=True, kw_only=True)
class Demands:
    """How much is demanded.

    Parameters
    ----------
    kills : int
    sweeps : Sizes
    """

    kills: int = 50
    sweeps: Sizes = field(default_factory=Sizes)


Told = Callable[[str], None]

TRIALS: Mapping[str, Callable[[Demands, Path, Told], Trial]] = MappingProxyType(
    {
        # what is timed comes first, while the machine is as quiet as it was found
        "sweeps": lambda demands, folder, told: sweeps(demands.sweeps, folder, told),
        "kills": lambda demands, folder, told: kills(demands.kills, folder, told),
        "engines": lambda _, folder, told: deadly(folder, told),
        "disk": lambda _, folder, told: disk(folder, told),
        "signals": lambda _, folder, told: signals(folder, told),
        "worker": lambda _, folder, told: lost_worker(folder, told),
    }
)
"""By the names under which one is asked for alone."""


_A_KILL = 14.6
"""s between two kills: of a suite that goes on where it was."""


def usual_seconds(demands: Demands) -> dict[str, float]:
    """Return how long each trial takes on a quiet machine, s: see faults.md."""
    return {
        "sweeps": 159.0,
        "kills": _A_KILL * demands.kills,
        "engines": 29.0,
        "disk": 27.0,
        "signals": 73.0,
        "worker": 19.0,
    }
