"""What concerns the paper: the audit of its claims, and its figures drawn again."""

import json
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.markup import escape

from harness import paper
from harness.cli import terminal
from harness.cli.terminal import write_text
from harness.core.engine_packages import install_command
from harness.core.errors import HarnessError
from harness.core.provenance import provenance
from harness.core.writing import writing
from harness.paper.audit import CLAIMS, audit_table, audit_words, counts, markdown
from harness.paper.gallery import ABOUT, FIGURES
from harness.progress import ItemBar, report_progress
from harness.report.atomic_folder import check_writable
from harness.report.tables import csv_text
from harness.report.write import write_report

if TYPE_CHECKING:
    from harness.core.report_model import Figure, Prose
    from harness.paper.audit import AuditRow

_SECONDS = json.loads((Path(paper.__file__).parent / "usual_seconds.json").read_text("utf-8"))
"""s of processor for long claims of the audit, and for figures: `python -m tests.usual_seconds`."""

_SHORT = 0.06
"""s of processor for any other claim, on average."""


def _efforts(command: str, labels: Iterable[str]) -> dict[str, float]:
    """Return what each claim or figure is expected to take, s."""
    return {label: _SECONDS[command].get(label, _SHORT) for label in labels}


class MissingMathematicsError(HarnessError, ImportError):
    """The audit's symbolic mathematics is not installed.

    Parameters
    ----------
    reason : str
        Why it cannot be imported.
    """

    def __init__(self, reason: str) -> None:
        super().__init__(reason)
        self.reason, self.install = reason, install_command(["rockingcan[paper]"])

    def __str__(self) -> str:
        """Say how the packages are installed."""
        return (
            f"the audit needs sympy and mpmath, which cannot be imported ({self.reason}); "
            f"install them with: {self.install}"
        )


def audit(
    out: Annotated[Path, typer.Option(help="Folder to write into; made if it is missing.")] = Path(
        "reports"
    ),
    page: Annotated[
        Path | None,
        typer.Option(help="Write a report into this folder too, to join to those of others."),
    ] = None,
) -> None:
    """Every equation and number of the paper, checked.

    Written to audit.md and audit.csv.
    """
    try:
        # here and not above: sympy and mpmath are an extra, and every other command does without
        from harness.paper.audit.checks import audit as run  # noqa: PLC0415
    except ImportError as error:
        raise MissingMathematicsError(str(error)) from error
    with writing(out, "to"):
        out.mkdir(parents=True, exist_ok=True)
    if page is not None:
        check_writable(page)
    rows: list[AuditRow] = []
    with ItemBar(_efforts("audit", (claim.label for claim in CLAIMS)), "claim") as bar:
        for claim, row in zip(
            CLAIMS, run(CLAIMS, lambda claim: bar.label(claim.label)), strict=True
        ):
            rows.append(row)
            bar.advance(claim.label)
    write_text(markdown(rows), out / "audit.md")
    write_text(csv_text(audit_table(rows)), out / "audit.csv")
    if page is not None:
        artefacts = (audit_words(rows), audit_table(rows))
        title = "Audit of the paper"
        write_report(artefacts, page, title=title, cases=(), provenance=provenance())
    numbers = [(status.value, number) for status, number in counts(rows).items()]
    console = terminal.stdout_console()
    console.print(terminal.table("Audit of the paper", ("verdict", "claims"), numbers))
    console.print(escape(f"\nEvery claim: {out / 'audit.md'}"))


def gallery(
    out: Annotated[Path, typer.Option(help="Folder of the gallery; replaced as a whole.")] = Path(
        "reports/gallery"
    ),
) -> None:
    """Every figure of the paper, from our own solutions.

    Written as SVG and PNG, and as a page.
    """
    check_writable(out)
    drawn: list[Figure | Prose] = [ABOUT]
    with ItemBar(_efforts("gallery", (draw.__name__ for draw in FIGURES)), "figure") as bar:
        for draw in FIGURES:
            bar.label(draw.__name__.replace("_", " "))
            drawn.append(draw())
            bar.advance(draw.__name__)
    with report_progress() as progress:
        page = write_report(
            drawn,
            out,
            title="The figures of the paper",
            cases=(),
            provenance=provenance(),
            figures=True,  # what the command is for
            on_progress=progress,
        )
    terminal.stdout_console().print(escape(f"The gallery: {page}"))
