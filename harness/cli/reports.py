"""Commands on written reports: one page of several, and the differences of two.

Two reports are of two versions of an engine, two machines or two settings; nothing runs again.
"""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.markup import escape

from harness.cli import terminal
from harness.cli.options import Figures, Json
from harness.core.provenance import provenance
from harness.core.report_model import Artefact, Prose, Table, rows_of
from harness.core.verdict import Status
from harness.gate.comparison import Difference, differences
from harness.gate.errors import NoCommonCaseError
from harness.gate.report import SIDES, changed, gate_report, regressions, sentences
from harness.progress import report_progress
from harness.report.atomic_folder import check_writable
from harness.report.layout import Section
from harness.report.stored import read_report
from harness.report.write import write_chapters
from harness.results.files import read_baseline, read_scores
from harness.results.result import Result

_ROWS = 40
"""Of the table of changes in the terminal; the report has all."""

_QUIET = (Status.SAME, Status.NOT_JUDGED, Status.UNDECIDABLE)
"""Verdicts that the terminal leaves out."""


def report(
    folders: Annotated[
        list[Path],
        typer.Argument(metavar="FOLDER...", help="Reports to join, such as reports/latest."),
    ],
    out: Annotated[Path, typer.Option(help="Folder of the page; replaced as a whole.")] = Path(
        "reports/all"
    ),
    figures: Figures = False,  # noqa: FBT002 - a switch of the command line
) -> None:
    """One page from the reports of several studies.

    Its scorecard is filled from all of them.

    For example: rockingcan report reports/latest reports/stability reports/cost/paper-release
    """
    check_writable(out)
    chapters = joined_sections(folders)
    with report_progress() as progress:
        page = write_chapters(
            chapters,
            out,
            title="rockingcan",
            provenance=provenance(),
            figures=figures,
            on_progress=progress,
        )
    terminal.stdout_console().print(escape(f"{len(chapters)} studies in one report: {page}"))


def joined_sections(folders: Sequence[Path]) -> list[Section]:
    """Return the chapters of reports that were written earlier.

    Raises
    ------
    ReportError
        If a folder holds no report.
    """
    return [chapter for folder in folders for chapter in read_report(folder)]


def show_changes(artefacts: Sequence[Artefact]) -> None:
    """Print the changes that a comparison found, then its sentences."""
    console = terminal.stdout_console()
    for artefact in artefacts:
        if isinstance(artefact, Table):
            moved = artefact.frame[[v.status not in _QUIET for v in artefact.frame["verdict"]]]
            if len(moved):
                top = replace(artefact, title="What has changed", frame=moved.head(_ROWS))
                console.print(terminal.table_artefact(top, {"case"}))
            if len(moved) > _ROWS:
                console.print(f"... and {len(moved) - _ROWS} more")
    for artefact in artefacts:
        if isinstance(artefact, Prose):
            console.print(escape(artefact.text))


def changes_record(
    compared: Sequence[Difference], first: Result, second: Result, spreads: Result | None = None
) -> dict[str, Any]:
    """Return what `--json` prints of a comparison: its changes, and its sentences."""
    return {
        "differences": rows_of(SIDES.columns(), changed(compared)),
        "sentences": sentences(compared, first, second, SIDES, spreads),
    }


def diff(
    a: Annotated[
        Path,
        typer.Argument(metavar="A", help="Folder of a report or of accepted results, or a result."),
    ],
    b: Annotated[Path, typer.Argument(metavar="B", help="The same, to hold against it.")],
    baseline: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR",
            help="Accepted results whose measured spread tells what may differ: reports have none.",
        ),
    ] = None,
    gate: Annotated[  # noqa: FBT002 - a switch of the command line
        bool, typer.Option("--gate", help="Leave with code 1 if anything is better in A.")
    ] = False,
    json: Json = False,  # noqa: FBT002 - a switch of the command line
) -> None:
    """What differs between two reports, case by case.

    They are reports of `validate`, or a report and accepted results; quantities are compared one by
    one.

    For example: rockingcan diff reports/before reports/after --baseline reports/baseline
    """
    first, second = read_scores(a), read_scores(b)
    spreads = None if baseline is None else read_baseline(baseline)
    if not set(first.scores) & set(second.scores):
        raise NoCommonCaseError(a=a, b=b)
    compared = differences(first, second, spreads=spreads)
    if json:
        typer.echo(terminal.to_json(changes_record(compared, first, second, spreads)))
    else:
        show_changes(gate_report(compared, first, second, SIDES, spreads))
    if gate and regressions(compared):
        raise typer.Exit(1)
