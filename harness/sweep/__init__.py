"""Sweeps: many scenes that differ in a few parameters, a row of a table each."""

from harness.sweep.axes import SAMPLES, Axis, read_axis
from harness.sweep.folder import Folder, opened
from harness.sweep.parameters import PARAMETERS, Parameter
from harness.sweep.partition import Partition, compute
from harness.sweep.plan import SweepPlan, plan_sweep
from harness.sweep.plan_file import PlanMismatchError
from harness.sweep.quantities import DEFAULT, QUANTITIES
from harness.sweep.run import run_sweep

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
