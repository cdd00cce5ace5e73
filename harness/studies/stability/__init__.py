"""The stability study: where an engine stops being usable, and how it fails."""

from harness.studies.stability.classify import classify
from harness.studies.stability.failure_criteria import ClassifiedRun, StabilityStatus
from harness.studies.stability.keeping import classified_cache, reference_check_cache
from harness.studies.stability.limits import by_scene, limits, next_round
from harness.studies.stability.report import stability_report
from harness.studies.stability.suite import SUITES, Suite, random_scenes, scenes, stability_cases
from harness.studies.stability.survey import ReferenceCheck, examine

__all__ = [
    "SUITES",
    "ClassifiedRun",
    "ReferenceCheck",
    "StabilityStatus",
    "Suite",
    "by_scene",
    "classified_cache",
    "classify",
    "examine",
    "limits",
    "next_round",
    "random_scenes",
    "reference_check_cache",
    "scenes",
    "stability_cases",
    "stability_report",
]
