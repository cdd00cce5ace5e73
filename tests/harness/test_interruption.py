"""Signals act at once, except while something is being written."""

import os
import signal
import subprocess
import sys
import threading
import time
import tomllib
from collections import deque
from collections.abc import Iterator, Sequence
from concurrent.futures import Future, wait
from pathlib import Path
from typing import Any

import pytest

from harness.execution import tasks
from harness.execution.cache import CacheFolder
from harness.execution.cache_entry import Metadata
from harness.execution.isolated_pool import IsolatedProcessPool, SerialExecutor
from harness.execution.signals import SIGNALS, Interrupted, delay_signals, handle_signals
from harness.execution.tasks import ResultCache, run_queue, run_tasks
from harness.execution.worker import LostTaskError
from tests.support.clock import wait_for

ROOT = Path(__file__).parents[2]


@pytest.fixture(autouse=True)
def _listening() -> Iterator[None]:
    """Listen, and leave the signals as they were."""
    before = {number: signal.getsignal(number) for number in SIGNALS}
    handle_signals()
    yield
    for number, handler in before.items():
        signal.signal(number, handler)


@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_a_signal_stops_with_its_code(number: signal.Signals, code: int) -> None:
    with pytest.raises(Interrupted) as stopped:
        os.kill(os.getpid(), number)
    assert stopped.value.exit_code == code


def test_a_write_is_finished_first() -> None:
    done = []

    def write() -> None:
        with delay_signals():
            with delay_signals():
                os.kill(os.getpid(), signal.SIGTERM)
                done.append("inner")
            done.append("outer")

    with pytest.raises(Interrupted):
        write()
    assert done == ["inner", "outer"]
    with delay_signals():
        done.append("later")  # the signal is not heard twice


def stopped(number: signal.Signals) -> bool:
    """Whether a signal stops what runs here."""
    try:
        os.kill(os.getpid(), number)
    except Interrupted:
        return True
    return False


def test_one_signal_is_enough_and_others_do_not_disturb_the_clean_up() -> None:
    found = [stopped(number) for number in (signal.SIGINT, signal.SIGINT, signal.SIGTERM)]
    assert found == [True, False, False]
    with delay_signals():
        assert not stopped(signal.SIGTERM)
    handle_signals()
    assert stopped(signal.SIGTERM)


_HANGING = """
import os, signal
from harness.execution import signals
signals.PATIENCE = 1e9
signals.handle_signals()
try:
    os.kill(os.getpid(), signal.SIGINT)
except signals.Interrupted:
    os.kill(os.getpid(), signal.SIGINT)
    signals.PATIENCE = -1.0
    print("cleaning up", flush=True)
    os.kill(os.getpid(), signal.SIGTERM)
    print("never said", flush=True)
"""


def test_what_hangs_in_its_clean_up_ends_at_a_later_signal() -> None:
    done = subprocess.run(  # noqa: S603 - our own program
        [sys.executable, "-c", _HANGING],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
    )
    assert (done.returncode, done.stdout) == (143, "cleaning up\n")
    assert done.stderr.startswith("rockingcan: left at once; what is kept is whole")
    assert len(done.stderr.splitlines()) == 1


_IMPORTING = """
import sys, time
class Gate:
    def find_spec(self, name, *_):
        if name == {module!r}:
            print("importing", flush=True)
            time.sleep(600.0)
sys.meta_path.insert(0, Gate())
from harness.__main__ import main
main()
"""


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("module", ["harness.cli.main", "typer", "harness.cli.commands"])
def test_a_signal_during_the_imports_is_a_line_and_its_code(
    number: signal.Signals, module: str
) -> None:
    process = subprocess.Popen(  # noqa: S603 - our own program
        [sys.executable, "-c", _IMPORTING.format(module=module), "run", "gentle-rock"],
        cwd=ROOT,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "importing\n"
    process.send_signal(number)
    said, complained = process.communicate(timeout=60)
    assert (process.returncode, said) == (128 + number, "")
    assert complained == "rockingcan: interrupted before it began\n"


def test_the_command_starts_where_signals_are_heard_first() -> None:
    told = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    assert told["project"]["scripts"] == {"rockingcan": "rockingcan:main"}
    light = "import sys, rockingcan, harness.execution.signals; sys.exit('numpy' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", light], cwd=ROOT, check=False).returncode == 0  # noqa: S603


class Impatient(CacheFolder):
    """A store that is asked to stop while it keeps what it is given, or reads it."""

    def note(self, event: str, kind: str, key: str) -> None:
        """Note an event."""
        super().note(event, kind, key)
        if event == "kept" and key == "b":
            os.kill(os.getpid(), signal.SIGTERM)

    def get(self, kind: str, key: str) -> Any:
        """Return what is kept."""
        found = super().get(kind, key)
        if key == "b":
            os.kill(os.getpid(), signal.SIGTERM)
        return found


def shelf(store: CacheFolder) -> ResultCache[str, str]:
    return ResultCache(
        store=store,
        kind="letters",
        key=lambda task: task,
        metadata=lambda task: Metadata(label=task),
    )


def lost(task: str, error: LostTaskError) -> str:
    raise AssertionError(task) from error


def account(tasks: Sequence[str], folder: Path) -> list[str]:
    """Return what a campaign says that is stopped."""
    with pytest.raises(Interrupted) as stopping:
        run_tasks(
            tasks, str.upper, SerialExecutor(), lost=lost, cache=shelf(Impatient(folder=folder))
        )
    return list(stopping.value.__notes__)


def test_what_is_being_kept_when_a_signal_comes_counts(tmp_path: Path) -> None:
    assert account("abc", tmp_path) == [f"2 of 3 are done and kept in '{tmp_path}'."]
    handle_signals()
    # the third is done while the first is read; the signal comes with the second, read as well
    assert account("abc", tmp_path) == [f"3 of 3 are done and kept in '{tmp_path}'."]


def test_a_signal_while_a_thread_starts_leaves_none_to_wait_for_in_vain(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    start, begun = threading.Thread.start, tmp_path / "begun"

    def interrupted(thread: threading.Thread) -> None:
        start(thread)
        time.sleep(0.1)  # it waits for a task by now
        signal.raise_signal(signal.SIGINT)

    def submit_two() -> None:
        with IsolatedProcessPool(2) as pool:
            pool.submit(os.system, f"touch '{begun}' && sleep 1000")
            wait_for(begun)
            monkeypatch.setattr(threading.Thread, "start", interrupted)
            pool.submit(time.sleep, 1e4)

    with pytest.raises(Interrupted):  # and does not hang
        submit_two()


def test_a_signal_while_futures_are_waited_for_leaves_none_of_them_locked(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    waited: list[float | None] = []

    def interrupted(futures: dict[Future[str], str], seconds: float, until: str) -> object:
        os.kill(os.getpid(), signal.SIGTERM)  # `wait` has their locks here and there
        waited.append(seconds)
        return wait(futures, seconds, until)

    monkeypatch.setattr(tasks, "wait", interrupted)
    with pytest.raises(Interrupted):
        run_queue(deque("ab"), lambda _: Future(), lambda *_: None, 2)
    assert len(waited) == 1
