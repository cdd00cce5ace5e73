"""What commands print: tables for people, one JSON object for programs; and single files.

A file is written whole or not at all, and never over a folder.
"""

import json
import math
from collections.abc import Collection, Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.table import Table

from harness.core.verdict import Verdict
from harness.core.writing import writing
from harness.execution.atomic_write import write_atomically

if TYPE_CHECKING:
    from harness.core.report_model import Table as Data
    from harness.core.simulation import ParityRow

_VERDICT_STYLES = {
    "equal": "green",
    "imposed": "yellow",
    "mismatch": "bold red",
    "does not apply": "dim",
    "not checked": "dim",
}


def to_json(answer: Mapping[str, Any]) -> str:
    """Return the answer of `--json`: one object, with null for NaN and infinity."""
    return json.dumps(_finite(answer), indent=2, allow_nan=False)


def _finite(value: Any) -> Any:  # noqa: ANN401 - JSON is of any type
    """Return a value with None for NaN and infinity."""
    if isinstance(value, Mapping):
        return {key: _finite(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(inner) for inner in value]
    if isinstance(value, Verdict):
        return value.text
    if isinstance(value, float):
        return float(value) if math.isfinite(value) else None
    return value


def stdout_console() -> Console:
    """Return the console of answers; wide enough for tables when it is not a terminal."""
    console = Console(highlight=False)
    return console if console.is_terminal else Console(highlight=False, width=200)


def table(
    title: str,
    columns: Sequence[str],
    rows: Iterable[Sequence[object]],
    apart: Iterable[Sequence[object]] = (),
) -> Table:
    """Return a table for the terminal; numbers are set flush right.

    Rows of engines that impose rolling stand apart, below the others, and the caption says why.
    """
    lines, constraints = [list(row) for row in rows], [list(row) for row in apart]
    shown_table = Table(title=title, title_justify="left", title_style="bold")
    for index, column in enumerate(columns):
        numeric = all(isinstance(line[index], int | float | None) for line in lines + constraints)
        shown_table.add_column(column, justify="right" if numeric else "left", overflow="fold")
    for line in lines:
        shown_table.add_row(*(_cell(value) for value in line))
    if constraints:
        from harness.engines.description import APART  # noqa: PLC0415 - a list needs no engine

        shown_table.caption, shown_table.caption_justify = f"Last rows: {APART}", "left"
        shown_table.add_section()
        for line in constraints:
            shown_table.add_row(*(_cell(value) for value in line))
    return shown_table


def table_artefact(artefact: "Data", left_out: Collection[str] = ()) -> Table:
    """Return for the terminal the columns of a table that the page shows, but those left out."""
    # imports pandas and pyarrow
    from harness.report.tables import ranked, records, shown  # noqa: PLC0415

    columns = [name for name in shown(artefact) if name not in left_out]
    groups = [
        [[row[name] for name in columns] for row in rows] for rows in ranked(records(artefact))
    ]
    return table(artefact.title, columns, *groups)


def parity(rows: "Sequence[ParityRow]") -> Table:
    """Return the parity table for the terminal, differences in colour."""
    columns = ("quantity", "unit", "declared", "found", "verdict", "how")
    cells = [{column: getattr(row, column) for column in columns} for row in rows]
    for row in cells:
        row["verdict"] = f"[{_VERDICT_STYLES[row['verdict']]}]{row['verdict']}[/]"
    title = "Model parity: the can of the scene and the can in the engine"
    return table(title, columns, [list(row.values()) for row in cells])


def _cell(value: object) -> str:
    """Return a value as the terminal shows it."""
    if value is None or value in ([], ()) or (isinstance(value, float) and math.isnan(value)):
        return "-"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, list | tuple):
        return ", ".join(map(_cell, value))
    return str(value)


def write_bytes(content: bytes, out: Path) -> None:
    """Write a file under another name and move it into place.

    Raises
    ------
    OutputError
        If the file cannot be written.
    """
    with writing(out):
        write_atomically(out.absolute(), content)


def write_text(text: str, out: Path) -> None:
    """Write a text as UTF-8; see `write_bytes`."""
    write_bytes(text.encode(), out)
