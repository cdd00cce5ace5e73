"""Tasks in processes of their own: what one does is its own outcome, and the others go on."""

import math
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from concurrent.futures import wait
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from harness.core.errors import InvalidSettingError, UnknownEngineError
from harness.execution.isolated_pool import (
    IsolatedProcessPool,
    SerialExecutor,
    local_executor,
    run_isolated,
)
from harness.execution.limits import Limits
from harness.execution.worker import Loss, LostTaskError
from tests.faults.programs import left_behind, living
from tests.support.clock import stop_clock, wait_for

if TYPE_CHECKING:
    from concurrent.futures import Future

from tests.harness.isolation import slow_to_import
from tests.harness.isolation import worker_tasks as tasks

_LIMITS = Limits(seconds=8.0, memory=0.5 * 2**30)
"""Seconds of a clock that the test lets go on, where it matters."""

_FATES: dict[Callable[[], Any], tuple[Loss, str]] = {
    tasks.segfault: (Loss.CRASHED, "killed: SIGSEGV, segmentation fault"),
    tasks.leave: (Loss.CRASHED, "killed: the engine left its process with code 3"),
    tasks.be_killed: (Loss.STOPPED, "killed: SIGKILL from outside, as the system does"),
    tasks.hang: (Loss.HUNG, "killed: it ran longer than the 8 s allowed"),
    tasks.devour: (Loss.OUT_OF_MEMORY, "killed: it used more than the 0.5 GiB allowed"),
}


@pytest.fixture(scope="module")
def pool() -> Iterator[IsolatedProcessPool]:
    """Return an executor of two processes."""
    with IsolatedProcessPool(2, _LIMITS) as executor:
        yield executor


def loss_of(future: "Future[Any]") -> LostTaskError:
    with pytest.raises(LostTaskError) as caught:
        future.result()
    return caught.value


def test_each_falls_by_itself_and_is_named(
    pool: IsolatedProcessPool, monkeypatch: pytest.MonkeyPatch
) -> None:
    clock = stop_clock(monkeypatch)
    doomed = {task: pool.submit(task) for task in _FATES}
    others = [pool.submit(tasks.square, number) for number in range(6)]
    assert [future.result() for future in others] == [n * n for n in range(6)]
    wait([doomed[task] for task in _FATES if task is not tasks.hang])
    clock.run_until(doomed[tasks.hang].done, 8.01)
    for task, (loss, words) in _FATES.items():
        error = loss_of(doomed[task])
        assert (error.loss, str(error)[: len(words)]) == (loss, words)


def test_processes_are_used_again(pool: IsolatedProcessPool) -> None:
    first = {pool.submit(tasks.process).result() for _ in range(6)}
    assert 1 <= len(first) <= 2
    assert os.getpid() not in first


def test_a_process_takes_what_it_knows_then_what_nobody_does(tmp_path: Path) -> None:
    told, gates = tmp_path / "told", {name: tmp_path / name for name in "ab"}
    with IsolatedProcessPool(2, _LIMITS) as executor:
        held = {}
        for topic, gate in gates.items():
            first = executor.submit_about(topic, tasks.wait_and_tell, gate, told, topic)
            while not first.running():
                time.sleep(0.01)
            held[topic] = first
        left = [
            executor.submit_about(None if topic == "-" else topic, tasks.tell, told, topic + number)
            for topic, number in ("b1", "c1", "-1", "a1", "c2", "a2", "d1", "b2", "-2")
        ]
        gates["a"].touch()
        for future in left:
            future.result()
        assert not held["b"].done()
        gates["b"].touch()
    order = told.read_text(encoding="ascii").split()
    assert order == ["a", "a1", "a2", "c1", "c2", "-1", "d1", "-2", "b1", "b2", "b"]


