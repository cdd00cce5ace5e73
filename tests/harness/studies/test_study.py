"""A study runs anywhere: rounds that follow from results, one cache, and an account of progress."""

from collections.abc import Iterable, Sequence
from contextlib import nullcontext
from pathlib import Path
from typing import Any

import pytest

from harness import run_study
from harness.core.case import Case
from harness.core.errors import UnknownEngineError
from harness.core.report_model import Artefact, Prose
from harness.execution.cache import CacheFolder
from harness.execution.cache_entry import Metadata
from harness.execution.estimate import read_speeds
from harness.execution.isolated_pool import SerialExecutor
from harness.execution.tasks import ResultCache
from harness.execution.worker import LostTaskError
from harness.studies.study import (
    EVALUATION,
    Job,
    Results,
    Study,
    StudyGroup,
    StudyProgress,
    Work,
    evaluation_jobs,
)
from models import Scene

RAN: list[float] = []


def squared(number: float) -> float:
    RAN.append(number)
    return number * number


def lost(number: float, error: LostTaskError) -> float:
    raise AssertionError(number, error)


def cache(store: CacheFolder) -> ResultCache[float, float]:
    return ResultCache(
        store=store,
        kind="squares",
        key=lambda number: f"{number:.17g}".replace(".", "-"),
        metadata=lambda _: Metadata(label=""),
    )


SQUARE: Work[float, float] = Work(
    name="squaring", call=squared, lost=lost, label=str, cache=cache, effort=lambda number: number
)


class Root:
    """Bisects for the square root of two."""

    name = "root of two"

    def next_jobs(self, done: Results) -> Iterable[Job[Any, Any]]:
        """Return the middle of the bracket, until the bracket is short."""
        known = done.of(SQUARE)
        low = max((x for x, square in known.items() if square <= 2.0), default=1.0)
        high = min((x for x, square in known.items() if square > 2.0), default=2.0)
        return [Job(SQUARE, x) for x in ((low + high) / 2.0,) if high - low > 1e-3]

    def report(self, done: Results) -> Sequence[Artefact]:
        """Return the nearest number that was tried."""
        best = min(done.of(SQUARE).items(), key=lambda pair: abs(pair[1] - 2.0))[0]
        return [Prose(name="summary", title=self.name, text=f"{best:.2f}")]


@pytest.fixture(autouse=True)
def _nothing_ran() -> None:
    RAN.clear()


def test_rounds_follow_from_what_is_known() -> None:
    study = Root()
    (said,) = study.report(run_study(study))
    assert isinstance(said, Prose)
    assert said.text == "1.41"
    assert len(RAN) == len(set(RAN)) == 10  # each halves the bracket: 2^-10 < 1e-3


def test_what_is_kept_is_not_run_again(tmp_path: Path) -> None:
    store = CacheFolder(folder=tmp_path)
    first = run_study(Root(), cache=store).of(SQUARE)
    RAN.clear()
    assert run_study(Root(), cache=store).of(SQUARE) == first
    assert not RAN


class Once:
    """Wants all at once, whatever is done."""

    name = "once"

    def __init__(self, jobs: Iterable[Job[Any, Any]]) -> None:
        self.jobs = list(jobs)

    def next_jobs(self, done: Results) -> Iterable[Job[Any, Any]]:
        """Return the same jobs whatever is done: those that are, are not run again."""
        del done
        return self.jobs

    def report(self, done: Results) -> Sequence[Artefact]:
        """Return nothing."""
        del done
        return []


class Foreseeing(Once):
    """Tells a job of a later round, which never comes."""

    def foreseen(self, done: Results) -> Iterable[Job[Any, Any]]:
        """Return the job that may come."""
        del done
        return [Job(SQUARE, 9.0)]


JOBS = [Job(SQUARE, 1.0)]


@pytest.mark.parametrize(
    ("study", "jobs"),
    [
        (Once(JOBS), 1),
        (Foreseeing(JOBS), 2),
        (StudyGroup(name="both", studies=(Once(JOBS), Foreseeing(JOBS))), 2),
    ],
    ids=["no foresight", "foresight", "group"],
)
def test_a_study_may_foresee_later_jobs_and_need_not(study: Study, jobs: int) -> None:
    left: list[int] = []
    run_study(study, on_progress=lambda progress: left.append(progress.estimate.tasks))
    assert left == [jobs, jobs - 1]


def test_long_jobs_begin_first_and_results_keep_the_order_asked() -> None:
    numbers = [2.0, 4.0, 1.0, 2.0]
    seen: list[StudyProgress] = []
    found = run_study(Once(Job(SQUARE, x) for x in numbers), on_progress=seen.append)
    assert RAN == [4.0, 2.0, 1.0]
    assert list(found.of(SQUARE)) == [2.0, 4.0, 1.0]
    assert [(p.label, p.done, p.total) for p in seen] == [
        ("", 0, 3),
        ("4.0", 1, 3),
        ("2.0", 2, 3),
        ("1.0", 3, 3),
    ]


def test_an_interrupted_study_goes_on_where_it_was(
    tmp_path: Path,
) -> None:
    store = CacheFolder(folder=tmp_path)
    jobs = [Job(SQUARE, float(number)) for number in range(4)]

    def stop(progress: StudyProgress) -> None:
        if progress.done == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt) as stopped:
        run_study(Once(jobs), cache=store, on_progress=stop)
    assert stopped.value.__notes__ == [f"2 of 4 are done and kept in '{store.folder}'."]
    assert read_speeds(store.folder)  # what was learnt of how long it takes
    first = list(RAN)
    RAN.clear()
    seen: list[StudyProgress] = []
    found = run_study(Once(jobs), cache=store, on_progress=seen.append).of(SQUARE)
    assert found == {0.0: 0.0, 1.0: 1.0, 2.0: 4.0, 3.0: 9.0}
    assert sorted(first + RAN) == [0.0, 1.0, 2.0, 3.0]
    assert {(p.kept, p.total) for p in seen} == {(2, 4)}
    assert seen[-1].done == 4


def test_a_job_alone_runs_on_the_timer() -> None:
    alone: Work[float, float] = Work(
        name="alone", call=squared, lost=lost, label=str, cache=cache, alone=True
    )
    given = []

    class Noted(SerialExecutor):
        def submit(self, *words: Any, **more: Any) -> Any:
            given.append(words[2])
            return super().submit(*words, **more)

    jobs = [Job(SQUARE, 1.0), Job(alone, 2.0)]
    found = run_study(Once(jobs), timer=lambda: nullcontext(Noted()))
    assert given == [2.0]
    assert found.of(alone) == {2.0: 4.0}


def test_wrong_use_is_refused_before_anything_runs(gentle: Scene) -> None:
    wrong = Case(scene=gentle, engine="nothing")
    with pytest.raises(UnknownEngineError):
        run_study(Once([Job(SQUARE, 1.0), *evaluation_jobs([wrong])]))
    assert not RAN


def test_every_run_has_an_entry_in_the_manifest(gentle: Scene) -> None:
    case = Case(scene=gentle, engine="reference")
    done = run_study(Once([Job(SQUARE, 1.0), *evaluation_jobs([case])]))
    (entry,) = done.manifest()
    version = done.of(EVALUATION)[case].simulation.engine_version
    assert entry["digest"] == case.digest(version)
    assert entry["outcome"].startswith("finished")
