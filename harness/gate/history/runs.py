"""What a history keeps of a run in a release: its row of the table of results, and no motion."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from harness.core.case import Case
from harness.core.errors import HarnessError
from harness.core.plain_json import to_plain
from harness.core.simulation import Outcome
from harness.evaluation.effort import engine_group, expected_seconds
from harness.evaluation.evaluate import evaluate_case, failed_simulation
from harness.evaluation.evaluation import Evaluation, Record
from harness.evaluation.run_cases import failed_evaluation
from harness.execution.worker import LostTaskError
from harness.results.scores import Score, identity, score_of_row
from harness.studies.comparison.tables import results
from harness.studies.study import Work, case_record, record_cache


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RunRow:
    """A run as a row of the table of results.

    Parameters
    ----------
    outcome : str
        Name of an `Outcome`.
    row : mapping
        By column.
    reason : str
        Why the adapter does not work with the release; empty if it does.
    record : mapping
        The entry of the run in the manifest of a report.
    """

    outcome: str
    row: Mapping[str, Any]
    reason: str
    record: Record

    def score(self, case: Case) -> Score | None:
        """Return the score of a case; None if the adapter does not work with the release."""
        if self.reason:
            return None
        return score_of_row(self.row, identity=identity(case), outcome=self.outcome)


def run_case(case: Case) -> RunRow:
    """Run a case; what the adapter refuses with a release has the reason in place of numbers."""
    try:
        return _row(evaluate_case(case))
    except HarnessError as error:  # the cases are a suite's: only the release can be at fault
        return _row(Evaluation(simulation=failed_simulation(case, str(error))))


def _lost(case: Case, error: LostTaskError) -> RunRow:
    """Return the row of a run whose process was lost."""
    return _row(failed_evaluation(case, error))


def _row(evaluation: Evaluation) -> RunRow:
    """Return the row of an evaluation."""
    simulation = evaluation.simulation
    (row,) = results((evaluation,)).frame.to_dict("records")
    return RunRow(
        outcome=simulation.outcome.name,
        row={str(name): to_plain(value) for name, value in row.items()},
        reason=simulation.note if simulation.outcome is Outcome.BROKEN else "",
        record=case_record(simulation),
    )


RUNNING: Work[Case, RunRow] = Work(
    name="running",
    call=run_case,
    lost=_lost,
    label=Case.label,
    cache=record_cache("rows", results.__module__),
    effort=expected_seconds,
    group=engine_group,
    manifest=lambda _, run: run.record,
)
"""Run a case in a release."""
