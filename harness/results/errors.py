"""Errors of results that cannot be read, or that are not of one suite."""

from dataclasses import dataclass
from enum import Enum
from pathlib import Path

from harness.core.errors import HarnessError

FILE = "accepted.json"
"""Of the accepted results of a folder."""


class BaselineError(HarnessError, ValueError):
    """Results, or a report, cannot be read or do not fit what they are held against."""


class Fault(Enum):
    """Why there are no results to read, as a message says it of a place and for a reason."""

    MISSING = (
        f"'{{place}}' holds no accepted results ('{FILE}'); write some with: rockingcan validate "
        "--accept --baseline {place}"
    )
    UNREADABLE = "the result '{place}' cannot be read: {reason}"
    DAMAGED = "the result '{place}' is damaged ({reason})"
    VERSION = (
        "'{place}' is no result of version {reason}; write it anew with: rockingcan validate "
        "--accept, or: rockingcan submit"
    )
    OBJECTION = (
        "the result '{place}' does not hold ({reason}); see all of it with: rockingcan results "
        "verify {place}"
    )
    NO_FOLDER = (
        "'{place}' is not there; name a file that rockingcan submit wrote, or a folder that "
        "rockingcan validate wrote, with --out or with --accept"
    )
    NEITHER = (
        "'{place}' is neither a report nor accepted results; name a file that rockingcan submit "
        "wrote, or a folder that rockingcan validate wrote, with --out or with --accept"
    )
    NO_RESULTS = "'{place}' holds no results; name a folder of files that rockingcan submit wrote"
    DAMAGED_REPORT = "the report in '{place}' cannot be read ({reason})"
    FOREIGN_REPORT = "'{place}' is no report of rockingcan"
    OTHER_REPORT = (
        "'{place}' is a report, but not of rockingcan validate, or of a version that could not be "
        "compared yet; write it again"
    )


@dataclass(eq=False, kw_only=True)
class ResultsError(BaselineError):
    """A file or folder holds no results that can be read.

    Parameters
    ----------
    place : Path
        The folder, or the file.
    fault : Fault
    reason : str
        What was found, where there is more to say than the fault.
    """

    place: Path
    fault: Fault
    reason: str = ""

    def __str__(self) -> str:
        """Return the sentence of the fault."""
        return self.fault.value.format(place=self.place, reason=self.reason)


@dataclass(eq=False, kw_only=True)
class MixedSuitesError(BaselineError):
    """Results of several `suites` cannot stand in one table or be compared."""

    suites: tuple[str, ...]

    def __str__(self) -> str:
        """Say that the suites differ."""
        return (
            f"the results are of different suites ({', '.join(self.suites)}), whose cases are not "
            "the same; name results of one suite"
        )
