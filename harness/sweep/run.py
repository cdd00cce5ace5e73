"""Run a sweep: compute the missing partitions on any executor, and write them here.

Only a few partitions are pending at any time, so that memory does not grow with the sweep. The
process that computes a partition does not write it: it may be on another machine. Where tasks have
a limit of time, a task computes the rows that fit well into it, and leaves the others to the next.
"""

import math
from collections import defaultdict, deque
from collections.abc import Callable
from concurrent.futures import Executor, Future
from dataclasses import dataclass, replace
from typing import Any

import pandas as pd

from harness.evaluation.run_cases import failed_evaluation
from harness.execution.limits import NO_LIMITS, Limits
from harness.execution.signals import delay_signals
from harness.execution.tasks import run_queue
from harness.execution.worker import Loss, LostTaskError
from harness.sweep.folder import Folder
from harness.sweep.partition import OUTCOME, compute_for, to_partition
from harness.sweep.plan import SweepPlan
from harness.sweep.reduction import Reduction, reduced

_TRIES = 2
"""Tries of rows whose process was stopped from outside, which may happen once by chance."""

_WINDOW = 4
"""Pending tasks in an executor without the attribute `window`."""

_SHARE = 0.5
"""Share of a task's time limit that its rows may fill: later rows may be slower."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Piece:
    """Rows of a partition for a task, which may leave the last of them to the next task."""

    rows: range
    tries: int = _TRIES


def run_sweep(
    folder: Folder,
    executor: Executor,
    on_done: Callable[[Any], None] | None = None,
    *,
    window: int | None = None,
) -> None:
    """Compute and write the missing partitions of a sweep.

    Parameters
    ----------
    folder : Folder
        With the plan; existing partitions stay as they are.
    executor : Executor
    on_done : callable, optional
        Called with each partition, a DataFrame or a Reduction, once it is written, before a delayed
        signal acts.
    window : int, optional
        Most pending tasks; the executor's `window` if left out.

    Raises
    ------
    OutputError
        If a partition cannot be written.
    BrokenExecutor
        If the executor can do nothing more; what is done stays.
    """
    plan = folder.plan

    def keep(partition: pd.DataFrame | Reduction) -> None:
        with delay_signals():
            folder.write(partition)
            if on_done is not None:
                on_done(partition)

    most = getattr(executor, "window", _WINDOW) if window is None else window
    if plan.reduced:
        _run_reduced(folder, executor, keep, most)
        return
    limits: Limits = getattr(executor, "limits", NO_LIMITS)
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
            again = _retries(plan, piece, error)
            if not again:
                computed.append(_lost_row(plan, piece, error))
        pieces.extendleft(again)  # what is begun before others
        if sum(map(len, computed)) == len(plan.span(index)):
            keep(pd.concat(parts.pop(index)).sort_index())

    run_queue(pieces, submit, take, most)


def _run_reduced(
    folder: Folder, executor: Executor, keep: Callable[[Reduction], None], window: int
) -> None:
    """Compute the missing partitions of a sweep without rows, each a task."""
    plan = folder.plan

    def submit(piece: _Piece) -> Future[Reduction]:
        return executor.submit(reduced, plan, piece.rows)

    def take(piece: _Piece, future: Future[Reduction]) -> None:
        try:
            reduction = future.result()
        except LostTaskError:
            # no scene's doing: all are solved, or refused, by the same arithmetic
            if piece.tries == 1:
                raise
            pieces.appendleft(replace(piece, tries=piece.tries - 1))
        else:
            keep(reduction)

    pieces = deque(_Piece(rows=plan.span(index)) for index in folder.missing())
    run_queue(pieces, submit, take, window)


def _retries(plan: SweepPlan, piece: _Piece, error: LostTaskError) -> list[_Piece]:
    """Return the pieces to run in place of a lost one: itself, or its rows one by one, or none."""
    # with the exact bounce it is hardly a row's doing
    if (error.loss is Loss.STOPPED or plan.exact) and piece.tries > 1:
        return [replace(piece, tries=piece.tries - 1)]
    if len(piece.rows) == 1:
        return []
    return [_Piece(rows=range(row, row + 1)) for row in piece.rows]


def _lost_row(plan: SweepPlan, piece: _Piece, error: LostTaskError) -> pd.DataFrame:
    """Return a row without numbers, whose outcome says how its process died."""
    outcome = failed_evaluation(plan.base, error).simulation.ending
    row = {**dict.fromkeys(plan.quantities, math.nan), OUTCOME: outcome}
    return to_partition(plan, piece.rows, pd.DataFrame([row]))
