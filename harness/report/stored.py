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


@dataclass(eq=False, kw_only=True)
class UnreadableReportError(ReportError):
    """The file `path` is no record of a report, and `reason` says why; `fix` may be empty."""

    path: Path
    reason: str
    fix: str = ""

    def __str__(self) -> str:
        """Say why, and what to do."""
        return f"cannot read '{self.path}': {self.reason}{self.fix and f'; {self.fix}'}"


@dataclass(eq=False, kw_only=True)
class ReportVersionError(ReportError):
    """The file `path` is of the `version` of another release."""

    path: Path
    version: object

    def __str__(self) -> str:
        """Say to write the report again."""
        return (
            f"cannot read '{self.path}': it is of version {self.version}, this reads {VERSION}; "
            "write the report again with the command that made it"
        )


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
    UnreadableReportError
        If the folder holds no report.
    ReportVersionError
        If it holds one that this version cannot read.
    """
    path = folder / ARTEFACTS
    try:
        content = path.read_bytes()
    except OSError as error:
        fix = "name the folder of a report, such as reports/latest"
        reason = error.strerror or str(error)
        raise UnreadableReportError(path=path, reason=reason, fix=fix) from error
    try:
        data = json.loads(content)
        if data["version"] != VERSION:
            raise ReportVersionError(path=path, version=data["version"])
        return _REPORT.validate_python(data).chapters
    except (ValueError, KeyError, TypeError) as error:
        reason = "it is no record of a report"
        raise UnreadableReportError(path=path, reason=reason) from error
