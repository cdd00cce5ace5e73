"""Carries out a sweep: makes the partitions that are missing, wherever the executor runs them.

Only a few partitions are on their way at any time, so that memory does not grow with the sweep.
What makes a partition does not write it: the executor may be on another machine.
"""

from collections import Counter, deque
from collections.abc import Callable
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait

import numpy as np

from harness.isolation import Loss, LostTaskError
from harness.runner import lost
from harness.sweep.folder import Folder
from harness.sweep.found import Found
from harness.sweep.partition import Part, compute, joined, part
from harness.sweep.planning import Plan

_TRIES = 2
"""Of a partition whose process died: by chance once, by one of its scenes twice."""

_WINDOW = 4
"""Partitions on their way in an executor that does not say how many tasks keep it busy."""


def sweep(
    folder: Folder,
    executor: Executor,
    on_done: Callable[[Part], None] | None = None,
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
        Is told of each part once it is written.
    window : int, optional
        Partitions on their way at a time; what the executor says if left out.

    Raises
    ------
    OutputError
        If a partition cannot be written.
    BrokenExecutor
        If the executor can do nothing more; what is done stays.
    """
    plan = folder.plan

    def keep(made: Part) -> None:
        folder.write(made)
        if on_done is not None:
            on_done(made)

    most = getattr(executor, "window", _WINDOW) if window is None else window
    for index in _made(plan, folder.missing(), executor, most, keep):
        keep(_row_by_row(plan, index, executor))


def _made(
    plan: Plan, missing: list[int], executor: Executor, window: int, keep: Callable[[Part], None]
) -> list[int]:
    """Make partitions; return those that took their process with them each time."""
    todo = deque(missing)
    pending: dict[Future[Part], int] = {}
    tries: Counter[int] = Counter()
    deadly: list[int] = []
    try:
        while todo or pending:
            while todo and len(pending) < window:
                index = todo.popleft()
                pending[executor.submit(compute, plan, index)] = index
            for future in wait(pending, return_when=FIRST_COMPLETED).done:
                index = pending.pop(future)
                try:
                    keep(future.result())
                except LostTaskError:
                    tries[index] += 1
                    (todo if tries[index] < _TRIES else deadly).append(index)
    except BaseException:  # Ctrl-C too
        for future in pending:
            future.cancel()
        raise
    return deadly


def _row_by_row(plan: Plan, index: int, executor: Executor) -> Part:
    """Make a partition that takes its process along: each row by itself, so that others are had."""
    rows = [range(row, row + 1) for row in plan.span(index)]
    return joined(index, [_row(plan, index, row, executor, _TRIES) for row in rows])


def _row(plan: Plan, index: int, row: range, executor: Executor, tries: int) -> Part:
    """Make one row; that its process died is its outcome."""
    try:
        return executor.submit(compute, plan, index, row).result()
    except LostTaskError as error:
        if error.loss is Loss.STOPPED and tries > 1:
            return _row(plan, index, row, executor, tries - 1)
        said = lost(plan.case(plan.scene), error).simulation
        numbers = {name: np.full(1, np.nan) for name in plan.quantities}
        outcome = f"{said.outcome.value} ({said.note})"
        return part(plan, index, row, Found(numbers=numbers, outcomes=[outcome]))
