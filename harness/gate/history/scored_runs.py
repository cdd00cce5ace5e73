"""Running a case in a release and scoring it, where the case runs: what a history keeps of a run."""

from dataclasses import dataclass

from harness.core.case import Case
from harness.core.errors import HarnessError
from harness.core.simulation import Outcome
from harness.evaluation.effort import engine_group, expected_seconds
from harness.evaluation.evaluate import evaluate_case, failed_simulation
from harness.evaluation.evaluation import Record
from harness.evaluation.run_cases import failed_evaluation
from harness.execution.worker import LostTaskError
from harness.gate.scores import Score, scored
from harness.studies.study import Work, case_record, record_cache


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ScoredRun:
    """The score of a run, without its motion: a history has thousands of runs.

    Parameters
    ----------
    score : Score or None
        None if the adapter does not work with the release.
    reason : str
        Why it does not.
    record : mapping
        The entry of the run in the manifest of a report.
    """

    score: Score | None
    reason: str = ""
    record: Record


def score_case(case: Case) -> ScoredRun:
    """Run a case and return its score; of a release that the adapter does not know, the reason."""
    try:
        evaluation = evaluate_case(case)
    except HarnessError as error:
        failed = failed_simulation(case, str(error))
        return ScoredRun(score=None, reason=str(error), record=case_record(failed))
    record = case_record(evaluation.simulation)
    if evaluation.simulation.outcome is Outcome.BROKEN:
        return ScoredRun(score=None, reason=evaluation.simulation.note, record=record)
    (score,) = scored((case,), (evaluation,))
    return ScoredRun(score=score, record=record)


def _lost(case: Case, error: LostTaskError) -> ScoredRun:
    """Return the score of a run whose process was lost."""
    evaluation = failed_evaluation(case, error)
    (score,) = scored((case,), (evaluation,))
    return ScoredRun(score=score, record=case_record(evaluation.simulation))


SCORING: Work[Case, ScoredRun] = Work(
    name="running",
    call=score_case,
    lost=_lost,
    label=Case.label,
    cache=record_cache("scores", __name__),
    effort=expected_seconds,
    group=engine_group,
    manifest=lambda _, run: run.record,
)
"""Run a case in a release and score it."""
