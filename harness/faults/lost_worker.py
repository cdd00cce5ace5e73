"""A Dask cluster of several workers, one of which is killed in the middle of a run."""

import importlib
import os
import signal
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from harness.errors import MissingPackageError
from harness.evaluation import Evaluation
from harness.executors import Serial, cluster
from harness.faults.ledger import differing, whole
from harness.faults.program import Order, cases_of
from harness.faults.trial import Trial
from harness.isolation.limits import sensible
from harness.runner import run
from harness.store import Store

_WORKERS = 3

_CASES = tuple(
    ("gentle-rock", engine, "matched", timestep)
    for engine in ("mujoco", "pybullet")
    for timestep in (1e-3, 5e-4, 3e-4, 2e-4, 1e-4, 5e-5)
)


def lost_worker(folder: Path, told: Callable[[str], None]) -> Trial:
    """Run cases on a local cluster, kill a worker, and compare with a run here, one by one."""
    began = time.monotonic()
    try:
        dask: Any = importlib.import_module("distributed")
    except ImportError as error:
        raise MissingPackageError("--on", "rockingcan[cluster]", str(error)) from error
    told("a worker of a cluster that is killed")
    cases = cases_of(Order(store="", cases=_CASES))
    here, there = (Store(folder=folder / name) for name in ("one-by-one", "cluster"))
    run(cases, Serial(), store=here)
    killed: list[int] = []
    with dask.LocalCluster(
        n_workers=_WORKERS,
        threads_per_worker=1,
        processes=True,
        dashboard_address=None,
        local_directory=str(folder / "dask"),
    ) as machines:
        processes = [nanny.pid for nanny in machines.workers.values()]

        def kill_one(evaluation: Evaluation) -> None:
            del evaluation
            if not killed:  # at the first result the others are on their way
                killed.append(processes[0])
                os.kill(processes[0], signal.SIGKILL)

        limits = sensible(_WORKERS)
        with cluster(machines.scheduler_address, limits) as executor:
            done = run(cases, executor, kill_one, store=there)
    finished = sum(e.simulation.outcome.name == "FINISHED" for e in done)
    other = differing(there, here)
    return Trial(
        name="lost worker",
        done=f"{len(cases)} cases on a Dask cluster of {_WORKERS} processes, one killed after the "
        "first result",
        demanded="the run completes, with the bits of a run one by one in a single process",
        found=(f"{finished} of {len(cases)} finished", f"{other} of {whole(there)} results differ"),
        passed=finished == len(cases) == whole(there) and other == 0 and bool(killed),
        seconds=time.monotonic() - began,
    )
