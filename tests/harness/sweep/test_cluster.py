"""A sweep on a Dask cluster, a worker of which is killed in the middle: the same bytes."""

import importlib
import os
import signal
from pathlib import Path
from typing import Any

import pytest

from harness.execution.dask_cluster import dask_executor
from harness.execution.limits import default_limits
from harness.sweep.folder import opened
from harness.sweep.run import run_sweep
from tests.support.sweeps import carried_out, contents, make_plan, table


@pytest.mark.slow
@pytest.mark.filterwarnings("default")  # those of the cluster's own threads are not ours
def test_a_worker_is_killed_and_the_sweep_is_the_same(tmp_path: Path) -> None:
    chosen = make_plan(
        "gentle-rock",
        "release.psi_dot=1.5:2.5",
        sample="sobol",
        count=1024,
        engine="mujoco",
        timestep=4e-3,
        quantities=["angle_of_turn_deg", "angle_of_turn_error_deg"],
    )
    dask: Any = importlib.import_module("distributed")
    killed: list[int] = []
    with dask.LocalCluster(
        n_workers=2,
        threads_per_worker=1,
        processes=True,
        dashboard_address=None,
        local_directory=str(tmp_path / "dask"),
    ) as machines:
        processes = [nanny.pid for nanny in machines.workers.values()]

        def kill_one(part: object) -> None:
            del part
            if not killed:  # at the first partition the others are on their way
                killed.append(processes[0])
                os.kill(processes[0], signal.SIGKILL)

        with (
            opened(tmp_path / "there", chosen) as folder,
            dask_executor(machines.scheduler_address, default_limits(2)) as executor,
        ):
            run_sweep(folder, executor, kill_one)
    assert killed
    carried_out(tmp_path / "here", chosen)
    assert contents(tmp_path / "there") == contents(tmp_path / "here")
    assert table(tmp_path / "there").angle_of_turn_deg.notna().all()
