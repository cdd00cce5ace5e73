"""The command: from words to a table, a report and one JSON object."""

import json
import os
import signal
import subprocess
import sys
import time
from concurrent.futures import Future
from pathlib import Path
from typing import Any

import pandas as pd
import pytest

from harness.cli.main import code_of
from harness.execution.dask_cluster import LostSchedulerError
from harness.execution.isolated_pool import SerialExecutor
from harness.execution.limits import Limits

SIGNS = (
    "sweep",
    "paper-release",
    "--over",
    "release.psi_dot=-1:1:21",
    "--over",
    "release.theta_dot=-1:1:21",
    "--figures",
)


@pytest.mark.slow
def test_the_papers_sign_map(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "signs"
    assert code_of([*SIGNS, "--out", str(out), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    frame = pd.read_parquet(told["parts"])
    assert told["scenes"] == len(frame) == 441
    assert told["exact"] is True
    # both rates reversed is the motion in a mirror: every turn comes with its opposite
    turns = frame.angle_of_turn_deg.to_numpy().reshape(21, 21)
    assert told["quantities"]["angle_of_turn_deg"]["scenes"] == 440  # at rest it falls flat
    assert turns[10, 10] != turns[10, 10]
    rest = frame.outcome[220]
    assert "fell flat" in str(rest)
    for row in range(21):
        for column in range(21):
            if (row, column) != (10, 10):
                assert turns[row, column] == pytest.approx(-turns[20 - row, 20 - column], rel=1e-12)
    assert (out / "report" / "figures" / "sweep.png").stat().st_size > 10_000
    assert (out / "report" / "index.html").exists()
    # again: nothing is made, the answer is the same
    assert code_of([*SIGNS, "--out", str(out), "--json"]) == 0
    again = capsys.readouterr()
    assert json.loads(again.out) == told
    assert again.err == "441 of 441 scenes are there, 0 to go\n"


def test_a_curve_against_epsilon_and_a_sample(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    curve = ("sweep", "paper-release", "--over", "release.psi_dot=log:1e-3:1:50")
    words = ("--quantity", "angle_of_turn_deg", "--against", "epsilon")
    assert code_of([*curve, *words, "--out", str(tmp_path / "a"), "--json"]) == 0
    assert set(json.loads(capsys.readouterr().out)["quantities"]) == {
        "angle_of_turn_deg",
        "epsilon",
    }
    sample = ("sweep", "gentle-rock", "--over", "can.h=0.5:2", "--over", "can.c=0.2:1")
    more = ("--sample", "halton", "--count", "100", "--seed", "7", "--jobs", "1")
    assert code_of([*sample, *more, "--out", str(tmp_path / "b")]) == 0
    assert "angle_of_turn_deg" in capsys.readouterr().out


def test_a_sweep_of_derivatives_tells_their_caveats(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ("sweep", "balance-1e-12", "--over", "release.psi_dot=log:1e-9:1e-3:3")
    asked = ("--quantity", "d_period_s/d_release.psi_dot", "--jobs", "1")
    assert code_of([*words, *asked, "--out", str(tmp_path / "a")]) == 0
    assert "separatrix" in (tmp_path / "a" / "report" / "summary.md").read_text()
    frame = pd.read_parquet(tmp_path / "a" / "parts")
    # one over the distance, which the rate decides once it is more than 1e-12 away
    slopes = frame["d_period_s/d_release.psi_dot"].to_numpy()
    rates = frame["release_psi_dot_rad_s"].to_numpy()
    assert slopes[1:] * rates[1:] == pytest.approx(-0.183, rel=0.01)
    assert code_of([*words, "--quantity", "period_s", "--out", str(tmp_path / "b")]) == 0
    assert "separatrix" not in (tmp_path / "b" / "report" / "summary.md").read_text()
    capsys.readouterr()


def test_wrong_use_is_one_message(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = ("--out", str(tmp_path / "out"))
    over = ("sweep", "gentle-rock", "--over", "can.h=1:2:3")
    for words in (
        ("sweep", "gentle-rock", "--over", "can.x=1:2:3"),
        (*over, "--quantity", "turn"),
        (*over, "--against", "epsilon", "--quantity", "turn"),
        (*over, "--against", "steps"),
        (*over, "--engine", "ode"),
        (*over, "--timestep", "1e-3"),
        (*over, "--set", "rtol=soon"),
        (*over, "--count", "3"),
        (*over, "--jobs", "0"),
        (*over, "--on", "nonsense"),
        (*over, "--time-limit", "0"),
        (*over, "--memory-limit", "-1"),
    ):
        assert code_of([*words, *out]) == 2
        said = capsys.readouterr()
        assert said.out == ""
        assert said.err.startswith("rockingcan: ")
        assert len(said.err.splitlines()) == 1
        assert not (tmp_path / "out").exists()


def test_an_unreachable_cluster_is_not_the_folders_fault(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("harness.execution.dask_cluster._PATIENCE", 0.5)
    over = ("sweep", "gentle-rock", "--over", "can.h=1:2:3", "--out", str(tmp_path / "out"))
    assert code_of([*over, "--on", "tcp://127.0.0.1:1"]) == 2
    said = capsys.readouterr().err.strip()
    assert said.startswith("rockingcan: no Dask scheduler answers at 'tcp://127.0.0.1:1'")
    assert said.endswith("0 of 3 scenes are written.")


def test_limits_are_those_of_a_scene(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[Limits] = []

    def local(_jobs: int, *, limits: Limits, **_: object) -> SerialExecutor:
        asked.append(limits)
        return SerialExecutor()

    monkeypatch.setattr("harness.cli.sweep.local_executor", local)
    over = ("sweep", "gentle-rock", "--over", "can.h=1:2:2", "--engine", "mujoco")
    limits = ("--time-limit", "7", "--memory-limit", "0.5")
    assert code_of([*over, *limits, "--timestep", "1e-3", "--out", str(tmp_path / "out")]) == 0
    assert asked == [Limits(seconds=7.0, memory=2.0**29)]
    assert "period_s" in capsys.readouterr().out


class Leaving(SerialExecutor):
    """A cluster that does one task and is gone."""

    _left = False

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> "Future[Any]":
        """Do the first task."""
        future: Future[Any] = super().submit(fn, *args, **kwargs)
        if self._left:
            future = Future()
            future.set_exception(LostSchedulerError())
        self._left = True
        return future


def test_a_cluster_that_goes_away_leaves_what_is_written_and_says_how_much(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("harness.sweep.plan.EXACT_ROWS", 4)
    monkeypatch.setattr("harness.cli.sweep.dask_executor", lambda *_: Leaving())
    over = ("sweep", "gentle-rock", "--over", "can.h=1:2:9", "--out", str(tmp_path / "out"))
    assert code_of([*over, "--on", "tcp://127.0.0.1:1"]) == 2
    said = capsys.readouterr().err.strip()
    assert said == f"rockingcan: {LostSchedulerError()}. 4 of 9 scenes are written."
    assert code_of([*over, "--json"]) == 0
    assert capsys.readouterr().err.strip().startswith("4 of 9 scenes are there, 5 to go")


@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_stopped_sweep_says_how_to_go_on_and_goes_on(tmp_path: Path, number: int) -> None:
    root = str(Path(__file__).parents[3])
    program = f"import sys; sys.path.insert(0, {root!r}); from harness.cli import main; main()"
    words = [*SIGNS[:2], "--over", "release.psi_dot=-1:1:60", *SIGNS[4:5]]
    words += ["release.theta_dot=-1:1:1000", "--jobs", "1", "--out", str(tmp_path / "out")]
    process = subprocess.Popen(  # noqa: S603 - our own program
        [sys.executable, "-c", program, *words], stderr=subprocess.PIPE, text=True
    )
    parts = tmp_path / "out" / "parts"
    patience = time.monotonic() + 200.0
    while not (parts.is_dir() and any(parts.glob("part-*"))) and time.monotonic() < patience:
        time.sleep(0.05)
    os.kill(process.pid, number)
    _, said = process.communicate(timeout=200)
    assert process.returncode == 128 + number
    assert "of 60,000 scenes are written" in said
    assert "rockingcan sweep" in said
    assert not list(parts.glob(".*"))
    done = {path.name: path.stat().st_mtime_ns for path in parts.iterdir()}
    assert 0 < len(done) <= 2
    finished = subprocess.run(  # noqa: S603 - our own program
        [sys.executable, "-c", program, *words, "--json"],
        capture_output=True,
        text=True,
        timeout=400,
        check=True,
    )
    assert json.loads(finished.stdout)["outcomes"]
    assert done.items() <= {path.name: path.stat().st_mtime_ns for path in parts.iterdir()}.items()
