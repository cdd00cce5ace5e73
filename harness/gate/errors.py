"""Errors of accepted results and reports that cannot be read, or are of another run."""

from dataclasses import dataclass
from enum import Enum
from pathlib import Path

from harness.core.errors import HarnessError

FILE = "accepted.json"
"""Of the accepted results of a folder."""


class BaselineError(HarnessError, ValueError):
    """Accepted results, or a report, cannot be read or do not fit what they are held against."""


class Fault(Enum):
    """Why there are no results to read, as a message says it of a place and for a reason."""

    MISSING = (
        f"'{{place}}' holds no accepted results ('{FILE}'); write some with: rockingcan validate "
        "--accept --baseline {place}"
    )
    UNREADABLE = "accepted results '{place}' cannot be read: {reason}"
    DAMAGED = "accepted results '{place}' are damaged ({reason})"
    VERSION = (
        "'{place}' is no file of accepted results of version {reason}; write it anew with --accept"
    )
    NO_FOLDER = (
        "'{place}' is no folder; name one that rockingcan validate wrote, with --out or with "
        "--accept"
    )
    NEITHER = (
        "'{place}' is neither a report nor accepted results; name one that rockingcan validate "
        "wrote, with --out or with --accept"
    )
    DAMAGED_REPORT = "the report in '{place}' cannot be read ({reason})"
    FOREIGN_REPORT = "'{place}' is no report of rockingcan"
    OTHER_REPORT = (
        "'{place}' is a report, but not of rockingcan validate, or of a version that could not be "
        "compared yet; write it again"
    )


@dataclass(eq=False, kw_only=True)
class ResultsError(BaselineError):
    """A folder holds no results that can be read.

    Parameters
    ----------
    place : Path
        The folder, or its file of accepted results.
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
class OtherEnginesError(BaselineError):
    """The results of a place are of the engines `accepted`, and none is of the run's `engines`."""

    place: str
    engines: tuple[str, ...]
    accepted: tuple[str, ...]

    def __str__(self) -> str:
        """Say to accept some first."""
        return (
            f"'{self.place}' holds no accepted results of {', '.join(self.engines)}, only of "
            f"{', '.join(self.accepted) or 'none'}; accept some first, with --accept"
        )


@dataclass(eq=False, kw_only=True)
class OtherSuiteError(BaselineError):
    """The results of a place are of a suite that has too few cases of the run's.

    Parameters
    ----------
    place : str
    suite, accepted : str
        Of the run and of the results.
    cases, common : int
        Number of cases of the run, and of those that have accepted results.
    """

    place: str
    suite: str
    accepted: str
    cases: int
    common: int

    def __str__(self) -> str:
        """Say which suite to run or to accept."""
        return (
            f"'{self.place}' holds the {self.accepted} suite, which has {self.common} of the "
            f"{self.cases} cases of the {self.suite} suite; run --suite {self.accepted}, or accept "
            f"the {self.suite} suite with --accept"
        )


@dataclass(eq=False, kw_only=True)
class ChangedScenesError(BaselineError):
    """Scenes have changed since the results of a place were accepted."""

    place: str
    scenes: tuple[str, ...]

    def __str__(self) -> str:
        """Say to accept anew."""
        return (
            f"'{self.place}' was accepted for other scenes: since then {', '.join(self.scenes)} "
            "changed, and errors of two motions cannot be compared; accept anew with --accept"
        )


@dataclass(eq=False, kw_only=True)
class NoCommonCaseError(BaselineError):
    """The results of the folders `a` and `b` have no case in common."""

    a: Path
    b: Path

    def __str__(self) -> str:
        """Say that there is nothing to compare."""
        return f"'{self.a}' and '{self.b}' have no case in common: there is nothing to compare"
