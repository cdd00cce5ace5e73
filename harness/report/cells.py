"""A table as the page shows it: headings with units, cells with what they sort by and link to."""

from collections.abc import Collection
from dataclasses import dataclass
from typing import Literal

from harness.artefact import Table
from harness.report.digits import is_missing, is_number, readable
from harness.report.naming import heading, slug
from harness.report.tables import is_numeric, rows, shown

Tone = Literal["", "good", "fair", "bad", "none"]

CASE = "case"  # the column whose digests link to the cases
_LONG = 36  # letters; longer texts break into lines
_JUDGED = ("verdict", "outcome")
_TONES: dict[str, Tone] = {
    "agrees": "good",
    "equal": "good",
    "finished": "good",
    "ok": "good",
    "passed": "good",
    "yes": "good",
    "deviates": "fair",
    "imposed": "fair",
    "better": "good",
    "worse": "bad",
    "timed": "bad",
    "flat": "bad",
    "overturned": "bad",
    "diverged": "bad",
    "mismatch": "bad",
    "failed": "bad",
    "no": "bad",
    "unsupported": "none",
    "undecidable": "none",
    "not": "none",
}  # by the first word of a verdict


@dataclass(frozen=True, slots=True, kw_only=True)
class Head:
    """A column's heading."""

    words: str
    unit: str
    name: str
    meaning: str
    numeric: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class Cell:
    """A cell: what is read, what it sorts by, all its digits, where it leads, how it is judged."""

    text: str
    sort: str
    exact: str
    link: str
    tone: Tone
    numeric: bool
    long: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class Grid:
    """A table ready to be shown, and its dictionary of all columns."""

    name: str
    title: str
    heads: tuple[Head, ...]
    rows: tuple[tuple[Cell, ...], ...]
    meanings: tuple[tuple[str, str], ...]


def grid(name: str, table: Table, digests: Collection[str]) -> Grid:
    """Return the shown columns of a table.

    Parameters
    ----------
    name : str
        Of its files and anchor.
    table : Table
    digests : collection of str
        Cases that the page lists; a cell in the column `case` that names one links to it.
    """
    columns = shown(table)
    heads = tuple(_head(table, column) for column in columns)
    return Grid(
        name=name,
        title=table.title,
        heads=heads,
        rows=tuple(
            tuple(_cell(value, head, digests) for value, head in zip(row, heads, strict=True))
            for row in rows(table.frame[list(columns)])
        ),
        meanings=tuple((str(c), table.columns.get(str(c), "")) for c in table.frame.columns),
    )


def _head(table: Table, column: str) -> Head:
    words, unit = heading(column)
    return Head(
        words=words,
        unit=unit,
        name=column,
        meaning=table.columns.get(column, ""),
        numeric=is_numeric(table, column),
    )


def _cell(value: object, head: Head, digests: Collection[str]) -> Cell:
    missing = is_missing(value)
    number = is_number(value) and not missing
    text = readable(value)
    words = text.lower().split() or [""]
    judged = head.name in _JUDGED or head.name.endswith(tuple(f"_{word}" for word in _JUDGED))
    return Cell(
        text=text,
        sort="" if missing else (repr(float(str(value))) if number else text.lower()),
        exact=repr(value) if number else "",
        link=f"case-{slug(text)}" if head.name == CASE and text in digests else "",
        long=len(text) > _LONG,
        tone=_TONES.get(words[0].strip(":,.;"), "") if judged else "",
        numeric=head.numeric,
    )
