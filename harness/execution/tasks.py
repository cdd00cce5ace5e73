"""Do what is not yet done: tasks on any executor, results kept as they come, the rest skipped.

What is kept is read while others run. Few tasks more are handed out than run at once, so that
little is in flight when the program ends, however it ends.
"""

from collections import deque
from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, wait
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from functools import cache
from typing import Generic, TypeVar

from harness.core.errors import StoreError
from harness.core.provenance import provenance
from harness.execution.cache import CacheFolder
from harness.execution.cache_entry import EntryContent, Metadata
from harness.execution.signals import delay_signals
from harness.execution.worker import Loss, LostTaskError

T = TypeVar("T")
R = TypeVar("R")


@dataclass(frozen=True, slots=True, kw_only=True)
class ResultCache(Generic[T, R]):
    """Where the results of one kind of task are kept.

    Parameters
    ----------
    store : Store
    kind : str
        One word.
    key : callable
        Returns what names a task: a digest of all that decides its result.
    about : callable
        Returns where a result comes from; when and on which machine is filled in.
    pack, unpack : callable
        Turn a result into what a store keeps, and for a task back.
    """

    store: CacheFolder
    kind: str
    key: Callable[[T], str]
    about: Callable[[T], Metadata]
    pack: Callable[[R], EntryContent]
    unpack: Callable[[T, EntryContent], R]

    def has(self, task: T) -> bool:
        """Whether the result of a task is kept."""
        return self.store.has(self.kind, self.key(task))

    def get(self, task: T) -> R | None:
        """Return the result of a task, or None if there is none that can be read."""
        key = self.key(task)
        content = self.store.get(self.kind, key)
        if content is None:
            return None
        try:
            return self.unpack(task, content)
        except StoreError as error:
            self.store.reject(self.kind, key, str(error))
            return None

    def put(self, task: T, result: R) -> None:
        """Keep the result of a task."""
        about = replace(
            self.about(task),
            kept=datetime.now(UTC).isoformat(timespec="seconds"),
            machine=_machine(),
        )
        self.store.put(self.kind, self.key(task), about, self.pack(result))

    def begun(self, task: T) -> None:
        """Note that a task is handed out."""
        self.store.note("begun", self.kind, self.key(task))


@dataclass(frozen=True, slots=True, kw_only=True)
class ProgressListener(Generic[T, R]):
    """Who is told how a campaign goes.

    Parameters
    ----------
    kept : callable
        Is told before anything runs how many tasks are kept, and how many there are.
    done : callable
        Is told of each task and its result: those kept before too.
    """

    kept: Callable[[int, int], None] = field(default=lambda *_: None)
    done: Callable[[T, R], None] = field(default=lambda *_: None)


def run_tasks(
    tasks: Sequence[T],
    work: Callable[[T], R],
    executor: Executor,
    *,
    lost: Callable[[T, LostTaskError], R],
    shelf: ResultCache[T, R] | None = None,
    listener: ProgressListener[T, R] | None = None,
) -> list[R]:
    """Return the results of tasks in their order: what is kept as it is, the rest done and kept.

    Of tasks without a result those that crashed are kept: they would again. One that was stopped,
    for its limits or from outside, may well be done the next time, and so it is tried again.

    Parameters
    ----------
    tasks : sequence
    work : callable
        A function of a module, so that it can be sent to a process.
    executor : Executor
    lost : callable
        Returns the result of a task that took its process with it, or was stopped.
    shelf : Shelf, optional
    listener : Listener, optional

    Raises
    ------
    Exception
        What `work` raises, after which nothing more is begun. It says how much is kept.
    """
    campaign = _Campaign(
        tasks=tasks,
        work=work,
        executor=executor,
        lost=lost,
        shelf=shelf,
        listener=listener or ProgressListener(),
    )
    try:
        return campaign.run()
    except BaseException as error:  # Ctrl-C too
        campaign.cancel()
        error.add_note(campaign.account())
        raise


@dataclass(slots=True, kw_only=True)
class _Campaign(Generic[T, R]):
    """The state of one call of `complete`."""

    tasks: Sequence[T]
    work: Callable[[T], R]
    executor: Executor
    lost: Callable[[T, LostTaskError], R]
    shelf: ResultCache[T, R] | None
    listener: ProgressListener[T, R]
    results: dict[int, R] = field(default_factory=dict)
    pending: dict[Future[R], int] = field(default_factory=dict)
    kept: deque[int] = field(default_factory=deque)
    left: deque[int] = field(default_factory=deque)
    safe: int = 0

    def run(self) -> list[R]:
        """Do what is left, read what is kept."""
        for index, task in enumerate(self.tasks):
            known = self.shelf is not None and self.shelf.has(task)
            (self.kept if known else self.left).append(index)
        self.listener.kept(len(self.kept), len(self.tasks))
        window = getattr(self.executor, "window", len(self.tasks))
        while self.left or self.pending or self.kept:
            while self.left and len(self.pending) < window:
                self._begin(self.left.popleft())
            if self.kept:
                self._read()
            # while there is something to read, do not wait
            done, _ = wait(self.pending, 0.0 if self.kept else None, FIRST_COMPLETED)
            for future in done:
                self._end(future, self.pending.pop(future))
        return [self.results[index] for index in range(len(self.tasks))]

    def cancel(self) -> None:
        """Begin nothing more."""
        for future in self.pending:
            future.cancel()

    def account(self) -> str:
        """Return in a sentence how much is done, and where."""
        if self.shelf is None:
            return f"{len(self.results)} of {len(self.tasks)} were done, and nothing is kept."
        kept = self.safe + len(self.kept)
        return f"{kept} of {len(self.tasks)} are done and kept in '{self.shelf.store.folder}'."

    def _begin(self, index: int) -> None:
        """Hand out a task."""
        task = self.tasks[index]
        if self.shelf is not None:
            self.shelf.begun(task)
        try:
            future = self.executor.submit(self.work, task)
        except BrokenExecutor as error:
            future = Future()
            future.set_exception(error)
        self.pending[future] = index

    def _read(self) -> None:
        """Take the next result that is kept; one that cannot be read is done again."""
        with delay_signals():
            index = self.kept.popleft()
            found = None if self.shelf is None else self.shelf.get(self.tasks[index])
            if found is None:
                self.left.append(index)
                return
            self.safe += 1
        self._finish(index, found)

    def _end(self, future: Future[R], index: int) -> None:
        """Keep what came of a task."""
        task, keep = self.tasks[index], True
        try:
            result = future.result()
        except BrokenExecutor as error:
            loss = (
                error
                if isinstance(error, LostTaskError)
                else LostTaskError(Loss.STOPPED, _WITH_ANOTHER.format(error))
            )
            result, keep = self.lost(task, loss), loss.loss is Loss.CRASHED
        if self.shelf is not None and keep:
            with delay_signals():  # what is kept is counted, whatever comes meanwhile
                self.shelf.put(task, result)
                self.safe += 1
        self._finish(index, result)

    def _finish(self, index: int, result: R) -> None:
        self.results[index] = result
        self.listener.done(self.tasks[index], result)


_WITH_ANOTHER = "its process died, or one beside it, before it was done: {}"


@cache
def _machine() -> str:
    """Return the processor of this machine."""
    return provenance().processor
