"""Do what is not yet done: measure cases, keep each when it is ready, say how long is left."""

import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor, as_completed
from dataclasses import dataclass

from harness.case import Case
from harness.engines.registry import engine
from harness.timing.store import Record, Store

Work = Callable[[Case], Record]
Told = Callable[["Progress"], None]


@dataclass(frozen=True, slots=True, kw_only=True)
class Progress:
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


def complete(
    cases: Sequence[Case],
    work: Work,
    store: Store,
    executor: Executor,
    *,
    expected: Callable[[Case], float],
    workers: int = 1,
    on_done: Told | None = None,
) -> dict[Case, Record]:
    """Return a record of each case: kept ones as they are, the others measured and kept.

    Parameters
    ----------
    cases : sequence of Case
    work : callable
        A function of a module, so that it can be sent to a process.
    store : Store
    executor : Executor
    expected : callable
        How much work a case is, in any unit that is alike for cases of one engine.
    workers : int
        How many cases run at once.
    on_done : callable, optional
    """
    wanted = {case: case.digest(engine(case.engine).version) for case in dict.fromkeys(cases)}
    found = {case: record for case, key in wanted.items() if (record := store.get(key)) is not None}
    left = {case: expected(case) for case in wanted if case not in found}
    spent = Spent(left, workers)
    # the longest first, so that no worker is left with it at the end
    pending = {
        executor.submit(_timed, work, case): case
        for case in sorted(left, key=left.__getitem__, reverse=True)
    }
    try:
        for future in as_completed(pending):
            case = pending[future]
            record, seconds = future.result()
            store.put(wanted[case], record)
            found[case] = record
            spent.add(case, seconds)
            if on_done is not None:
                on_done(
                    Progress(
                        case=case,
                        done=len(found),
                        total=len(wanted),
                        remaining_s=spent.remaining(),
                    )
                )
    except BaseException:  # Ctrl-C too: what waits is not begun
        executor.shutdown(wait=False, cancel_futures=True)
        raise
    return {case: found[case] for case in wanted}


def _timed(work: Work, case: Case) -> tuple[Record, float]:
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

    def add(self, case: Case, seconds: float) -> None:
        """Take a case that is done into account."""
        self._work[case.engine] = self._work.get(case.engine, 0.0) + self._left.pop(case)
        self._seconds[case.engine] = self._seconds.get(case.engine, 0.0) + seconds

    def remaining(self) -> float:
        """Return the seconds that the rest will take; engines not seen yet count as the mean."""
        mean = sum(self._seconds.values()) / sum(self._work.values())
        rates = {name: self._seconds[name] / self._work[name] for name in self._work}
        return (
            sum(work * rates.get(case.engine, mean) for case, work in self._left.items())
            / self._workers
        )
