"""Carries out a sweep: makes the partitions that are missing, wherever the executor runs them.

Only a few partitions are on their way at any time, so that memory does not grow with the sweep.
What makes a partition does not write it: the executor may be on another machine. Where tasks have
a limit of time, a task does as many rows as fit well into it, and leaves the others to the next.
"""

from collections import defaultdict, deque
from collections.abc import Callable
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from dataclasses import dataclass, replace

import numpy as np

from harness.evaluation.evaluate import failed_evaluation
from harness.execution.limits import NO_LIMITS, Limits
from harness.execution.signals import delay_signals
from harness.execution.worker import Loss, LostTaskError
from harness.sweep.folder import Folder
from harness.sweep.partition import Partition, compute_for, concatenate, to_partition
from harness.sweep.plan import SweepPlan
from harness.sweep.quantities import SweepValues

_TRIES = 2
"""Of rows whose process was stopped from outside: by chance once, for their sake twice."""

_WINDOW = 4
"""Tasks on their way in an executor that does not say how many keep it busy."""

_SHARE = 0.5
"""Of the time that a task may take, for the rows it takes on: some are slower than those before."""


def run_sweep(
    folder: Folder,
    executor: Executor,
    on_done: Callable[[Partition], None] | None = None,
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

    def keep(made: Partition) -> None:
        with delay_signals():
            folder.write(made)
            if on_done is not None:
                on_done(made)

    limits: Limits = getattr(executor, "limits", NO_LIMITS)
    most = getattr(executor, "window", _WINDOW) if window is None else window
    making = _Making(folder.plan, executor, most, _SHARE * limits.seconds)
    making.run(folder.missing(), keep)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Piece:
    """Rows of a partition that a task is given; it may leave some of them to the next."""

    index: int
    rows: range
    tries: int = _TRIES


class _Making:
    """Partitions in the making, piece by piece."""

    def __init__(self, plan: SweepPlan, executor: Executor, window: int, seconds: float) -> None:
        self._plan = plan
        self._executor = executor
        self._window = window
        self._seconds = seconds
        self._todo: deque[_Piece] = deque()
        self._pending: dict[Future[Partition], _Piece] = {}
        self._parts: defaultdict[int, list[Partition]] = defaultdict(list)

    def run(self, missing: list[int], keep: Callable[[Partition], None]) -> None:
        """Make partitions; those that are begun before others."""
        left = deque(missing)
        try:
            while left or self._todo or self._pending:
                while len(self._pending) < self._window and (left or self._todo):
                    if not self._todo:
                        index = left.popleft()
                        self._todo.append(_Piece(index=index, rows=self._plan.span(index)))
                    self._begin(self._todo.popleft())
                for future in wait(self._pending, return_when=FIRST_COMPLETED).done:
                    index = self._end(future, self._pending.pop(future))
                    parts = self._parts[index]
                    if sum(len(one.rows) for one in parts) == len(self._plan.span(index)):
                        del self._parts[index]
                        keep(concatenate(index, sorted(parts, key=lambda one: one.rows.start)))
        except BaseException:  # Ctrl-C too
            for future in self._pending:
                future.cancel()
            raise

    def _begin(self, piece: _Piece) -> None:
        """Hand out a piece."""
        future = self._executor.submit(
            compute_for, self._plan, piece.index, piece.rows, self._seconds
        )
        self._pending[future] = piece

    def _end(self, future: Future[Partition], piece: _Piece) -> int:
        """Take what came of a piece; return its partition."""
        try:
            made = future.result()
        except LostTaskError as error:
            self._lost(piece, error)
            return piece.index
        self._parts[piece.index].append(made)
        rest = range(made.rows.stop, piece.rows.stop)
        if rest:
            self._todo.appendleft(_Piece(index=piece.index, rows=rest))
        return piece.index

    def _lost(self, piece: _Piece, error: LostTaskError) -> None:
        """Try a piece again, or each of its rows by itself; of a row, it is the outcome."""
        # with the exact bounce it is hardly a row's doing
        again = error.loss is Loss.STOPPED or self._plan.exact
        if again and piece.tries > 1:
            self._todo.append(replace(piece, tries=piece.tries - 1))
        elif len(piece.rows) > 1:
            rows = (range(row, row + 1) for row in piece.rows)
            self._todo.extend(_Piece(index=piece.index, rows=row) for row in rows)
        else:
            self._parts[piece.index].append(_without(self._plan, piece, error))


def _without(plan: SweepPlan, piece: _Piece, error: LostTaskError) -> Partition:
    """Return a row that has no numbers, since its process died."""
    said = failed_evaluation(plan.case(plan.scene), error).simulation
    numbers = {name: np.full(1, np.nan) for name in plan.quantities}
    outcome = f"{said.outcome.value} ({said.note})"
    return to_partition(
        plan, piece.index, piece.rows, SweepValues(numbers=numbers, outcomes=[outcome])
    )