def test_a_new_process_knows_nothing(tmp_path: Path) -> None:
    told, gate = tmp_path / "told", tmp_path / "gate"
    with IsolatedProcessPool(1, _LIMITS) as executor:
        held = executor.submit_about("-", tasks.wait_and_tell, gate, told, "-")
        while not held.running():
            time.sleep(0.01)
        lost = executor.submit_about("a", tasks.be_killed)
        for name in ("a", "b"):
            executor.submit_about(name, tasks.tell, told, name)
        gate.touch()
        assert loss_of(lost).loss is Loss.STOPPED
    assert told.read_text(encoding="ascii").split() == ["-", "b", "a"]


def test_errors_come_back_as_what_they_are(pool: IsolatedProcessPool) -> None:
    with pytest.raises(ZeroDivisionError, match="on purpose") as caught:
        pool.submit(tasks.fail).result()
    assert "in fail" in caught.value.__notes__[0]
    with pytest.raises(UnknownEngineError) as unknown:
        pool.submit(tasks.refuse).result()
    assert (unknown.value.name, unknown.value.available) == ("ode", ("mujoco",))
    # an error that cannot be made again of its arguments comes as the nearest kind that can
    stubborn = pool.submit(tasks.fail_stubbornly).exception()
    assert (type(stubborn), str(stubborn)) == (RuntimeError, "StubbornError: as it does")
    unsent = pool.submit(tasks.unsendable).exception()
    assert (type(unsent), "lambda" in str(unsent)) == (AttributeError, True)
    assert pool.submit(tasks.square, 3).result() == 9


def test_after_an_error_it_stops_at_once() -> None:
    class Enough(Exception):  # noqa: N818
        pass

    began = time.monotonic()
    given: list[Future[Any]] = []

    def interrupted() -> None:
        with IsolatedProcessPool(1, _LIMITS) as executor:
            given.append(executor.submit(tasks.nap, 600.0))
            given.append(executor.submit(tasks.square, 2))
            while not given[0].running():
                time.sleep(0.01)
            raise Enough

    with pytest.raises(Enough):
        interrupted()
    running, waiting = given
    assert time.monotonic() - began < 60.0
    assert waiting.cancelled()
    assert loss_of(running).loss is Loss.STOPPED


def test_what_is_shut_down_takes_no_more_and_ends_what_it_has() -> None:
    executor = IsolatedProcessPool(1, _LIMITS)
    future = executor.submit(tasks.square, 4)
    executor.shutdown()
    assert future.result() == 16
    with pytest.raises(RuntimeError, match="takes no more"):
        executor.submit(tasks.square, 4)


_OWNER = """
import sys, time
sys.path[:] = {path!r}
from tests.harness.isolation import worker_tasks as tasks
from harness.execution.isolated_pool import IsolatedProcessPool
executor = IsolatedProcessPool(1)
executor.submit(tasks.process).result()
executor.submit(tasks.hang)
print("at work", flush=True)
time.sleep(600.0)
"""


