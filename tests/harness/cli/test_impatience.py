"""Somebody who presses Ctrl-C again and again, and a scheduler that does not wait."""

import signal
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

import pytest

from harness.execution.cache import JOURNAL
from tests.faults.programs import left_behind

ROOT = Path(__file__).parents[3]
WORDS = ("attribute", "gentle-rock", "--engine", "mujoco", "--jobs", "2")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("number", "count", "gap"), [(signal.SIGINT, 41, 0.01), (signal.SIGTERM, 301, 0.001)]
)
def test_many_signals_are_as_one(
    tmp_path: Path, number: signal.Signals, count: int, gap: float
) -> None:
    words = [*WORDS, "--store", str(tmp_path)]
    process = subprocess.Popen(  # noqa: S603 - our own program
        [sys.executable, "-m", "harness", *words],
        cwd=ROOT,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    journal = tmp_path / JOURNAL
    while not (journal.exists() and '"kept"' in journal.read_text(encoding="utf-8")):
        assert process.poll() is None
        time.sleep(0.01)
    for _ in range(count):
        with suppress(ProcessLookupError):
            process.send_signal(number)
        time.sleep(gap)
    said, complained = process.communicate(timeout=60)
    assert process.returncode == 128 + number
    assert left_behind(process.pid) == 0
    assert said == ""
    assert "Traceback" not in complained
    assert "of 11 are done and kept in" in complained
    assert complained.endswith(f"To go on: rockingcan {' '.join(words)}\n")
