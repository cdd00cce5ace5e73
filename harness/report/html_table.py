"""A table as the page shows it: headings with units, cells with what they sort by and link to."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import Literal

from harness.core.plain_json import is_missing
from harness.core.report_model import Table
from harness.core.verdict import Status, Verdict
from harness.report.number_format import heading, is_number, readable, slug
from harness.report.tables import is_numeric, rows, shown

Tone = Literal["", "good", "fair", "bad", "none"]

CASE = ("case", "digest")  # columns whose digests link to the cases
COMMAND = "command"  # the column with what runs a row again
_MOST = 400  # rows; a page of all studies stays below 12 MB, and no reader goes through more
_LONG = 36  # letters; longer texts break into lines
_JUDGED = ("verdict", "outcome")
_STATUS_TONES: dict[Status, Tone] = {
    Status.AGREES: "good",
    Status.BETTER: "good",
    Status.DEVIATES: "fair",
    Status.FAILED: "bad",
    Status.WORSE: "bad",
    Status.UNSUPPORTED: "none",
    Status.UNDECIDABLE: "none",
    Status.NOT_MEASURED: "none",
    Status.NOT_REACHED: "none",
    Status.NOT_JUDGED: "none",
}
_WORD_TONES: dict[str, Tone] = {
    "equal": "good",
    "finished": "good",
    "passed": "good",
    "imposed": "fair",
    "timed": "bad",
    "flat": "bad",
    "overturned": "bad",
    "diverged": "bad",
    "mismatch": "bad",
    "failed": "bad",
    "unsupported": "none",
    "undecidable": "none",
}  # by the first word of an outcome, and of what is judged in a word


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
    """A cell: what is read, what it sorts by, all its digits, where it leads, how it is judged.

    A verdict that stands beside a number has words of its own.
    """

    text: str
    sort: str
    exact: str
    link: str
    tone: Tone
    verdict: str
    code: bool
    numeric: bool
    long: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class Grid:
    """A table ready to be shown, its dictionary of all columns, how many rows its files have."""

    name: str
    title: str
    heads: tuple[Head, ...]
    rows: tuple[tuple[Cell, ...], ...]
    meanings: tuple[tuple[str, str], ...]
    judged: bool
    count: int


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
    heads = tuple(_head(table, column) for column in _on_page(table))
    names = [str(column) for column in table.frame.columns]
    return Grid(
        name=name,
        title=table.title,
        heads=heads,
        rows=tuple(
            tuple(_cell(head, dict(zip(names, row, strict=True)), table, digests) for head in heads)
            for row in rows(table.frame.head(_MOST))
        ),
        count=len(table.frame),
        judged=bool(table.verdicts),
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


def _on_page(table: Table) -> tuple[str, ...]:
    """Return the columns that the page shows: those chosen, and what leads to the case."""
    chosen = shown(table)
    if table.cases or any(name in chosen for name in (*CASE, COMMAND)):
        return chosen
    way = next((name for name in (*CASE, COMMAND) if name in table.frame.columns), None)
    return chosen if way is None else (*chosen, way)


def _cell(head: Head, row: Mapping[str, object], table: Table, digests: Collection[str]) -> Cell:
    value = row[head.name]
    missing = is_missing(value)
    number = is_number(value) and not missing
    text = readable(value)
    judged = head.name in _JUDGED or head.name.endswith(tuple(f"_{word}" for word in _JUDGED))
    verdict = row.get(table.verdicts.get(head.name, ""))
    digest = text if head.name in CASE else str(row.get(table.cases.get(head.name, "")))
    return Cell(
        text=text,
        sort="" if missing else (repr(float(str(value))) if number else text.lower()),
        exact=repr(value) if number else "",
        link=f"case-{slug(digest)}" if digest in digests else "",
        long=len(text) > _LONG,
        tone=tone(value if verdict is None else verdict) if judged or verdict else "",
        verdict="" if is_missing(verdict) else str(verdict),
        code=head.name == COMMAND and not missing,
        numeric=head.numeric,
    )


def tone(judged: object) -> Tone:
    """Return how a verdict or an outcome is coloured, which repeats what it says."""
    if isinstance(judged, Verdict):
        return _STATUS_TONES.get(judged.status, "")
    word, *_ = str(judged).lower().split() or [""]
    return _WORD_TONES.get(word.strip(":,.;"), "")
