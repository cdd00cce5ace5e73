"""One page from the reports of several studies, without running anything again."""

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from harness.cli import printing
from harness.provenance import provenance
from harness.report import Chapter, check_writable, read_report, write_chapters


def report(
    folders: Annotated[
        list[Path],
        typer.Argument(metavar="FOLDER...", help="Reports to join, such as reports/latest."),
    ],
    out: Annotated[Path, typer.Option(help="Folder of the page; replaced as a whole.")] = Path(
        "reports/all"
    ),
) -> None:
    """Join the reports of several studies into one page, its scorecard filled from all of them.

    For example: rockingcan report reports/latest reports/stability reports/cost/paper-release
    """
    check_writable(out)
    chapters = joined(folders)
    page = write_chapters(chapters, out, title="rockingcan", provenance=provenance())
    printing.out().print(f"{len(chapters)} studies in one report: {page}")


def joined(folders: Sequence[Path]) -> list[Chapter]:
    """Return the chapters of reports that were written earlier.

    Raises
    ------
    ReportError
        If a folder holds no report.
    """
    return [chapter for folder in folders for chapter in read_report(folder)]
