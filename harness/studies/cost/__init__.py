"""The study of cost: what accuracy costs in time, for each engine, and which settings buy it."""

from harness.studies.cost.design import SUITES, Plan, expected, plan, run, timed
from harness.studies.cost.reading import read
from harness.studies.cost.results import CHOICES, HERE, SHIPPED, TUNED, Cost, cost

__all__ = [
    "CHOICES",
    "HERE",
    "SHIPPED",
    "SUITES",
    "TUNED",
    "Cost",
    "Plan",
    "cost",
    "expected",
    "plan",
    "read",
    "run",
    "timed",
]
