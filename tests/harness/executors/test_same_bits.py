"""Whatever runs the cases, the bits are the same."""

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from harness.core.case import Case
from harness.evaluation.run_cases import run_cases
from harness.execution.cache import CacheFolder
from harness.execution.isolated_pool import SerialExecutor, local_executor
from models import Scene
from tests.faults.journal_check import differing, ledger, whole


@pytest.mark.slow
def test_here_in_threads_and_in_processes(brief: Scene, tmp_path: Path) -> None:
    cases = [
        Case(scene=brief, engine=engine, timestep=timestep)
        for engine in ("mujoco", "pybullet")
        for timestep in (1e-3, 5e-4)
    ]
    # an engine's module is not made for threads of one process at once: one at a time there
    executors = (SerialExecutor(), ThreadPoolExecutor(1), local_executor(2))
    stores = [CacheFolder(folder=tmp_path / str(number)) for number in range(len(executors))]
    for executor, store in zip(executors, stores, strict=True):
        with executor:
            run_cases(cases, executor, store=store)
    first, *others = stores
    assert whole(first) == len(cases)
    assert [differing(first, other) for other in others] == [0, 0]
    book = ledger(first)
    assert (book.tasks, book.begun, book.again) == (len(cases), len(cases), 0)
    # the comparison sees a single bit, and an entry that is missing
    record = next(first.folder.glob("evaluations/??/*.result"))
    record.unlink()
    assert differing(first, others[0]) == 1
