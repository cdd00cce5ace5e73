"""The study of cost: what accuracy costs in time, for each engine, and which settings buy it."""

from harness.studies.cost.design import (
    SUITES,
    CostPlan,
    error_cases,
    expected,
    plan_cost,
    timing_cases,
)
from harness.studies.cost.report import cost_report
from harness.studies.cost.results import CHOICES, FIXED, FOLLOWING, HERE, SHIPPED, Cost, cost

__all__ = [
    "CHOICES",
    "FIXED",
    "FOLLOWING",
    "HERE",
    "SHIPPED",
    "SUITES",
    "Cost",
    "CostPlan",
    "cost",
    "cost_report",
    "error_cases",
    "expected",
    "plan_cost",
    "timing_cases",
]
