"""Cases of a result, run again here and held against it by the rule of the gate."""

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor
from dataclasses import replace

from harness.core.case import Case
from harness.core.errors import HarnessError
from harness.core.verdict import Status
from harness.engines.registry import engine_version, installed, names
from harness.evaluation.run_cases import run_cases
from harness.gate.comparison import OUTCOME, Difference, differences
from harness.gate.report import SIDES, change_words, changed
from harness.results.plausibility import (
    EngineSettings,
    Objection,
    Rule,
    changed_scenes,
    designed_cases,
)
from harness.results.result import Result
from harness.results.scores import Score, scored


def not_run_again(result: Result, on_top: EngineSettings) -> dict[str, str]:
    """Return the engines of a result whose cases cannot be run again here, each with the reason.

    Parameters
    ----------
    result : Result
    on_top : mapping
        Its settings by engine and name, as far as they are known here.
    """
    reasons = {}
    for name, engine in result.engines.items():
        if name not in names():
            reasons[name] = "no engine of that name is registered here"
        elif name not in installed():
            reasons[name] = "it is not installed here"
        elif reason := _other_version(name, engine.version):
            reasons[name] = reason
        elif name not in on_top and any(k.rpartition(".")[0] == name for k in result.settings):
            reasons[name] = "it does not have these settings here"
    return reasons


def _other_version(name: str, version: str) -> str:
    """Return why an engine is not here in a version; nothing if it is."""
    try:
        here = engine_version(name)
    except HarnessError as error:
        return str(error)
    return "" if here == version else f"its version is {version}, and {here} is installed here"


def sample(
    result: Result, on_top: EngineSettings, count: int | None = None
) -> tuple[tuple[Score, Case], ...]:
    """Return the cases that are run again, with settings on top.

    Parameters
    ----------
    result : Result
    on_top : mapping
        Its settings by engine and name.
    count : int, optional
        Those whose digests come first: neither the engine nor its submitter chooses them. All if
        left out.
    """
    absent, other = not_run_again(result, on_top), changed_scenes(result)
    designed = designed_cases(result)
    able = [
        (score, designed[score.identity])
        for score in sorted(result.cases, key=lambda score: score.digest)
        if score.identity in designed and score.engine not in absent and score.scene not in other
    ]
    return tuple(
        (score, replace(case, options=(*case.options, *on_top.get(case.engine, {}).items())))
        for score, case in able[:count]
    )


def rerun_objections(
    result: Result,
    chosen: Sequence[tuple[Score, Case]],
    executor: Executor,
    listener: Callable[[str], None] | None = None,
) -> Iterator[Objection]:
    """Run cases of a result again and yield every difference that the gate would name.

    Parameters
    ----------
    result : Result
    chosen : sequence of (Score, Case)
        From `sample`.
    executor : Executor
    listener : callable, optional
        Called with the label of each case that is done.
    """
    designed = designed_cases(result)
    scores, cases = [score for score, _ in chosen], [case for _, case in chosen]
    on_done = None if listener is None else lambda e: listener(e.simulation.case.label())
    here = result.of_cases(
        scored(
            [designed[score.identity] for score in scores],
            run_cases(cases, executor, on_done),
            result.settings,
        )
    )
    compared = differences(result.of_cases(scores), here)
    for difference in (*changed(compared), *filter(_ended_otherwise, compared)):
        yield Objection(
            rule=Rule.RERUN,
            case=difference.identity.label(),
            text=f"{SIDES.word(difference.status)}{change_words(difference)}",
        )


def _ended_otherwise(difference: Difference) -> bool:
    """Whether neither run reached its horizon, and they ended in two ways."""
    return difference.quantity == OUTCOME and difference.status is Status.NOT_JUDGED
