"""What concerns the paper: the audit of its claims, and its figures drawn again."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from harness.cli import printing
from harness.cli.files import write_text
from harness.errors import HarnessError, OutputError
from harness.provenance import provenance
from harness.report import check_writable, write_report
from harness.report.tables import csv_text
from harness.studies.audit import Finding, audit_table, audit_words, counts, markdown
from harness.studies.gallery import ABOUT, FIGURES
from harness.studies.gallery import gallery as draw

if TYPE_CHECKING:
    from harness.artefact import Figure, Prose


class MissingMathematicsError(HarnessError, ImportError):
    """The audit's symbolic mathematics is not installed."""

    def __init__(self, reason: str) -> None:
        super().__init__(
            f"the audit needs sympy and mpmath, which cannot be imported ({reason}); "
            "install them with: pip install 'rockingcan[paper]'"
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
    """Check every equation and number of the paper; write audit.md and audit.csv."""
    try:
        # here and not above: sympy and mpmath are an extra, and every other command does without
        from harness.studies.audit.run import audit as run  # noqa: PLC0415
        from harness.studies.audit.run import claims  # noqa: PLC0415
    except ImportError as error:
        raise MissingMathematicsError(str(error)) from error
    _make(out)
    if page is not None:
        check_writable(page)
    chosen = claims()
    findings: list[Finding] = []
    with printing.progress() as bar:
        task = bar.add_task("reading the paper", total=len(chosen))
        for finding in run(chosen, lambda claim: bar.update(task, description=claim.label)):
            findings.append(finding)
            bar.advance(task)
    write_text(markdown(findings), out / "audit.md")
    write_text(csv_text(audit_table(findings)), out / "audit.csv")
    if page is not None:
        told = (audit_words(findings), audit_table(findings))
        title = "Audit of the paper"
        write_report(told, page, title=title, cases=(), provenance=provenance())
    rows = [(verdict.value, number) for verdict, number in counts(findings).items()]
    console = printing.out()
    console.print(printing.table("Audit of the paper", ("verdict", "claims"), rows))
    console.print(f"\nEvery claim: {out / 'audit.md'}")


def gallery(
    out: Annotated[Path, typer.Option(help="Folder of the gallery; replaced as a whole.")] = Path(
        "reports/gallery"
    ),
) -> None:
    """Draw every figure of the paper from our own solutions; write SVG, PNG and a page."""
    check_writable(out)
    drawn: list[Figure | Prose] = [ABOUT]
    with printing.progress() as bar:
        task = bar.add_task("drawing", total=len(FIGURES))
        for figure in draw():
            drawn.append(figure)
            bar.update(task, advance=1, description=figure.title)
    page = write_report(
        drawn, out, title="The figures of the paper", cases=(), provenance=provenance()
    )
    printing.out().print(f"The gallery: {page}")


def _make(out: Path) -> None:
    """Make the folder, or say at once why it cannot be."""
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(f"cannot write to '{out}': {error.strerror or error}") from error
