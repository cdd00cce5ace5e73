"""Trials of what must not lose work: kills, fallen engines, full disks, signals, lost workers."""

from harness.faults.trial import Trial
from harness.faults.trials import TRIALS, Demands

__all__ = ["TRIALS", "Demands", "Trial"]
