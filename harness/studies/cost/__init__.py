"""The study of cost: what accuracy costs in time, for each engine, and which settings buy it."""

from harness.studies.cost.design import SUITES, Plan, expected, plan, run, timed
from harness.studies.cost.reading import read
from harness.studies.cost.results import CHOICES, FIXED, FOLLOWING, HERE, SHIPPED, Cost, cost

__all__ = [
    "CHOICES",
    "FIXED",
    "FOLLOWING",
    "HERE",
    "SHIPPED",
    "SUITES",
    "Cost",
    "Plan",
    "cost",
    "expected",
    "plan",
    "read",
    "run",
    "timed",
]
