"""The study of the three errors: model form, discretisation, solver; and what is not decidable."""

from harness.studies.errors.plan import ErrorsPlan, errors_cases, plan_errors
from harness.studies.errors.report import ThreeErrors, errors_report, three_errors

__all__ = [
    "ErrorsPlan",
    "ThreeErrors",
    "errors_cases",
    "errors_report",
    "plan_errors",
    "three_errors",
]
