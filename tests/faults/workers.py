"""A Dask cluster of several workers, one of which is killed in the middle of a run.

Engines that crash, hang, eat memory and return garbage, in one suite with sound ones.
"""

import importlib
import json
import os
import signal
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from harness.core.engine_packages import install_command
from harness.core.errors import MissingPackageError
from harness.evaluation.evaluation import Evaluation
from harness.evaluation.run_cases import run_cases
from harness.execution.cache import CacheFolder
from harness.execution.dask_cluster import dask_executor
from harness.execution.isolated_pool import SerialExecutor
from harness.execution.limits import default_limits
from tests.faults.journal_check import differing, whole
from tests.faults.programs import ENGINES, ProgramRun, cases_of, left_behind, register, started
from tests.faults.trial import Trial

_WORKERS = 3

_CASES = tuple(
    ("gentle-rock", engine, "matched", timestep)
    for engine in ENGINES
    for timestep in (1e-3, 5e-4, 3e-4, 2e-4, 1e-4, 5e-5)
)


def lost_worker(folder: Path, told: Callable[[str], None]) -> Trial:
    """Run cases on a local cluster, kill a worker, and compare with a run here, one by one."""
    began = time.monotonic()
    try:
        dask: Any = importlib.import_module("distributed")
    except ImportError as error:
        install = install_command(["rockingcan[cluster]"])
        raise MissingPackageError("'--on'", "distributed", str(error), install) from error
    told("a worker of a cluster that is killed")
    cases = cases_of(ProgramRun(store="", cases=_CASES))
    here, there = (CacheFolder(folder=folder / name) for name in ("one-by-one", "cluster"))
    run_cases(cases, SerialExecutor(), store=here)
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

        limits = default_limits(_WORKERS)
        with dask_executor(machines.scheduler_address, limits) as executor:
            done = run_cases(cases, executor, kill_one, store=there)
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


_SECONDS = 12.0
"""Allowed for a case: sound ones take tenths of a second, a gibibyte is eaten in some seconds."""

_MEMORY = 1.0 * 2**30
"""Allowed for a case: an engine and the reference use a fifth of it."""

_EXPECTED = {
    "crashing": ("CRASHED", "killed: SIGSEGV, segmentation fault"),
    "hanging": ("HUNG", f"killed: it ran longer than the {_SECONDS:g} s allowed"),
    "hungry": ("OUT_OF_MEMORY", "killed: it used more than the 1 GiB allowed"),
    "garbling": ("BROKEN", "`position` is no number at sample 1"),
    **dict.fromkeys(ENGINES, ("FINISHED", "")),
}


def deadly(folder: Path, told: Callable[[str], None]) -> Trial:
    """Run a suite in which four engines fail, each in its own way."""
    began = time.monotonic()
    told("engines that crash, hang, eat memory and return garbage")
    # the sound ones last: what went before must not have hurt them
    cases = [("gentle-rock", name, "matched", 1e-3) for name in _EXPECTED]
    order = ProgramRun(
        store=str(folder / "deadly"), cases=cases, jobs=2, seconds=_SECONDS, memory=_MEMORY
    )
    process = started(order, register(folder / "entries"))
    said, complained = process.communicate()
    orphans = left_behind(process.pid)
    outcomes = json.loads(said) if process.returncode == 0 else []
    named = {engine: (outcome, note) for engine, outcome, note in outcomes}
    right = [
        name
        for name, (outcome, note) in _EXPECTED.items()
        if name in named and named[name][0] == outcome and named[name][1].startswith(note)
    ]
    found = tuple(", ".join(filter(None, (f"{name}: {o}", n))) for name, (o, n) in named.items())
    return Trial(
        name="engines that fall",
        done="one suite with an engine that crashes, one that hangs, one that allocates without "
        "end, one that returns garbage, and sound ones",
        demanded="the suite completes and names each",
        found=(*(found or (complained.strip(),)), f"{orphans} processes left behind"),
        passed=len(right) == len(_EXPECTED) and not orphans,
        seconds=time.monotonic() - began,
    )
