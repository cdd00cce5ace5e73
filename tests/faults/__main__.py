"""Try what must not lose work, and write down how it went: ``rockingcan faults``."""

import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import pandas as pd
import typer

from harness.cli import terminal
from harness.cli.main import main
from harness.cli.terminal import write_text
from harness.core.errors import InvalidSettingError
from harness.core.provenance import provenance
from harness.core.report_model import Table
from harness.core.writing import writing
from harness.progress import ItemBar
from harness.report.tables import csv_text
from tests.faults.programs import end_all
from tests.faults.trial import Trial
from tests.faults.trials import TRIALS, Demands, usual_seconds

app = typer.Typer(add_completion=False)

_COLUMNS = {
    "trial": "What is tried",
    "done": "What was done to the program",
    "demanded": "What must come of it",
    "found": "What came of it",
    "passed": "Whether it is what must",
    "seconds_s": "How long the trial took",
}


@app.command()
def faults(
    kills: Annotated[int, typer.Option(min=1, help="How many times the program is killed.")] = 50,
    only: Annotated[
        list[str] | None,
        typer.Option(
            metavar="TRIAL",
            help=f"Try this alone and write no report: {', '.join(TRIALS)}; repeat it.",
        ),
    ] = None,
    out: Annotated[Path, typer.Option(help="Folder to write into; made if it is missing.")] = Path(
        "reports"
    ),
) -> None:
    """What is lost when runs are killed, hang or fill the disk.

    Trials: kill, crash, hang, fill the disk, stop, take the workers, sweep. Writes faults.md.

    Leaves with code 1 if something was lost, or took too long.
    """
    for name in only or ():
        if name not in TRIALS:
            raise InvalidSettingError("--only", name, ", ".join(TRIALS))
    if not only:
        _make(out)
    found = _tried([name for name in TRIALS if not only or name in only], Demands(kills=kills))
    rows = [(t.name, "passed" if t.passed else "FAILED", "\n".join(t.found)) for t in found]
    console = terminal.stdout_console()
    console.print(terminal.table("Faults", ("trial", "verdict", "found"), rows))
    if not only:
        write_text(_markdown(found), out / "faults.md")
        write_text(csv_text(_table(found)), out / "faults.csv")
        console.print(f"\nThe report: {out / 'faults.md'}")
    if not all(trial.passed for trial in found):
        raise typer.Exit(1)


def _make(out: Path) -> None:
    """Make the folder of the report, before anything takes its time."""
    with writing(out, "to"):
        out.mkdir(parents=True, exist_ok=True)


def _tried(names: Sequence[str], demands: Demands) -> list[Trial]:
    """Carry trials out beside a progress bar; what an interrupted one began is ended."""
    found: list[Trial] = []
    efforts = usual_seconds(demands)
    with (
        ItemBar({name: efforts[name] for name in names}, "trial") as bar,
        tempfile.TemporaryDirectory(prefix="rockingcan-") as folder,
    ):
        bar.label("starting")
        try:
            for name in names:
                found.append(TRIALS[name](demands, Path(folder), bar.label))
                bar.advance(name)
        finally:
            end_all()
    return found


def _table(found: list[Trial]) -> Table:
    rows = [
        (t.name, t.done, t.demanded, "; ".join(t.found), t.passed, round(t.seconds, 1))
        for t in found
    ]
    frame = pd.DataFrame(rows, columns=list(_COLUMNS))
    return Table(name="faults", title="Faults", frame=frame, columns=_COLUMNS)


def _markdown(found: list[Trial]) -> str:
    """Return the report as a page of Markdown."""
    origin = provenance()
    where = f"{origin.platform}, {origin.cores} cores, Python {origin.python}"
    lines = [
        "# Faults",
        "",
        f"What must not lose work, tried on {where}. Written by `rockingcan faults`.",
        "",
        "| trial | verdict | s |",
        "|---|---|---:|",
        *(
            f"| {trial.name} | {'passed' if trial.passed else 'FAILED'} | {trial.seconds:.0f} |"
            for trial in found
        ),
    ]
    for trial in found:
        lines += [
            "",
            f"## {trial.name}",
            "",
            f"- Done: {trial.done}.",
            f"- Demanded: {trial.demanded}.",
            *(f"- Found: {part.rstrip('.')}." for part in trial.found),
        ]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    main(app, "rockingcan faults")
