"""Tables as files: CSV, Parquet and Markdown, and the dictionary of their columns.

CSV follows RFC 4180. A text that a spreadsheet would run as a formula gets an apostrophe in front
(OWASP, CSV injection); numbers keep every digit. The same table gives the same bytes.

The same as the page shows it: headings with units, cells with what they sort by and link to.

A table row by row, as the report reads what studies wrote.
"""

import csv
import io
import re
from collections.abc import Collection, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal, TypeVar

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from harness.core.plain_json import is_missing
from harness.core.report_model import Table
from harness.core.verdict import Verdict
from harness.engines.description import APART
from harness.engines.registry import is_constraint
from harness.report.number_format import heading, is_number, readable, slug

if TYPE_CHECKING:
    import pandas as pd

_FORMULA = ("=", "+", "-", "@", "\t", "\r")
_MARKDOWN = re.compile(r"([\\`*_\[\]<>|~#$])")


def csv_text(table: Table) -> str:
    """Return the whole table as CSV with a header line."""
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\r\n")
    writer.writerow([_harmless(str(name)) for name in table.frame.columns])
    writer.writerows([_csv_cell(value) for value in row.values()] for row in records(table))
    return text.getvalue()


def parquet_bytes(table: Table) -> bytes:
    """Return the whole table as Parquet; each field carries the meaning of its column."""
    fields, arrays = [], []
    for name in table.frame.columns:
        array = pa.array(_one_type(table.frame[name]), from_pandas=True)
        meaning = {"description": table.columns.get(str(name), "")}
        fields.append(pa.field(str(name), array.type, metadata=meaning))
        arrays.append(array)
    schema = pa.schema(fields, metadata={"title": table.title})
    sink = pa.BufferOutputStream()
    pq.write_table(pa.Table.from_arrays(arrays, schema=schema), sink, compression="zstd")
    return bytes(sink.getvalue().to_pybytes())


def markdown(table: Table) -> str:
    """Return the shown columns as a Markdown table, rounded to be read."""
    columns = shown(table)
    numeric = [is_numeric(table, name) for name in columns]
    titles = [_title(name) for name in columns]
    lines = [
        _line(plain_text(title) for title in titles),
        _line("---:" if right else "---" for right in numeric),
    ]
    contacts, apart = (
        [_line(plain_text(_judged(row, name, table)) for name in columns) for row in rows]
        for rows in ranked(records(table))
    )
    if apart:
        contacts += ["", plain_text(APART), "", *lines, *apart]
    return "\n".join([*lines, *contacts]) + "\n"


def _judged(row: Mapping[str, object], name: str, table: Table) -> str:
    """Return a cell in words, with the verdict on it where there is one."""
    verdict = row.get(table.verdicts.get(name, ""))
    if is_missing(verdict):
        return readable(row[name])
    return str(verdict) if is_missing(row[name]) else f"{readable(row[name])}, {verdict}"


def dictionary(tables: Iterable[Table]) -> str:
    """Return the meaning of each column of each table, in Markdown."""
    parts = ["# Columns of the tables in this report\n"]
    for table in tables:
        parts.append(f"## {plain_text(table.title)}\n")
        parts.append(f"{plain_text(table.name)}: {len(table.frame)} rows\n")
        lines = [_line(("column", "meaning")), _line(("---", "---"))]
        lines += [
            _line((plain_text(str(name)), plain_text(table.columns.get(str(name), ""))))
            for name in table.frame.columns
        ]
        parts.append("\n".join(lines) + "\n")
    return "\n".join(parts)


def shown(table: Table) -> tuple[str, ...]:
    """Return the columns that the page shows: the table's choice, or all."""
    return table.shown or tuple(str(name) for name in table.frame.columns)


def is_numeric(table: Table, column: str) -> bool:
    """Return whether a column holds numbers only, so that it is set to the right."""
    present = [value for value in table.frame[column].tolist() if not is_missing(value)]
    return bool(present) and all(is_number(value) for value in present)


def plain_text(text: str) -> str:
    """Return a text so that Markdown shows it as it is, on one line."""
    return _MARKDOWN.sub(r"\\\1", " ".join(text.split())).replace("&", "&amp;")


def _title(column: str) -> str:
    words, unit = heading(column)
    return f"{words} ({unit})" if unit else words


def _line(cells: Iterable[str]) -> str:
    return f"| {' | '.join(cells)} |"


def _csv_cell(value: object) -> str:
    if is_missing(value):
        return ""
    if isinstance(value, bool):
        return "true" if value else "false"
    if is_number(value):
        return repr(value)
    return _harmless(str(value))


def _harmless(text: str) -> str:
    return f"'{text}" if text.startswith(_FORMULA) else text


def _one_type(column: "pd.Series[Any]") -> "pd.Series[Any] | Sequence[object]":
    """Return a column that Parquet can hold: one type, mixed ones as text."""
    if column.dtype != np.dtype(object):
        return column
    values = [None if is_missing(value) else value for value in column.tolist()]
    there = [value for value in values if value is not None]
    plain = all(isinstance(value, (bool, int, float, str)) for value in there)
    if plain and len({type(value) for value in there}) <= 1:
        return values
    kind = float if all(is_number(value) for value in there) else str
    return [None if value is None else kind(value) for value in values]


