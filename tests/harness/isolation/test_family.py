"""What a task starts is weighed with it, and does not outlive it."""

import os
import signal
import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import pytest

from harness.execution.isolated_pool import IsolatedProcessPool
from harness.execution.limits import Limits
from harness.execution.worker import Loss, LostTaskError
from tests.harness.isolation import worker_tasks as tasks
from tests.support.clock import stop_clock, wait_for

_SHORT = Limits(seconds=4.0)
"""Of a clock that the test lets go on."""

_SMALL = Limits(memory=0.3 * 2**30)
"""Less than a child takes, and than two processes hold together that share most of it."""


@pytest.fixture
def told(tmp_path: Path) -> Iterator[Path]:
    """Return a file in which a task tells which process it started; that ends with the test."""
    file = tmp_path / "child"
    yield file
    if file.exists() and runs(child := number(file)):
        os.kill(child, signal.SIGKILL)


def number(file: Path) -> int:
    return int(file.read_text(encoding="ascii").split()[0])


def runs(process: int) -> bool:
    """Whether a process runs; one that ended and that nobody waits for does not."""
    with suppress(OSError):
        told = Path(f"/proc/{process}/stat").read_text(encoding="utf-8")
        return told.rpartition(")")[2].split()[0] not in "ZX"
    return False


def ended(process: int) -> bool:
    """Whether a process is gone; two minutes are more than a busy machine takes."""
    until = time.monotonic() + 120.0
    while runs(process) and time.monotonic() < until:
        time.sleep(0.02)
    return not runs(process)


@pytest.mark.parametrize("apart", [False, True])
def test_what_a_hanging_task_started_ends_with_it(
    told: Path, monkeypatch: pytest.MonkeyPatch, *, apart: bool
) -> None:
    clock = stop_clock(monkeypatch)
    with IsolatedProcessPool(1, _SHORT) as executor:
        hanging = executor.submit(tasks.start_and_hang, str(told), apart=apart)
        wait_for(told)
        clock.run_until(hanging.done, 4.01)
    lost = hanging.exception()
    assert isinstance(lost, LostTaskError)
    assert lost.loss is Loss.HUNG
    assert ended(number(told))


def test_a_task_that_leaves_its_group_and_hangs_is_ended(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    clock = stop_clock(monkeypatch)
    with IsolatedProcessPool(1, _SHORT) as executor:
        hanging = executor.submit(tasks.leave_the_group_and_hang, str(tmp_path / "left"))
        wait_for(tmp_path / "left")
        clock.run_until(hanging.done, 4.01)
    lost = hanging.exception()
    assert isinstance(lost, LostTaskError)
    assert lost.loss is Loss.HUNG


def test_what_a_crashing_task_started_ends_with_it(told: Path) -> None:
    with IsolatedProcessPool(1) as executor, pytest.raises(LostTaskError) as caught:
        executor.submit(tasks.start_and_crash, str(told)).result()
    assert caught.value.loss is Loss.CRASHED
    assert "SIGSEGV" in caught.value.reason
    assert ended(number(told))


def test_what_a_task_left_stays_as_long_as_its_worker(told: Path) -> None:
    with IsolatedProcessPool(1) as executor:
        assert executor.submit(tasks.start_and_return, str(told)).result() == 1
        assert executor.submit(tasks.square, 3).result() == 9
        assert runs(number(told))
    assert ended(number(told))


def test_what_a_task_started_is_weighed_with_it(told: Path) -> None:
    with IsolatedProcessPool(1, _SMALL) as executor, pytest.raises(LostTaskError) as caught:
        executor.submit(tasks.start_one_that_devours, str(told)).result()
    assert caught.value.loss is Loss.OUT_OF_MEMORY
    assert ended(number(told))


@pytest.mark.slow
def test_what_two_processes_share_is_weighed_once(told: Path) -> None:
    with IsolatedProcessPool(1, _SMALL) as executor:
        executor.submit(tasks.share, str(told)).result()
        assert runs(number(told))
    assert ended(number(told))


def test_a_task_that_closes_the_connection_is_told_so() -> None:
    with (
        IsolatedProcessPool(1, Limits(seconds=30.0)) as executor,
        pytest.raises(LostTaskError) as caught,
    ):
        executor.submit(tasks.close_everything).result()
    assert caught.value.loss is Loss.CRASHED
    assert str(caught.value) == "killed: the engine closed its process's connection to the run"


def test_a_run_that_is_stopped_is_told_so(tmp_path: Path) -> None:
    executor = IsolatedProcessPool(1)
    future = executor.submit(tasks.say_and_hang, str(tmp_path / "begun"))
    waiting = executor.submit(tasks.square, 1)
    wait_for(tmp_path / "begun")
    executor.stop()
    assert waiting.cancelled()
    with pytest.raises(LostTaskError) as caught:
        future.result()
    assert (caught.value.loss, str(caught.value)) == (Loss.STOPPED, "killed: the run was stopped")
