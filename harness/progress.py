"""Progress of long work: a bar in the terminal, or in a notebook, that leaves when it is done."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self

from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)

if TYPE_CHECKING:
    from harness.studies.study import StudyProgress

_LABEL = 60
"""Letters of a task's name: a line of a terminal has room for them and the bar."""


def progress_bar() -> Progress:
    """Return a progress bar on standard error that leaves when it is done."""
    return Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
        console=Console(stderr=True),
        transient=True,
    )


@contextmanager
def report_progress() -> Iterator[Callable[[str, int, int], None]]:
    """Show a bar while a report is written; gives the `on_progress` of `write_report`."""
    with progress_bar() as bar:
        task = bar.add_task("writing the report", total=None)

        def show(part: str, done: int, total: int) -> None:
            description = f"writing the report: {part[:_LABEL]}"
            bar.update(task, completed=done, total=total, description=description)

        yield show


def in_notebook() -> bool:
    """Whether the program is the kernel of a notebook."""
    return Console().is_jupyter


class StudyBar:
    """The bar of a study; begins with the first progress, so that wrong use is told without one.

    In a notebook it is one output that is replaced each time: an output of `ipywidgets`, which the
    library of the bar would take, leaves a dead widget in the saved notebook.
    """

    def __init__(self) -> None:
        self._bar = progress_bar()
        self._task = self._bar.add_task("starting the engines", total=None)
        self._notebook = in_notebook()
        self._output: Any = None

    def __enter__(self) -> Self:
        """Return the bar itself."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Take the bar away."""
        if self._output is not None:
            self._output.update({}, raw=True)
        elif self._bar.live.is_started:
            self._bar.stop()

    def show(self, progress: "StudyProgress") -> None:
        """Show how far a study is; the `on_progress` of `run_study`."""
        self._bar.update(
            self._task,
            completed=progress.done,
            total=progress.total,
            description=f"{progress.work}: {progress.label[:_LABEL]}",
        )
        if not self._notebook:
            self._bar.start()
        elif self._output is not None:
            self._output.update(self._bar)
        else:
            from IPython.display import display  # noqa: PLC0415 - a notebook has it

            self._output = display(self._bar, display_id=True)  # type: ignore[no-untyped-call]
