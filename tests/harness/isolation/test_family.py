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

_SHORT = Limits(seconds=4.0)
"""Time for a process to start another, on a machine that is busy."""

_SMALL = Limits(seconds=20.0, memory=0.3 * 2**30)
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
    """Whether a process is gone within seconds."""
    until = time.monotonic() + 5.0
    while runs(process) and time.monotonic() < until:
        time.sleep(0.02)
    return not runs(process)


@pytest.mark.parametrize("apart", [False, True])
def test_what_a_hanging_task_started_ends_with_it(told: Path, *, apart: bool) -> None:
    with IsolatedProcessPool(1, _SHORT) as executor, pytest.raises(LostTaskError) as caught:
        executor.submit(tasks.start_and_hang, str(told), apart=apart).result()
    assert caught.value.loss is Loss.HUNG
    assert ended(number(told))


def test_a_task_that_leaves_its_group_and_hangs_is_ended() -> None:
    began = time.monotonic()
    with (
        IsolatedProcessPool(1, Limits(seconds=1.0)) as executor,
        pytest.raises(LostTaskError) as caught,
    ):
        executor.submit(tasks.leave_the_group_and_hang).result(timeout=60.0)
    assert caught.value.loss is Loss.HUNG
    assert time.monotonic() - began < 60.0


def test_what_a_crashing_task_started_ends_with_it(told: Path) -> None:
    with IsolatedProcessPool(1) as executor, pytest.raises(LostTaskError, match="SIGSEGV"):
        executor.submit(tasks.start_and_crash, str(told)).result()
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


def test_a_run_that_is_stopped_is_told_so() -> None:
    executor = IsolatedProcessPool(1)
    future = executor.submit(tasks.nap, 600.0)
    while not future.running():
        time.sleep(0.01)
    assert executor.submit(tasks.square, 1) is not future
    time.sleep(1.0)  # the process is there
    executor.stop()
    with pytest.raises(LostTaskError) as caught:
        future.result()
    assert (caught.value.loss, str(caught.value)) == (Loss.STOPPED, "killed: the run was stopped")
