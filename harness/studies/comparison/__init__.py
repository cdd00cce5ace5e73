"""The comparison study: every engine on every scene, as it ships and as well as it can be run."""

from harness.studies.comparison.report import comparison_report
from harness.studies.comparison.suite import SUITES, Unsupported, split_unsupported, suite_cases
from harness.studies.comparison.tables import results

__all__ = [
    "SUITES",
    "Unsupported",
    "comparison_report",
    "results",
    "split_unsupported",
    "suite_cases",
]
