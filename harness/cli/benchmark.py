"""How fast it is: the project's claims about speed, measured.

Try what must not lose work, and write down how it went.
"""

import tempfile
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import pandas as pd
import typer

from harness import api
from harness.benchmark.engines import engine_ratios
from harness.benchmark.lean import lean_ratios
from harness.benchmark.reference import reference_ratios
from harness.cli import terminal
from harness.cli.json_output import to_json
from harness.cli.terminal import write_text
from harness.core.errors import InvalidSettingError, OutputError
from harness.core.provenance import provenance
from harness.core.report_model import Table
from harness.faults.programs import end_all
from harness.faults.trial import Trial
from harness.faults.trials import TRIALS, Demands
from harness.report.tables import csv_text

_RATIO = ("what", "ratio", "claim", "holds", "first_s", "second_s", "note")

_LEAN = (
    *("scene", "who", "model", "ratio", "claim", "holds"),
    *("quantity", "difference", "tolerance", "lean_s", "everything_s"),
)


def benchmark(
    engine: Annotated[
        list[str] | None, typer.Option(help="An engine to measure; repeat it. All if left out.")
    ] = None,
    json: Annotated[  # noqa: FBT002 - a switch of the command line
        bool, typer.Option("--json", help="Print one JSON object and nothing else.")
    ] = False,
) -> None:
    """Measure what the project claims about speed, as ratios in one run; some three minutes.

    Leaves with code 1 if a claim does not hold on this machine.
    """
    ratios = []
    with terminal.progress_bar() as bar:
        task = bar.add_task("the reference", total=None)
        chosen = api.stepping_engines(engine)
        for part in (reference_ratios(), engine_ratios(chosen)):
            for ratio in part:
                ratios.append(ratio)
                bar.update(task, advance=1, description=ratio.what)
        lean = []
        for one in lean_ratios(chosen):
            lean.append(one)
            bar.update(task, advance=1, description=f"{one.who}: {one.scene}, lean")
    if json:
        told = {"ratios": [asdict(one) for one in ratios], "lean": [asdict(one) for one in lean]}
        typer.echo(to_json(told))
    else:
        for title, columns, measured in (
            ("Speed", _RATIO, ratios),
            ("Only the effects a scene calls for", _LEAN, lean),
        ):
            rows = [[getattr(one, column) for column in columns] for one in measured]
            terminal.stdout_console().print(terminal.table(title, columns, rows))
    if not (all(ratio.holds for ratio in ratios) and all(one.holds for one in lean)):
        raise typer.Exit(1)


_COLUMNS = {
    "trial": "What is tried",
    "done": "What was done to the program",
    "demanded": "What must come of it",
    "found": "What came of it",
    "passed": "Whether it is what must",
    "seconds_s": "How long the trial took",
}


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
    """Kill it, crash it, hang it, fill its disk, stop it, take its workers, sweep; write faults.md.

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
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(f"cannot write to '{out}': {error.strerror or error}") from error


def _tried(names: Sequence[str], demands: Demands) -> list[Trial]:
    """Carry trials out beside a progress bar; what an interrupted one began is ended."""
    found: list[Trial] = []
    with (
        terminal.progress_bar() as bar,
        tempfile.TemporaryDirectory(prefix="rockingcan-") as folder,
    ):
        task = bar.add_task("starting", total=len(names))

        def told(words: str) -> None:
            bar.update(task, description=words)

        try:
            for name in names:
                found.append(TRIALS[name](demands, Path(folder), told))
                bar.advance(task)
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
