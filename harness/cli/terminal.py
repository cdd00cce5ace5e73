"""What people read in the terminal.

Single files that a command writes: whole or not at all, and never over a folder.
"""

import math
import os
from collections.abc import Iterable, Sequence
from pathlib import Path

from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)
from rich.table import Table

from harness.cli.json_output import Answer
from harness.core.errors import OutputError
from harness.core.report_model import Table as Data
from harness.core.simulation import ParityRow
from harness.engines.reference.assumption_checks import PARTED
from harness.execution.atomic_write import write_atomically
from harness.metrics.motion import Motion, motion_frame

_VERDICT_STYLES = {"equal": "green", "imposed": "yellow", "mismatch": "bold red"}


def stdout_console() -> Console:
    """Return the console of answers; wide enough for tables when it is not a terminal."""
    console = Console(highlight=False)
    return console if console.is_terminal else Console(highlight=False, width=200)


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


def table(title: str, columns: Sequence[str], rows: Iterable[Sequence[object]]) -> Table:
    """Return a table for the terminal; numbers are set flush right."""
    lines = [list(row) for row in rows]
    made = Table(title=title, title_justify="left", title_style="bold")
    for index, column in enumerate(columns):
        numeric = all(isinstance(line[index], int | float | None) for line in lines)
        made.add_column(column, justify="right" if numeric else "left", overflow="fold")
    for line in lines:
        made.add_row(*(_cell(value) for value in line))
    return made


def table_artefact(artefact: Data, columns: Sequence[str]) -> Table:
    """Return some columns of an artefact's table for the terminal."""
    frame = artefact.frame.astype(object).where(artefact.frame.notna(), None)
    rows = frame[list(columns)].itertuples(index=False)
    return table(artefact.title, columns, rows)


def motion(answer: Answer) -> Iterable[Table]:
    """Yield the tables of a motion in numbers."""
    single = ("scene", "engine", "outcome", "period_s", "energy_drift", "steps", "wall_s")
    yield table("Motion", single, [[answer[key] for key in single]])
    if answer["bounces"]:
        keys = list(answer["bounces"][0])
        rows = [[bounce[key] for key in keys] for bounce in answer["bounces"]]
        yield table("Bounces", keys, rows)
    parts = {"errors": "Errors, engine minus truth", "contact": "Contact"}
    if _chaotic(answer):
        del parts["errors"]  # there are none, and `parting` says why
    for part, title in parts.items():
        if part in answer:
            yield table(title, list(answer[part]), [list(answer[part].values())])


def chaos_sentences(answer: Answer) -> Iterable[str]:
    """Yield how fast disturbances of a chaotic motion grow, in words; nothing of any other."""
    if _chaotic(answer):
        found = answer["divergence"]
        yield (
            f"Chaotic: a disturbance grows by e in {found['lyapunov_time_s']:.3g} s; one part in "
            f"1e12 becomes {PARTED:g} rad at {found['parted_s']:.3g} s, and beyond nothing can be "
            "compared."
        )


def choices(answer: Answer) -> Iterable[str]:
    """Yield what each declared effect supposes, a paragraph each."""
    yield from (f"Modelling choice: {sentence}" for sentence in answer["modelling_choices"])


def divergence_sentences(answer: Answer) -> Iterable[str]:
    """Yield in words how long a run can be compared with the exact motion, a paragraph each."""
    yield from chaos_sentences(answer)
    at, why = answer["parts_at_s"], ""
    if _chaotic(answer):
        why = " What differs in the end is no error, so no errors are given."
    if at is not None:
        yield f"The engine is {PARTED:g} rad away from the exact motion from {at:.3g} s on.{why}"
    elif why:
        yield f"The engine is never {PARTED:g} rad away from the exact motion.{why}"


def _chaotic(answer: Answer) -> bool:
    """Whether an answer says that a motion is chaotic."""
    return bool(answer.get("divergence") and answer["divergence"]["chaotic"])


def parity(rows: Sequence[ParityRow]) -> Table:
    """Return the parity table for the terminal, differences in colour."""
    return table(
        "Model parity: the can of the scene and the can in the engine",
        ("quantity", "unit", "declared", "found", "verdict", "how"),
        [
            (
                row.quantity,
                row.unit,
                row.declared,
                row.found,
                f"[{_VERDICT_STYLES[row.verdict]}]{row.verdict}[/]",
                row.how,
            )
            for row in rows
        ],
    )


def _cell(value: object) -> str:
    """Return a value as the terminal shows it."""
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return "-"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, list | tuple):
        if not value:
            return "-"
        return ", ".join(_cell(inner) for inner in value)
    return str(value)


_SUFFIXES = (".csv", ".parquet")


def write_motion(motion: Motion, out: Path) -> None:
    """Write a motion as a table in the format that the file's name asks for.

    Raises
    ------
    OutputError
        If the name ends otherwise, or the file cannot be written.
    """
    check_motion_file(out)
    frame = motion_frame(motion)
    if out.suffix == ".csv":
        write_bytes(frame.to_csv(index=False, lineterminator="\n").encode(), out)
    else:
        write_bytes(frame.to_parquet(index=False), out)


def check_motion_file(out: Path) -> None:
    """Refuse a file for a motion that could not be written later.

    Raises
    ------
    OutputError
        If its name ends otherwise than in a known suffix, or its folder cannot be written.
    """
    if out.suffix not in _SUFFIXES:
        raise OutputError(f"cannot write '{out}': its name must end in {' or '.join(_SUFFIXES)}")
    if out.is_dir() or not out.absolute().parent.is_dir():
        raise OutputError(f"cannot write '{out}': it must be a file in a folder that exists")
    if not os.access(out.absolute().parent, os.W_OK):
        raise OutputError(f"cannot write '{out}': its folder is not writable")


def write_text(text: str, out: Path) -> None:
    """Write a text as UTF-8, whole or not at all.

    Raises
    ------
    OutputError
        If the file cannot be written.
    """
    write_bytes(text.encode(), out)


def write_bytes(content: bytes, out: Path) -> None:
    """Write a file under another name and move it into place.

    Raises
    ------
    OutputError
        If the file cannot be written.
    """
    try:
        write_atomically(out.absolute(), content)
    except OSError as error:
        raise OutputError(f"cannot write '{out}': {error.strerror or error}") from error
