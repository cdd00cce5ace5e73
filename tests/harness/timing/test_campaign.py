"""Keeping, resuming, and an honest account of what is left."""

import fcntl
import os
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest

from harness.core.case import Case
from harness.evaluation.case_record import LOST, iterations, lost_errors
from harness.evaluation.step_overhead import case as aloft
from harness.evaluation.step_overhead import overhead
from harness.evaluation.timed_tasks import Spent, TaskProgress, Timed, records, run_timed_tasks
from harness.evaluation.timing import (
    FEWEST,
    LOCK,
    single_thread_executor,
    time_alone,
    timing_lock,
    untimed,
)
from harness.execution.cache import CacheFolder
from harness.execution.isolated_pool import SerialExecutor
from harness.execution.limits import Limits
from harness.execution.tasks import ResultCache
from harness.execution.worker import Loss, LostTaskError
from models import Scene

Evaluator = Callable[..., Any]


def cases(scene: Scene, count: int) -> list[Case]:
    return [Case(scene=scene, engine="mujoco", timestep=1e-4 * (n + 1)) for n in range(count)]


def size(case: Case) -> float:
    return 1.0 / (case.timestep or 1.0)


Kept = ResultCache[Case, Timed]


@pytest.fixture
def shelf(tmp_path: Path) -> Kept:
    """Return where records are kept."""
    return records(CacheFolder(folder=tmp_path / "store"), "toys", __name__)


def failed(case: Case, error: LostTaskError) -> dict[str, Any]:
    raise AssertionError(case, error)


def test_an_interrupted_campaign_goes_on_where_it_was(gentle: Scene, shelf: Kept) -> None:
    done: list[Case] = []
    wanted = cases(gentle, 4)

    def work(case: Case) -> dict[str, Any]:
        if len(done) == 2:
            raise KeyboardInterrupt
        done.append(case)
        return {"timestep": case.timestep, "times": [1.0, 2.0], "pair": (1, None)}

    def complete_with(work: Callable[[Case], dict[str, Any]]) -> dict[Case, dict[str, Any]]:
        return run_timed_tasks(wanted, work, shelf, SerialExecutor(), lost=failed, expected=size)

    with pytest.raises(KeyboardInterrupt) as stopped:
        complete_with(work)
    assert stopped.value.__notes__ == [f"2 of 4 are done and kept in '{shelf.store.folder}'."]
    first, done = done, []
    kept = complete_with(work)
    assert set(first) | set(done) == set(wanted)
    assert not set(first) & set(done)
    nothing: list[Case] = []

    def never(case: Case) -> dict[str, Any]:
        nothing.append(case)
        return {}

    again = complete_with(never)
    assert list(again) == wanted
    assert again == kept
    assert [kept[case] for case in wanted] == [
        {"timestep": case.timestep, "times": [1.0, 2.0], "pair": (1, None)} for case in wanted
    ]
    assert nothing == []


def test_what_is_left_goes_with_the_work_that_is_left(gentle: Scene) -> None:
    left = {case: float(n + 1) for n, case in enumerate(cases(gentle, 4))}
    spent = Spent(left, workers=2)
    spent.add(next(iter(left)), 0.5)  # a unit took half a second: 9 units are left, two at once
    assert spent.remaining() == pytest.approx(9 * 0.5 / 2)


def test_progress_counts_what_was_kept_before(gentle: Scene, shelf: Kept) -> None:
    told, kept = list[TaskProgress](), list[tuple[int, int]]()
    wanted = cases(gentle, 3)
    run_timed_tasks(wanted[:1], lambda _: {}, shelf, SerialExecutor(), lost=failed, expected=size)
    run_timed_tasks(
        wanted,
        lambda _: {},
        shelf,
        SerialExecutor(),
        lost=failed,
        expected=size,
        on_done=told.append,
        on_kept=lambda *counts: kept.append(counts),
    )
    assert kept == [(1, 3)]
    assert [p.done for p in told] == [2, 3]
    assert {p.total for p in told} == {3}
    assert told[-1].remaining_s == 0.0


