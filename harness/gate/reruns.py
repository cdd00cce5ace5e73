"""Cases of a result, run again here and held against it by the rule of the gate.

What a number may differ by is measured here: the spread that a result states decides nothing, for
whoever wrote the numbers wrote the spread too. Which cases are run again is drawn when they are,
so that nobody can know it beforehand.
"""

import random
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
from harness.gate.spread import measured
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
    result: Result, on_top: EngineSettings, count: int | None = None, *, seed: int = 0
) -> tuple[tuple[Score, Case], ...]:
    """Return the cases that are run again, with settings on top.

    Parameters
    ----------
    result : Result
    on_top : mapping
        Its settings by engine and name.
    count : int, optional
        How many are drawn; all of them if left out.
    seed : int
        Of the draw. A submitter who knew it could know the cases.
    """
    absent, other = not_run_again(result, on_top), changed_scenes(result)
    designed = designed_cases(result)
    able = [
        (score, designed[score.identity])
        for score in sorted(result.cases, key=lambda score: score.digest)
        if score.identity in designed and score.engine not in absent and score.scene not in other
    ]
    count = len(able) if count is None else min(count, len(able))
    drawn = random.Random(seed).sample(range(len(able)), count)  # noqa: S311 - no secret of its own
    return tuple(
        (score, replace(case, options=(*case.options, *on_top.get(case.engine, {}).items())))
        for score, case in (able[place] for place in sorted(drawn))
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
        Called with the label of each run that is done: the cases, then perturbed runs of those that
        differ by more than round-off.
    """
    designed = designed_cases(result)
    scores = [score for score, _ in chosen]
    cases = {score.identity: case for score, case in chosen}
    on_done = None if listener is None else lambda e: listener(e.simulation.case.label())
    here = scored(
        [designed[score.identity] for score in scores],
        run_cases(tuple(cases.values()), executor, on_done),
        result.settings,
    )
    claimed = result.of_cases(map(_without_spread, scores))
    found = {d.identity for d in _differing(differences(claimed, result.of_cases(here)))}
    # a case that repeats within round-off needs no spread
    doubtful = [score for score in here if score.identity in found]
    own = measured([cases[score.identity] for score in doubtful], doubtful, executor, listener)
    claimed = claimed.of_cases(score for score in claimed.cases if score.identity in found)
    for difference in _differing(differences(claimed, result.of_cases(own))):
        yield Objection(
            rule=Rule.RERUN,
            case=difference.identity.label(),
            text=f"{SIDES.word(difference.status)}{change_words(difference)}",
        )


def _without_spread(score: Score) -> Score:
    """Return a score with its numbers alone."""
    return score.model_copy(update={"members": 0, "spread": {}, "endings": {}})


def _differing(compared: Sequence[Difference]) -> tuple[Difference, ...]:
    """Return the differences that the gate would name, and runs that ended early in two ways."""
    return (*changed(compared), *filter(_ended_otherwise, compared))


def _ended_otherwise(difference: Difference) -> bool:
    """Whether neither run reached its horizon, and they ended in two ways."""
    return difference.quantity == OUTCOME and difference.status is Status.NOT_JUDGED
