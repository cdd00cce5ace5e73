"""The stability study: where an engine stops being usable, and how it fails."""

from harness.studies.stability.drawn import random_scenes
from harness.studies.stability.judge import judge
from harness.studies.stability.keeping import findings, verdicts
from harness.studies.stability.limits import by_scene, limits, next_round
from harness.studies.stability.plan import SUITES, Suite, design, scenes
from harness.studies.stability.reading import read
from harness.studies.stability.survey import Finding, examine
from harness.studies.stability.verdict import Judged, Verdict

__all__ = [
    "SUITES",
    "Finding",
    "Judged",
    "Suite",
    "Verdict",
    "by_scene",
    "design",
    "examine",
    "findings",
    "judge",
    "limits",
    "next_round",
    "random_scenes",
    "read",
    "scenes",
    "verdicts",
]
