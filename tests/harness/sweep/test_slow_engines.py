"""Slow engines: a limit is of a scene, and neither slowness nor one that hangs costs the others."""

import math
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pandas as pd
import psutil
import pytest

from harness.execution import worker
from harness.execution.isolated_pool import local_executor
from harness.execution.limits import Limits
from harness.sweep import partition
from harness.sweep.folder import opened
from harness.sweep.partition import compute, compute_for
from harness.sweep.plan import SweepPlan
from harness.sweep.run import run_sweep
from tests.support.clock import Clock, stop_clock
from tests.support.sweeps import make_plan, table

ENGINE = '''
import os
import time
from dataclasses import replace
from pathlib import Path

from harness.engines.base import Capabilities
from harness.engines.registry import engine
from harness.sweep import partition


class Clock:
    """That by which the rows of a task are timed; a run takes its time in no time."""

    passed = 0.0

    def monotonic(self):
        return time.monotonic() + self.passed


partition.time = Clock()


class Slow:
    name = "{name}"
    version = "1"
    settings = ()
    capabilities = Capabilities(honours=frozenset(), imposes={{}})

    def timestep(self, case):
        return None

    def simulate(self, case):
        with Path({log!r}).open("a") as log:
            log.write(f"{{case.scene.release.psi_dot}}\\n")
        partition.time.passed += {seconds}
        if case.scene.release.psi_dot == 2.0:
            with Path({log!r} + ".hung").open("a") as hung:
                hung.write(f"{{os.getpid()}}\\n")
            time.sleep(999.0)
        whole = engine("reference").simulate(replace(case, engine="reference", timestep=None))
        return replace(whole, case=case, model=self.name)
'''


class ClockOfRuns(Clock):
    """A clock that goes on by so much with each run that an engine begins, and not otherwise."""

    def __init__(self, log: Path, seconds: float) -> None:
        super().__init__()
        self._log, self._seconds = log, seconds

    def monotonic(self) -> float:
        """Return the time, s."""
        return self.now + self._seconds * len(rates(self._log))


def installed(folder: Path, monkeypatch: pytest.MonkeyPatch, name: str, seconds: float) -> Path:
    """Install an engine whose runs take so long, and one for ever; return its log of runs."""
    log = folder / f"{name}.log"
    source = ENGINE.format(name=name, log=str(log), seconds=seconds)
    (folder / f"{name}_engine.py").write_text(source, encoding="utf-8")
    metadata = folder / f"{name}_engine-1.dist-info"
    metadata.mkdir()
    entries = f"[rockingcan.engines]\n{name} = {name}_engine:Slow\n"
    (metadata / "entry_points.txt").write_text(entries, encoding="utf-8")
    told = f"Metadata-Version: 2.1\nName: {name}-engine\nVersion: 1\n"
    (metadata / "METADATA").write_text(told, encoding="utf-8")
    monkeypatch.syspath_prepend(str(folder))
    return log


def rates(log: Path) -> list[float]:
    """Return of which scenes a run was begun, in order of their rates."""
    return sorted(map(float, log.read_text().split())) if log.exists() else []


@pytest.mark.slow
def test_rows_that_together_take_longer_than_a_task_may_are_run_once_each(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    log = installed(tmp_path, monkeypatch, "patient", seconds=1.2)
    chosen = make_plan(
        "gentle-rock", "release.psi_dot=1:1.9:18", engine="patient", quantities=["period_s"]
    )
    limits = Limits(seconds=20.0)  # of 21.6 that the partition takes
    monkeypatch.setattr(worker, "time", ClockOfRuns(log, 1.2))
    with (
        opened(tmp_path / "out", chosen) as folder,
        local_executor(2, spawned=True, limits=limits) as executor,
    ):
        run_sweep(folder, executor)
    frame = table(tmp_path / "out")
    assert frame.period_s.notna().all()
    assert rates(log) == sorted(frame.release_psi_dot_rad_s)


@pytest.mark.slow
def test_a_scene_that_hangs_is_named_and_costs_its_limit_twice(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    log = installed(tmp_path, monkeypatch, "stuck", seconds=0.0)
    chosen = make_plan(
        "gentle-rock", "release.psi_dot=1:3:9", engine="stuck", quantities=["period_s"]
    )
    clock = stop_clock(monkeypatch)

    def let_it_hang(times: int) -> None:
        for begun in range(times):
            hung = log.with_name(f"{log.name}.hung")
            until = time.monotonic() + 120.0
            while len(processes := hung.read_text().split() if hung.exists() else []) <= begun:
                assert time.monotonic() < until
                time.sleep(0.01)
            # until it is stopped: a clock that went on before the task was watched would stop none
            process = int(processes[begun])
            clock.run_until(lambda: not psutil.pid_exists(process), 12.01)  # noqa: B023 - run now

    with (
        opened(tmp_path / "out", chosen) as folder,
        ThreadPoolExecutor(1) as hand,
        # one process: when the clock goes on, what hangs is all that runs
        local_executor(1, spawned=True, limits=Limits(seconds=12.0)) as executor,
    ):
        gone_on = hand.submit(let_it_hang, 2)
        run_sweep(folder, executor)
        gone_on.result()
    frame = table(tmp_path / "out")
    assert frame.period_s.isna().tolist() == [row == 4 for row in range(9)]
    assert "ran longer than the 12 s allowed" in str(frame.outcome[4])
    assert rates(log).count(2.0) == 2


def test_a_task_takes_on_what_it_has_time_for(monkeypatch: pytest.MonkeyPatch) -> None:
    chosen = make_plan(
        "gentle-rock", "release.psi_dot=1:3:100", engine="mujoco", quantities=["epsilon"]
    )
    clock = 0.0
    blocks: list[range] = []

    def computed(_plan: SweepPlan, rows: range) -> pd.DataFrame:
        nonlocal clock
        clock += 2.0 * len(rows)
        blocks.append(rows)
        return pd.DataFrame(index=rows)

    monkeypatch.setattr(partition, "compute", computed)
    monkeypatch.setattr(time, "monotonic", lambda: clock)
    compute_for(chosen, range(10, 100), 50.0)
    assert [len(block) for block in blocks] == [1, 24]
    blocks.clear()
    compute_for(chosen, range(10, 100), 1.0)  # at least one, whatever it takes
    assert [len(block) for block in blocks] == [1]
    blocks.clear()
    compute_for(chosen, range(10, 100), 1e9)
    assert [len(block) for block in blocks] == [1, 89]
    blocks.clear()
    compute_for(chosen, range(10, 100), math.inf)
    assert [len(block) for block in blocks] == [90]


def test_rows_in_blocks_are_to_the_bit_those_of_the_whole() -> None:
    chosen = make_plan(
        "gentle-rock",
        "release.psi_dot=1.5:2.5:12",
        engine="mujoco",
        timestep=2e-3,
        quantities=["angle_of_turn_deg", "angle_of_turn_error_deg", "energy_drift", "steps"],
    )
    whole, blocks = compute(chosen, range(12)), compute_for(chosen, range(12), 1e3)
    for name in chosen.quantities:
        assert whole[name].to_numpy().tobytes() == blocks[name].to_numpy().tobytes()
    pd.testing.assert_frame_equal(whole, blocks, check_exact=True)
