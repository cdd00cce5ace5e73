"""Artefacts as one file, so that a page can be made again, and of several studies together.

`artefacts.json` holds what the page was made of: tables with every digit, curves as the page shows
them, as base64 of little-endian doubles. What is read back makes the same page, byte for byte.
"""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from pydantic import TypeAdapter

from harness.core.errors import ReportError
from harness.report.layout import Section

ARTEFACTS = "artefacts.json"
VERSION = 2
"""Of the file; any other is refused. 2: verdicts have a status."""


@dataclass(frozen=True, slots=True, kw_only=True)
class StoredReport:
    """The content of `artefacts.json`."""

    format: str = "rockingcan-artefacts"
    version: int = VERSION
    chapters: tuple[Section, ...]


_REPORT = TypeAdapter(StoredReport)


def to_json(chapters: Sequence[Section]) -> str:
    """Return chapters as the text of `artefacts.json`."""
    data = _REPORT.dump_python(StoredReport(chapters=tuple(chapters)), mode="json")
    return json.dumps(data, ensure_ascii=False, allow_nan=False, separators=(",", ":")) + "\n"


def read_report(folder: Path) -> tuple[Section, ...]:
    """Return the chapters of a report that was written earlier.

    Raises
    ------
    ReportError
        If the folder holds no report, or one that this version cannot read.
    """
    path = folder / ARTEFACTS
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
        if data["version"] != VERSION:
            raise ReportError(
                f"cannot read '{path}': it is of version {data['version']}, this reads {VERSION}; "
                "write the report again with the command that made it"
            )
        return _REPORT.validate_python(data).chapters
    except OSError as error:
        raise ReportError(
            f"cannot read '{path}': {error.strerror or error}; name the folder of a report, "
            "such as reports/latest"
        ) from error
    except (ValueError, KeyError, TypeError) as error:
        raise ReportError(f"cannot read '{path}': it is no record of a report") from error
