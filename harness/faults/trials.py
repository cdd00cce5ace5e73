"""The trials in their order."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from harness.faults.deadly import deadly
from harness.faults.disk import disk
from harness.faults.kills import kills
from harness.faults.lost_worker import lost_worker
from harness.faults.signals import signals
from harness.faults.trial import Trial


@dataclass(frozen=True, slots=True, kw_only=True)
class Demands:
    """How much is demanded.

    Parameters
    ----------
    kills : int
    """

    kills: int = 50


Told = Callable[[str], None]

TRIALS: tuple[Callable[[Demands, Path, Told], Trial], ...] = (
    lambda demands, folder, told: kills(demands.kills, folder, told),
    lambda _, folder, told: deadly(folder, told),
    lambda _, folder, told: disk(folder, told),
    lambda _, folder, told: signals(folder, told),
    lambda _, folder, told: lost_worker(folder, told),
)