def test_a_process_ends_with_its_owner() -> None:
    owner = subprocess.Popen(  # noqa: S603 - our own program
        [sys.executable, "-c", _OWNER.format(path=sys.path)],
        stdout=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    assert owner.stdout is not None
    assert owner.stdout.readline() == "at work\n"
    assert len(living(owner.pid)) == 2
    owner.kill()
    owner.communicate()
    assert left_behind(owner.pid) == 0


def test_inside_is_a_process_beside_this_one_that_stays() -> None:
    first = run_isolated(_LIMITS, tasks.process)
    assert first != os.getpid()
    assert run_isolated(_LIMITS, tasks.process) == first
    with pytest.raises(LostTaskError) as caught:
        run_isolated(_LIMITS, tasks.segfault)
    assert caught.value.loss is Loss.CRASHED
    assert "SIGSEGV" in caught.value.reason
    assert run_isolated(_LIMITS, tasks.process) != first


@pytest.fixture
def slow_import(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[], None]:
    """Return a function that lets a module be imported for longer than its task is given."""
    monkeypatch.setenv("SLOW_TO_IMPORT", str(tmp_path))
    clock = stop_clock(monkeypatch)

    def import_slowly() -> None:
        wait_for(tmp_path / "begun")
        clock.now += 3.0
        (tmp_path / "go-on").touch()

    return import_slowly


def test_a_process_imports_the_modules_of_its_first_task_before_the_clock_runs(
    slow_import: Callable[[], None],
) -> None:
    with IsolatedProcessPool(1, Limits(seconds=2.0)) as executor:
        answer = executor.submit(slow_to_import.answer)
        slow_import()
        assert answer.result() == 42
        assert executor.submit(tasks.square, 3).result() == 9


def test_the_module_of_a_function_among_the_arguments_is_one_of_them(
    slow_import: Callable[[], None],
) -> None:
    # as a task of a cluster hands its function over
    with IsolatedProcessPool(1, Limits(seconds=2.0)) as executor:
        answer = executor.submit(tasks.called, slow_to_import.answer)
        slow_import()
        assert answer.result() == 42


def test_what_cannot_be_started_is_told_and_the_next_is_done(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise BlockingIOError("no process left")

    with IsolatedProcessPool(1, _LIMITS) as executor:
        with monkeypatch.context() as patched:
            patched.setattr(subprocess, "Popen", refuse)
            with pytest.raises(LostTaskError, match=r"never begun.*no process left"):
                executor.submit(tasks.square, 3).result(timeout=30.0)
        assert executor.submit(tasks.square, 3).result(timeout=30.0) == 9


def test_signals_that_end_a_run_are_its_owners_and_not_a_tasks(pool: IsolatedProcessPool) -> None:
    assert pool.submit(tasks.outlive_signals).result() == "went on"
    assert pool.submit(tasks.end_helpers).result() == [-signal.SIGTERM] * 2
    assert pool.submit(tasks.end_a_fork).result() == -signal.SIGTERM


_ASKING = """
import os, sys
sys.path[:] = {path!r}
from tests.harness.isolation import worker_tasks as tasks
from harness.execution.isolated_pool import end_background_worker, run_isolated
from harness.execution.limits import NO_LIMITS
run_isolated(NO_LIMITS, tasks.start_and_return, {told!r})
{end}
"""


@pytest.mark.parametrize("end", ["", "end_background_worker(); os._exit(0)"])
def test_what_is_beside_a_program_ends_with_it(end: str, tmp_path: Path) -> None:
    told = tmp_path / "told"
    program = subprocess.Popen(  # noqa: S603 - our own program
        [sys.executable, "-c", _ASKING.format(path=sys.path, told=str(told), end=end)],
        start_new_session=True,
    )
    assert program.wait(timeout=60.0) == 0
    assert len(told.read_text(encoding="ascii").split()) == 2
    assert left_behind(program.pid) == 0


def test_limits_that_nothing_could_run_in_are_refused() -> None:
    for limits in ({"seconds": 0.0}, {"memory": -1.0}, {"seconds": math.nan}):
        with pytest.raises(InvalidSettingError) as caught:
            Limits(**limits)
        assert caught.value.name == ("time limit" if "seconds" in limits else "memory limit")


def test_one_job_is_a_process_of_its_own_where_that_is_asked_for() -> None:
    assert isinstance(local_executor(1), SerialExecutor)
    with local_executor(1, spawned=True) as executor:
        assert isinstance(executor, IsolatedProcessPool)


def test_the_clock_of_a_task_stands_while_an_engine_compiles_itself() -> None:
    said: list[str] = []
    with IsolatedProcessPool(1, Limits(seconds=1.0)) as pool:
        pool.on_compiling = said.append
        assert pool.submit(tasks.compile_for, 1.5, 0.1).result() == 1.6
        assert said == ["toy"]
        # and goes on afterwards
        assert loss_of(pool.submit(tasks.compile_for, 0.1, 30.0)).loss is Loss.HUNG
        assert pool.submit(tasks.square, 3).result() == 9
