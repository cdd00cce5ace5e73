"""Sweeps: many scenes that differ in a few parameters, a row of a table each."""

from harness.sweep.axes import SAMPLES, Axis, read_axis
from harness.sweep.folder import Folder, PlanMismatchError, opened
from harness.sweep.parameters import PARAMETERS, Parameter
from harness.sweep.partition import Partition, compute
from harness.sweep.plan import SweepPlan, plan_sweep
from harness.sweep.run import run_sweep
from harness.sweep.values import DEFAULT, QUANTITIES

__all__ = [
    "DEFAULT",
    "PARAMETERS",
    "QUANTITIES",
    "SAMPLES",
    "Axis",
    "Folder",
    "Parameter",
    "Partition",
    "PlanMismatchError",
    "SweepPlan",
    "compute",
    "opened",
    "plan_sweep",
    "read_axis",
    "run_sweep",
]
