"""Carries out a sweep: makes the partitions that are missing, wherever the executor runs them.

Only a few partitions are on their way at any time, so that memory does not grow with the sweep.
What makes a partition does not write it: the executor may be on another machine. Where tasks have
a limit of time, a task does as many rows as fit well into it, and leaves the others to the next.
"""

import math
from collections import defaultdict, deque
from collections.abc import Callable
from concurrent.futures import Executor, Future
from dataclasses import dataclass, replace

import pandas as pd

from harness.evaluation.evaluate import failed_evaluation
from harness.execution.limits import NO_LIMITS, Limits
from harness.execution.signals import delay_signals
from harness.execution.tasks import run_queue
from harness.execution.worker import Loss, LostTaskError
from harness.sweep.folder import Folder
from harness.sweep.partition import OUTCOME, compute_for, to_partition
from harness.sweep.plan import SweepPlan

_TRIES = 2
"""Of rows whose process was stopped from outside: by chance once, for their sake twice."""

_WINDOW = 4
"""Tasks on their way in an executor that does not say how many keep it busy."""

_SHARE = 0.5
"""Of the time that a task may take, for the rows it takes on: some are slower than those before."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Piece:
    """Rows of a partition that a task is given; it may leave some of them to the next."""

    rows: range
    tries: int = _TRIES


def run_sweep(
    folder: Folder,
    executor: Executor,
    on_done: Callable[[pd.DataFrame], None] | None = None,
    *,
    window: int | None = None,
) -> None:
    """Make what is missing of a sweep.

    Parameters
    ----------
    folder : Folder
        With the plan; its partitions that are there are left as they are.
    executor : Executor
    on_done : callable, optional
        Is told of each partition once it is written, before a signal is heeded that came meanwhile.
    window : int, optional
        Tasks on their way at a time; what the executor says if left out.

    Raises
    ------
    OutputError
        If a partition cannot be written.
    BrokenExecutor
        If the executor can do nothing more; what is done stays.
    """
    plan = folder.plan
    limits: Limits = getattr(executor, "limits", NO_LIMITS)
    most = getattr(executor, "window", _WINDOW) if window is None else window
    pieces = deque(_Piece(rows=plan.span(index)) for index in folder.missing())
    parts: defaultdict[int, list[pd.DataFrame]] = defaultdict(list)

    def submit(piece: _Piece) -> Future[pd.DataFrame]:
        return executor.submit(compute_for, plan, piece.rows, _SHARE * limits.seconds)

    def take(piece: _Piece, future: Future[pd.DataFrame]) -> None:
        index = piece.rows.start // plan.rows_per_partition
        computed = parts[index]
        try:
            computed.append(future.result())
            rest = piece.rows[len(computed[-1]) :]
            again = [_Piece(rows=rest)] if rest else []
        except LostTaskError as error:
            again = _tried_again(plan, piece, error)
            if not again:
                computed.append(_without(plan, piece, error))
        pieces.extendleft(again)  # what is begun before others
        if sum(map(len, computed)) == len(plan.span(index)):
            partition = pd.concat(parts.pop(index)).sort_index()
            with delay_signals():
                folder.write(partition)
                if on_done is not None:
                    on_done(partition)

    run_queue(pieces, submit, take, most)


def _tried_again(plan: SweepPlan, piece: _Piece, error: LostTaskError) -> list[_Piece]:
    """Return a lost piece to try again, or each of its rows by itself; of a row, nothing."""
    # with the exact bounce it is hardly a row's doing
    if (error.loss is Loss.STOPPED or plan.exact) and piece.tries > 1:
        return [replace(piece, tries=piece.tries - 1)]
    if len(piece.rows) == 1:
        return []
    return [_Piece(rows=range(row, row + 1)) for row in piece.rows]


def _without(plan: SweepPlan, piece: _Piece, error: LostTaskError) -> pd.DataFrame:
    """Return a row that has no numbers, since its process died."""
    outcome = failed_evaluation(plan.base, error).simulation.ending
    row = {**dict.fromkeys(plan.quantities, math.nan), OUTCOME: outcome}
    return to_partition(plan, piece.rows, pd.DataFrame([row]))
