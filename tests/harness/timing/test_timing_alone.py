"""Times are measured alone, repeated, and within limits; what an error run leaves."""

import fcntl
import os
import time
from concurrent.futures import ThreadPoolExecutor

import pytest

from harness.core.case import Case
from harness.evaluation.case_record import LOST, iterations, lost_errors
from harness.evaluation.timing import (
    FEWEST,
    aloft,
    lock_file,
    overhead,
    single_thread_executor,
    time_alone,
    timing_lock,
    untimed,
)
from harness.execution.limits import Limits
from harness.execution.worker import Loss, LostTaskError
from models import Scene
from tests.support.clock import stop_clock
from tests.support.evaluations import evaluated


def test_a_case_that_takes_its_process_along_is_named_and_not_timed(gentle: Scene) -> None:
    case = Case(scene=gentle, engine="mujoco", timestep=1e-4)
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
    with timing_lock(), lock_file().open("a") as other, pytest.raises(BlockingIOError):
        fcntl.flock(other, fcntl.LOCK_EX | fcntl.LOCK_NB)


def test_a_process_for_timing_has_one_thread() -> None:
    before = dict(os.environ)
    with single_thread_executor() as executor:
        assert executor.submit(os.getenv, "OPENBLAS_NUM_THREADS").result() == "1"
        assert executor.submit(os.getpid).result() != os.getpid()
        # no case's time is that of imports
        modules = "'harness.evaluation.timing' in __import__('sys').modules"
        assert executor.submit(eval, modules).result()
    assert dict(os.environ) == before


def test_a_repeat_that_hangs_is_stopped_and_the_next_is_timed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    clock = stop_clock(monkeypatch)
    with single_thread_executor(Limits(seconds=0.3)) as executor:  # for ten runs three
        hanging = executor.submit(time.sleep, 600.0)
        clock.run_until(hanging.done, 3.01)
        with pytest.raises(LostTaskError, match=r"longer than the 3 s allowed"):
            hanging.result()
        assert executor.submit(divmod, 7, 2).result() == (3, 1)


@pytest.mark.slow
def test_who_waits_for_another_to_time_is_not_stopped_for_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    clock = stop_clock(monkeypatch)
    with single_thread_executor(Limits(seconds=0.05)) as executor, ThreadPoolExecutor(1) as waiter:
        with timing_lock():
            waiting = waiter.submit(lambda: executor.submit(divmod, 7, 2).result())
            for _ in range(20):  # each time longer than a task may take
                clock.now += 1.0
                time.sleep(0.02)
            assert not waiting.done()
        assert waiting.result() == (3, 1)


@pytest.mark.slow
def test_two_tasks_of_one_program_are_not_at_once_either() -> None:
    with single_thread_executor() as executor:
        first = executor.submit(time.sleep, 0.3)
        second = executor.submit(divmod, 7, 2)
        assert first.done()
        assert second.result() == (3, 1)


@pytest.mark.parametrize("engine", ["mujoco", "pybullet"])
def test_solver_iterations_are_counted(engine: str, gentle: Scene) -> None:
    one = evaluated(gentle, engine, 1e-3)
    found = iterations(one.simulation)
    assert found is not None
    assert 1.0 <= found <= 50.0


def test_more_sweeps_are_more_iterations(gentle: Scene) -> None:
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
