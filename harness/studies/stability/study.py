"""The stability study: where an engine stops being usable, how it fails, and how the truth fares.

Engines run a map, a grid of timesteps for each hard case, and then rounds of a search for the
largest usable timestep; the reference is solved in two ways on the same cases and on random ones.
"""

from dataclasses import dataclass
from typing import Any

from harness.core.case import Case
from harness.core.report_model import Artefact
from harness.evaluation.evaluate import check_case, evaluate_case, failed_evaluation
from harness.execution.worker import LostTaskError
from harness.studies.stability.failure_criteria import ClassifiedRun, classify
from harness.studies.stability.limits import by_scene, limits, next_round
from harness.studies.stability.report import stability_report
from harness.studies.stability.suite import Suite, random_scenes, scenes, stability_cases
from harness.studies.stability.survey import EXAMINING, Part, ReferenceCheck
from harness.studies.study import Job, Results, Work, case_record, record_cache

classified_cache = record_cache("verdicts", classify.__module__)
"""Returns the cache of the verdicts on runs."""


def _classified(case: Case) -> ClassifiedRun:
    return classify(evaluate_case(case))


def _lost(case: Case, error: LostTaskError) -> ClassifiedRun:
    return classify(failed_evaluation(case, error))


CLASSIFYING: Work[Case, ClassifiedRun] = Work(
    name="hard cases",
    call=_classified,
    lost=_lost,
    label=Case.label,
    cache=classified_cache,
    check=check_case,
    manifest=lambda _, run: case_record(run.simulation) | {"verdict": run.verdict.value},
)
"""Run a case and classify it, without its motion, so that thousands of results fit into a cache."""

_SHARE = 100
"""Random scenes in a task: one takes some 50 ms."""


@dataclass(frozen=True, slots=True, kw_only=True)
class StabilityStudy:
    """Run hard cases until engines fail.

    Parameters
    ----------
    suite : Suite
        One of `harness.studies.stability.suite.SUITES`.
    engines : tuple of str
        That take timesteps.
    """

    suite: Suite
    engines: tuple[str, ...]

    @property
    def name(self) -> str:
        """Title of the study."""
        return f"stability, {self.suite.name} suite"

    def next_jobs(self, done: Results) -> list[Job[Any, Any]]:
        """Return the map and the scenes of the reference, and what the searches want next."""
        runs = list(done.of(CLASSIFYING).values())
        if runs:
            further = next_round(self.suite, self.engines, by_scene(runs))
            return [Job(CLASSIFYING, case) for case in further]
        cases = stability_cases(self.suite, self.engines)
        return [
            *(Job(CLASSIFYING, case) for case in cases),
            *(Job(EXAMINING, part) for parts in self._parts() for part in parts),
        ]

    def _parts(self) -> tuple[list[Part], list[Part]]:
        """Return the hard cases and the random scenes in parts of one task each."""
        drawn = tuple(random_scenes(self.suite.random_scenes))
        hard, random = (
            [chosen[start : start + _SHARE] for start in range(0, len(chosen), _SHARE)]
            for chosen in (scenes(self.suite), drawn)
        )
        return hard, random

    def checks(self, done: Results) -> tuple[list[ReferenceCheck], list[ReferenceCheck]]:
        """Return how the reference fares on the hard cases and on random scenes."""
        found = done.of(EXAMINING)
        hard, random = ([check for part in own for check in found[part]] for own in self._parts())
        return hard, random

    def report(self, done: Results) -> tuple[Artefact, ...]:
        """Return words, maps and tables."""
        runs = list(done.of(CLASSIFYING).values())
        largest = limits(self.suite, self.engines, by_scene(runs))
        return stability_report(self.suite, runs, largest, *self.checks(done))
