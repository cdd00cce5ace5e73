"""Bars of progress: what they say is said as it is."""

import io

import pytest
from rich.console import Console

from harness.execution.estimate import Estimate
from harness.progress import ProgressBar, report_progress

TITLE = "curves of [/b] and [red]all[/]"


@pytest.fixture
def terminal(monkeypatch: pytest.MonkeyPatch) -> io.StringIO:
    """Make a terminal of what the bars are printed to."""
    printed = io.StringIO()

    def console(**_: object) -> Console:
        return Console(file=printed, force_terminal=True, force_jupyter=False, width=200)

    monkeypatch.setattr("harness.progress.Console", console)
    return printed


def test_a_part_of_a_report_is_named_as_it_is(terminal: io.StringIO) -> None:
    with report_progress() as show:
        show(TITLE, 1, 2)
    assert f"writing the report: {TITLE} " in terminal.getvalue()


def test_a_step_of_a_study_is_named_as_it_is(terminal: io.StringIO) -> None:
    with ProgressBar() as bar:
        bar.update(TITLE, 1, 2, Estimate(1))
    assert f"{TITLE} " in terminal.getvalue()
