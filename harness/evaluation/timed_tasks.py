"""Do what is not yet done: measure cases, keep each when it is ready, say how long is left.

What a case leaves when it is measured: numbers by name, as a store keeps them.
"""

import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from functools import partial
from typing import Any

from harness.core.case import Case
from harness.evaluation.case_cache import case_key, case_metadata
from harness.execution.cache import CacheFolder
from harness.execution.tasks import ProgressListener, ResultCache, run_tasks
from harness.execution.worker import LostTaskError

Record = dict[str, Any]
"""What JSON can hold."""

Timed = tuple[Record, float]
"""A record, and the seconds that it took by the clock."""


def records(store: CacheFolder, kind: str, module: str) -> ResultCache[Case, Timed]:
    """Return where records of one kind are kept.

    Parameters
    ----------
    store : CacheFolder
    kind : str
    module : str
        Name of the module that makes them: when its sources change, they are made again.
    """
    return ResultCache(
        store=store,
        kind=kind,
        key=lambda case: case_key(case, module),
        metadata=lambda case: case_metadata(case, module),
    )


Work = Callable[[Case], Record]
Told = Callable[["TaskProgress"], None]


@dataclass(frozen=True, slots=True, kw_only=True)
class TaskProgress:
    """How far a campaign is.

    Parameters
    ----------
    case : Case
        The last that was done.
    done, total : int
    remaining_s : float
        What the rest will take, from what cases of each engine took so far.
    """

    case: Case
    done: int
    total: int
    remaining_s: float


def run_timed_tasks(
    cases: Sequence[Case],
    work: Work,
    cache: ResultCache[Case, Timed] | None,
    executor: Executor,
    *,
    lost: Callable[[Case, LostTaskError], Record],
    expected: Callable[[Case], float],
    workers: int = 1,
    on_done: Told | None = None,
    on_kept: Callable[[int, int], None] | None = None,
) -> dict[Case, Record]:
    """Return a record of each case: kept ones as they are, the others measured and kept.

    Parameters
    ----------
    cases : sequence of Case
    work : callable
        A function of a module, so that it can be sent to a process.
    cache : ResultCache or None
        Where records are kept.
    executor : Executor
    lost : callable
        Returns the record of a case that took its process with it, or was stopped.
    expected : callable
        How much work a case is, in any unit that is alike for cases of one engine.
    workers : int
        How many cases run at once.
    on_done : callable, optional
        Is told of each case that was measured.
    on_kept : callable, optional
        Is told, before anything runs, how many are kept and how many there are.
    """
    work_of = {case: expected(case) for case in cases}
    # the longest first, so that no worker is left with it at the end
    order = sorted(work_of, key=work_of.__getitem__, reverse=True)
    spent = Spent(work_of, workers)

    def read(case: Case, timed: Timed) -> None:
        del timed
        spent.skip(case)

    def told(case: Case, timed: Timed) -> None:
        spent.add(case, timed[1])
        if on_done is not None:
            done, left = len(order) - spent.left, spent.remaining()
            on_done(TaskProgress(case=case, done=done, total=len(order), remaining_s=left))

    found = run_tasks(
        order,
        partial(_timed, work),
        executor,
        lost=lambda case, error: (lost(case, error), 0.0),
        cache=cache,
        listener=ProgressListener(kept=on_kept or (lambda *_: None), done=told, read=read),
    )
    records = {case: record for case, (record, _) in zip(order, found, strict=True)}
    return {case: records[case] for case in work_of}


def _timed(work: Work, case: Case) -> Timed:
    """Return a record and the seconds that it took by the clock."""
    started = time.perf_counter()
    return work(case), time.perf_counter() - started


class Spent:
    """What cases took, and so what the others will take.

    A case takes a constant, such as compiling, and a part that goes with its work; both are fitted
    to the cases of its engine that are done, by their shares of the whole.
    """

    def __init__(self, left: Mapping[Case, float], workers: int) -> None:
        self._left = dict(left)
        self._workers = workers
        self._seconds: dict[str, float] = {}
        self._work: dict[str, float] = {}

    @property
    def left(self) -> int:
        """How many are not done."""
        return len(self._left)

    def add(self, case: Case, seconds: float) -> None:
        """Take a case that is done into account."""
        self._work[case.engine] = self._work.get(case.engine, 0.0) + self._left.pop(case)
        self._seconds[case.engine] = self._seconds.get(case.engine, 0.0) + seconds

    def skip(self, case: Case) -> None:
        """Take a case out that was done before."""
        self._left.pop(case)

    def remaining(self) -> float:
        """Return the seconds that the rest will take; engines not seen yet count as the mean."""
        mean = sum(self._seconds.values()) / sum(self._work.values())
        rates = {name: self._seconds[name] / self._work[name] for name in self._work}
        return (
            sum(work * rates.get(case.engine, mean) for case, work in self._left.items())
            / self._workers
        )