Row = Mapping[str, Any]


def records(table: Table) -> list[Row]:
    """Return each row by column name, with None for missing cells."""
    columns = {str(name): table.frame[name].tolist() for name in table.frame.columns}
    return [
        {n: None if is_missing(v) else v for n, v in zip(columns, row, strict=True)}
        for row in zip(*columns.values(), strict=True)
    ]


Tone = Literal["", "good", "fair", "bad", "none"]

CASE = ("case", "digest")  # columns whose digests link to the cases
COMMAND = "command"  # the column with what runs a row again
_MOST = 400  # rows; a page of all studies stays below 12 MB, and no reader goes through more
_LONG = 36  # letters; longer texts break into lines
_JUDGED = ("verdict", "outcome")
_TONES: dict[Tone, str] = {
    "good": "agrees better equal finished passed",
    "fair": "deviates imposed",
    "bad": "failed worse timed flat overturned diverged mismatch",
    "none": "unsupported undecidable not",
}
"""By tone the first words of statuses and outcomes."""


def grid(name: str, table: Table, digests: Collection[str]) -> dict[str, Any]:
    """Return the shown columns of a table, as its template takes them.

    Parameters
    ----------
    name : str
        Of its files and anchor.
    table : Table
    digests : collection of str
        Cases that the page lists; a cell in the column `case` that names one links to it.

    Returns
    -------
    dict
        `heads` with words, unit and meaning; `rows` of cells: what is read, what it sorts by, all
        its digits, where it leads, how it is judged, and the verdict that stands beside a number;
        `meanings` of all columns; `count` of the rows that the files have; `apart`, the rows of
        engines that impose rolling, and why they are.
    """
    heads = [_head(table, column) for column in _on_page(table)]
    contacts, constraints = (
        [[_cell(head, row, table, digests) for head in heads] for row in rows[:_MOST]]
        for rows in ranked(table.frame.to_dict("records"))
    )
    return {
        "name": name,
        "title": table.title,
        "heads": heads,
        "rows": contacts,
        "apart": constraints,
        "why_apart": APART,
        "count": len(table.frame),
        "judged": bool(table.verdicts),
        "meanings": [(str(c), table.columns.get(str(c), "")) for c in table.frame.columns],
    }


def _head(table: Table, column: str) -> dict[str, Any]:
    words, unit = heading(column)
    return {
        "words": words,
        "unit": unit,
        "name": column,
        "meaning": table.columns.get(column, ""),
        "numeric": is_numeric(table, column),
    }


def _on_page(table: Table) -> tuple[str, ...]:
    """Return the columns that the page shows: those chosen, and the one that leads to the case."""
    chosen = shown(table)
    if table.cases or any(name in chosen for name in (*CASE, COMMAND)):
        return chosen
    way = next((name for name in (*CASE, COMMAND) if name in table.frame.columns), None)
    return chosen if way is None else (*chosen, way)


def _cell(
    head: Mapping[str, Any], row: Mapping[Any, Any], table: Table, digests: Collection[str]
) -> dict[str, Any]:
    name, value = head["name"], row[head["name"]]
    missing = is_missing(value)
    number = is_number(value) and not missing
    text = readable(value)
    verdict = row.get(table.verdicts.get(name, ""))
    judged = name.endswith(_JUDGED) or verdict
    digest = text if name in CASE else str(row.get(table.cases.get(name, "")))
    return {
        "text": text,
        "sort": "" if missing else (repr(float(value)) if number else text.lower()),
        "exact": repr(value) if number else "",
        "link": f"case-{slug(digest)}" if digest in digests else "",
        "long": len(text) > _LONG,
        "tone": tone(value if verdict is None else verdict) if judged else "",
        "verdict": "" if is_missing(verdict) else str(verdict),
        "code": name == COMMAND and not missing,
        "numeric": head["numeric"],
    }


def tone(judged: object) -> Tone:
    """Return how a verdict or an outcome is coloured, which repeats what it says."""
    text = judged.status.value if isinstance(judged, Verdict) else str(judged).lower()
    word, *_ = text.split() or [""]
    return next((t for t, words in _TONES.items() if word.strip(":,.;") in words.split()), "")


R = TypeVar("R", bound=Mapping[Any, Any])


def ranked(rows: Sequence[R]) -> tuple[list[R], list[R]]:
    """Return the rows of a table that are compared with each other, and those that stand apart.

    Apart are the rows of engines that impose rolling, in a table with other rows: `APART` says why.
    """
    constraints = [row for row in rows if is_constraint(str(row.get("engine", "")))]
    if len(constraints) in {0, len(rows)}:
        return list(rows), []
    return [row for row in rows if not is_constraint(str(row.get("engine", "")))], constraints
