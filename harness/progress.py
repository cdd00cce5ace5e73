"""Progress of long work: how long it will take, and a bar that leaves when it is done.

A line before work of ten seconds and more says how long it will take, and a line after it how long
it took: in a file of what was printed, too. The bar is shown in a terminal and in a notebook.
"""

import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self

from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    ProgressColumn,
    Task,
    TextColumn,
    TimeElapsedColumn,
)
from rich.text import Text

from harness.execution.estimate import (
    Estimate,
    Expected,
    Taken,
    account,
    announcement,
    side_by_side,
)

if TYPE_CHECKING:
    from harness.studies.study import StudyProgress

_LABEL = 60
"""Letters of a task's name: a line of a terminal has room for them and the bar."""


class _TimeLeft(ProgressColumn):
    """Time left by the estimate, which the clock shortens between two tasks."""

    def render(self, task: Task) -> Text:
        """Return hours, minutes and seconds."""
        left, at = task.fields.get("left"), task.fields.get("at", 0.0)
        if left is None:
            return Text("-:--:--", style="progress.remaining")
        seconds = max(0, round(left - (task.get_time() - at)))
        minutes, hours = seconds // 60 % 60, seconds // 3600
        return Text(f"{hours}:{minutes:02}:{seconds % 60:02}", style="progress.remaining")


def _bar() -> Progress:
    """Return a bar on standard error that leaves when it is done."""
    return Progress(
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        _TimeLeft(),
        console=Console(stderr=True, highlight=False),
        transient=True,
    )


@contextmanager
def report_progress() -> Iterator[Callable[[str, int, int], None]]:
    """Show a bar while a report is written; gives the `on_progress` of `write_report`."""
    bar = _bar()
    bar.disable = not bar.console.is_terminal  # elsewhere it would leave an empty line
    with bar:
        task = bar.add_task("writing the report", total=None)

        def show(part: str, done: int, total: int) -> None:
            description = f"writing the report: {part[:_LABEL]}"
            bar.update(task, completed=done, total=total, description=description)

        yield show


def in_notebook() -> bool:
    """Whether the program is the kernel of a notebook."""
    return Console().is_jupyter


class ProgressBar:
    """The bar of some work; begins with the first step, so that wrong use is told without one.

    In a notebook it is one output that is replaced each time: an output of `ipywidgets`, which the
    library of the bar would take, leaves a dead widget in the saved notebook.

    Parameters
    ----------
    unit : str
        What one of its tasks is.
    """

    def __init__(self, unit: str = "run") -> None:
        self._bar, self._unit = _bar(), unit
        self._task = self._bar.add_task("starting the engines", total=None)
        self._notebook = in_notebook()
        self._output: Any = None
        self._began = time.monotonic()
        self._estimated: float | None = None

    def __enter__(self) -> Self:
        """Return the bar itself."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Take the bar away, and say how long it took if all is done."""
        if self._output is not None:
            self._output.update({}, raw=True)
        elif self._bar.live.is_started:
            self._bar.stop()
        if kind is None and self._estimated is not None:
            self._say(account(time.monotonic() - self._began, self._estimated))

    def _say(self, line: str) -> None:
        """Print a line above the bar."""
        if line and not self._notebook:
            self._bar.console.print(line)

    def update(self, label: str, done: int, total: int, estimate: Estimate) -> None:
        """Show how far the work is.

        Parameters
        ----------
        label : str
        done, total : int
            Of this part of the work.
        estimate : Estimate
            Of all that is left.
        """
        left = estimate.seconds
        if self._estimated is None:
            self._began, self._estimated = time.monotonic(), left
            self._say(announcement(left, estimate.tasks, estimate.cores, self._unit))
        self._bar.update(
            self._task,
            completed=done,
            total=total,
            description=label,
            left=left,
            at=self._bar.get_time(),
        )
        if not self._notebook:
            if self._bar.console.is_terminal:
                self._bar.start()
        elif self._output is not None:
            self._output.update(self._bar)
        else:
            from IPython.display import display  # noqa: PLC0415 - a notebook has it

            self._output = display(self._bar, display_id=True)  # type: ignore[no-untyped-call]

    def compiling(self, engine: str) -> None:
        """Say that an engine compiles itself, until something is done."""
        self._bar.update(self._task, description=f"compiling {engine}, minutes on first use")

    def show(self, progress: "StudyProgress") -> None:
        """Show how far a study is; the `on_progress` of `run_study`."""
        label = f"{progress.work}: {progress.label[:_LABEL]}"
        self.update(label, progress.done, progress.total, progress.estimate)


class ItemBar(ProgressBar):
    """The bar of a list of things that are done once each, in any order.

    Parameters
    ----------
    efforts : mapping of str to float
        By name: seconds of processor on a usual machine.
    unit : str
        What one of them is.
    executor : Executor, optional
        Where they are done; here if left out.
    cores : int
        How many are done at once, if the executor does not say.
    """

    def __init__(
        self, efforts: Mapping[str, float], unit: str, executor: object = None, cores: int = 1
    ) -> None:
        super().__init__(unit)
        cores, load = side_by_side(executor, cores)
        self._count, self._cores = len(efforts), cores
        # what runs beside it is in the efforts, for here the clock alone tells what a thing takes
        self._estimate = Estimate(cores)
        self._estimate.expect({n: Expected("", load * effort) for n, effort in efforts.items()})
        self._since = time.monotonic()

    def label(self, words: str) -> None:
        """Say what is being done."""
        done = self._count - self._estimate.tasks
        self.update(words[:_LABEL], done, self._count, self._estimate)

    def advance(self, name: str) -> None:
        """Take note that a thing is done."""
        now = time.monotonic()
        taken = self._cores * (now - self._since)
        self._since = now
        self._estimate.finish(name, Taken(taken, taken))
        self.label(name)