def test_a_case_that_takes_its_process_along_is_named_and_not_timed(gentle: Scene) -> None:
    case = cases(gentle, 1)[0]
    error = LostTaskError(Loss.CRASHED, "killed: SIGSEGV, segmentation fault")
    record = lost_errors(case, error)
    assert record["outcome"] in LOST
    assert record["note"] == "killed: SIGSEGV, segmentation fault"
    assert untimed(case, error)["cpu_s"] == []


def test_timing_repeats_and_leaves_setup_out(gentle: Scene) -> None:
    found = time_alone(Case(scene=gentle, engine="mujoco", timestep=1e-4))
    assert len(found["cpu_s"]) == len(found["wall_s"]) >= FEWEST
    assert all(seconds > 0.0 for seconds in found["cpu_s"])
    assert found["setup_s"] > 0.0
    exact = time_alone(Case(scene=gentle, engine="reference"))
    assert exact["setup_s"] == 0.0


def test_two_never_time_at_once() -> None:
    with timing_lock(), LOCK.open("a") as other, pytest.raises(BlockingIOError):
        fcntl.flock(other, fcntl.LOCK_EX | fcntl.LOCK_NB)


def test_a_process_for_timing_has_one_thread() -> None:
    before = dict(os.environ)
    with single_thread_executor() as executor:
        assert executor.submit(os.getenv, "OPENBLAS_NUM_THREADS").result() == "1"
        assert executor.submit(os.getpid).result() != os.getpid()
    assert dict(os.environ) == before


def test_a_repeat_that_hangs_is_stopped_and_the_next_is_timed() -> None:
    # for ten runs three seconds: of which a sound task, on a machine that stalls, needs few
    with single_thread_executor(Limits(seconds=0.3)) as executor:
        hanging = executor.submit(time.sleep, 600.0)
        with pytest.raises(LostTaskError, match=r"longer than the 3 s allowed"):
            hanging.result()
        assert executor.submit(divmod, 7, 2).result() == (3, 1)


def test_who_waits_for_another_to_time_is_not_stopped_for_it() -> None:
    with single_thread_executor(Limits(seconds=0.05)) as executor, ThreadPoolExecutor(1) as waiter:
        with timing_lock():
            waiting = waiter.submit(lambda: executor.submit(divmod, 7, 2).result())
            time.sleep(1.0)  # twice as long as a task may take
            assert not waiting.done()
        assert waiting.result() == (3, 1)


def test_two_tasks_of_one_program_are_not_at_once_either() -> None:
    with single_thread_executor() as executor:
        first = executor.submit(time.sleep, 0.3)
        second = executor.submit(divmod, 7, 2)
        assert first.done()
        assert second.result() == (3, 1)


@pytest.mark.parametrize("engine", ["mujoco", "pybullet"])
def test_solver_iterations_are_counted(engine: str, gentle: Scene, evaluated: Evaluator) -> None:
    one = evaluated(gentle, engine, 1e-3)
    found = iterations(one.simulation)
    assert found is not None
    assert 1.0 <= found <= 50.0


def test_more_sweeps_are_more_iterations(gentle: Scene, evaluated: Evaluator) -> None:
    few = iterations(evaluated(gentle, "pybullet", 1e-3, numSolverIterations=2).simulation)
    many = iterations(evaluated(gentle, "pybullet", 1e-3).simulation)
    assert few is not None
    assert many is not None
    assert few <= 2.0 < many


@pytest.mark.parametrize("engine", ["mujoco", "pybullet"])
def test_overhead_of_a_free_body(engine: str, gentle: Scene) -> None:
    ways = overhead(aloft(gentle, engine))["ways"]
    assert len(ways) >= 2
    for taken in ways.values():
        # no engine steps one body in less than 10 ns, none takes a millisecond
        assert all(1e-8 < seconds < 1e-3 for seconds in taken)
