"""A process that dies takes one scene along, and a signal nothing that is written."""

import os
import signal
from concurrent.futures import Executor, Future
from pathlib import Path
from typing import Any

import pytest

from harness.core.case import Case
from harness.core.simulation import Simulation
from harness.execution.isolated_pool import SerialExecutor
from harness.execution.signals import SIGNALS, Interrupted, handle_signals
from harness.execution.worker import Loss, LostTaskError
from harness.sweep.folder import opened
from harness.sweep.plan import SweepPlan
from harness.sweep.run import run_sweep
from tests.support.sweeps import carried_out, contents, make_plan, table

pytestmark = pytest.mark.usefixtures("small_partitions")


class Deadly(Executor):
    """Runs tasks here, and loses those that hold a row that kills; others it loses once."""

    def __init__(self, row: int) -> None:
        self._row = row
        self._lost: set[int] = set()

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> "Future[Any]":
        """Do a task here, or lose it."""
        future: Future[Any] = Future()
        plan, rows, _ = args
        index = rows.start // plan.rows_per_partition
        if self._row in rows:
            future.set_exception(LostTaskError(Loss.CRASHED, "killed: SIGSEGV"))
        elif index not in self._lost:
            self._lost.add(index)
            future.set_exception(LostTaskError(Loss.STOPPED, "killed: from outside"))
        else:
            future.set_result(fn(*args, **kwargs))
        return future


def test_a_scene_that_kills_its_process_is_named_and_the_others_are_had(tmp_path: Path) -> None:
    chosen = make_plan(
        "gentle-rock",
        "release.psi_dot=1.5:2.5:8",
        engine="mujoco",
        timestep=2e-3,
        quantities=["angle_of_turn_deg", "angle_of_turn_error_deg"],
    )
    whole = carried_out(tmp_path / "whole", chosen)
    with opened(tmp_path / "out", chosen) as folder:
        run_sweep(folder, Deadly(4))
    frame = table(tmp_path / "out")
    assert "SIGSEGV" in str(frame.outcome[4])
    assert frame.angle_of_turn_deg.isna().tolist() == [row == 4 for row in range(8)]
    for name in chosen.quantities:
        assert frame[name].drop(4).equals(whole[name].drop(4))


class Unspeakable(Exception):  # noqa: N818 - it is somebody else's
    """An error that cannot even be said."""

    def __str__(self) -> str:
        """Fail at it."""
        raise ValueError


class Mute:
    """An adapter that raises what cannot be said."""

    def simulate(self, _case: Case) -> Simulation:
        """Raise it."""
        raise Unspeakable


def test_an_error_that_cannot_be_said_is_an_outcome_too(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    chosen = make_plan(
        "gentle-rock", "release.psi_dot=1:2:4", engine="mujoco", quantities=["period_s"]
    )
    for place in (
        "sweep.values",
        "evaluation.evaluate",
        "evaluation.case_cache",
        "engines.registry",
    ):
        monkeypatch.setattr(f"harness.{place}.engine", lambda _: Mute())
    frame = carried_out(tmp_path / "out", chosen)
    assert frame.outcome.astype(str).str.contains("`simulate` raised Unspeakable").all()


def test_what_is_written_while_a_signal_comes_is_counted(
    sweep_of_225: SweepPlan, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    counted: list[int] = []
    real = os.fsync

    def interrupting(handle: int) -> None:
        real(handle)
        if counted:  # the second partition is being written
            os.kill(os.getpid(), signal.SIGTERM)

    before = {number: signal.getsignal(number) for number in SIGNALS}
    handle_signals()
    try:
        with opened(tmp_path / "out", sweep_of_225) as folder:
            monkeypatch.setattr(os, "fsync", interrupting)
            with pytest.raises(Interrupted):
                run_sweep(
                    folder, SerialExecutor(), lambda part: counted.append(part.index[0] // 50)
                )
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
    assert counted == [0, 1]
    assert len(contents(tmp_path / "out")) == 2
