"""A table as the page shows it: headings with units, cells with what they sort by and link to."""

from collections.abc import Collection, Mapping
from typing import Any, Literal

from harness.core.plain_json import is_missing
from harness.core.report_model import Table
from harness.core.verdict import Status, Verdict
from harness.report.number_format import heading, is_number, readable, slug
from harness.report.tables import is_numeric, shown

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
        `meanings` of all columns; `count` of the rows that the files have.
    """
    heads = [_head(table, column) for column in _on_page(table)]
    return {
        "name": name,
        "title": table.title,
        "heads": heads,
        "rows": [
            [_cell(head, row, table, digests) for head in heads]
            for row in table.frame.head(_MOST).to_dict("records")
        ],
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
    """Return the columns that the page shows: those chosen, and what leads to the case."""
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
    if isinstance(judged, Verdict):
        return _STATUS_TONES.get(judged.status, "")
    word, *_ = str(judged).lower().split() or [""]
    return _WORD_TONES.get(word.strip(":,.;"), "")
