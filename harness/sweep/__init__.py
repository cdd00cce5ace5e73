"""Sweeps: many scenes that differ in a few parameters, a row of a table each."""

from harness.sweep.axes import Axis, read_axis
from harness.sweep.choice import SAMPLES
from harness.sweep.folder import Folder, opened
from harness.sweep.parameters import PARAMETERS, Parameter
from harness.sweep.partition import Part, compute
from harness.sweep.planning import Plan, plan
from harness.sweep.quantities import DEFAULT, QUANTITIES, Quantity
from harness.sweep.run import sweep
from harness.sweep.stated import PlanMismatchError

__all__ = [
    "DEFAULT",
    "PARAMETERS",
    "QUANTITIES",
    "SAMPLES",
    "Axis",
    "Folder",
    "Parameter",
    "Part",
    "Plan",
    "PlanMismatchError",
    "Quantity",
    "compute",
    "opened",
    "plan",
    "read_axis",
    "sweep",
]
