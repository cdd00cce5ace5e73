"""Evaluating many cases: on an executor, each once, from the store where they are kept."""

from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from operator import attrgetter

from harness.core.case import Case
from harness.core.simulation import Outcome
from harness.evaluation.case_cache import evaluation_cache
from harness.evaluation.evaluate import check_case, evaluate_case, failed_simulation
from harness.evaluation.evaluation import Evaluation
from harness.execution.cache import CacheFolder
from harness.execution.isolated_pool import SerialExecutor
from harness.execution.tasks import ProgressListener, run_tasks
from harness.execution.worker import LostTaskError


def run_cases(
    cases: Sequence[Case],
    executor: Executor | None = None,
    on_done: Callable[[Evaluation], None] | None = None,
    *,
    store: CacheFolder | None = None,
) -> tuple[Evaluation, ...]:
    """Evaluate cases, each once, and return them in the order given.

    Parameters
    ----------
    cases : sequence of Case
    executor : Executor, optional
        Where they run; here and one by one if left out.
    on_done : callable, optional
        Called with each evaluation as it is ready.
    store : CacheFolder, optional
        Cache of evaluations. A stored case is not run again, and has the same bits as if it were;
        its times are those that were measured when it ran.

    Raises
    ------
    HarnessError
        Before anything runs, if a case is wrong use; else as `evaluate_case` does.
    """
    for case in cases:
        check_case(case)
    return tuple(
        run_tasks(
            cases,
            evaluate_case,
            SerialExecutor() if executor is None else executor,
            lost=failed_evaluation,
            cache=None if store is None else evaluation_cache(store),
            listener=ProgressListener(done=lambda _, e, __: on_done(e)) if on_done else None,
            about=attrgetter("scene"),
        )
    )


def failed_evaluation(case: Case, error: LostTaskError) -> Evaluation:
    """Return the evaluation of a case whose process died or was stopped."""
    outcome = Outcome[error.loss.name]
    return Evaluation(simulation=failed_simulation(case, error.reason, outcome))
