"""Trials of what must not lose work: kills, fallen engines, full disks, signals, lost workers.

And of what must stay quick: sweeps of a million releases.
"""

from tests.faults.trial import Trial
from tests.faults.trials import TRIALS, Demands

__all__ = ["TRIALS", "Demands", "Trial"]
