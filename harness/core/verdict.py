"""Verdicts: a status for programs, and a text for people."""

from dataclasses import dataclass
from enum import Enum


class Status(Enum):
    """Status of a verdict, which colours, JUnit and gates read instead of the text.

    The value is the first word of a text of this status.
    """

    AGREES = "agrees"
    DEVIATES = "deviates"
    FAILED = "failed"
    UNSUPPORTED = "unsupported"
    UNDECIDABLE = "not decidable"
    NOT_MEASURED = "not measured"
    SAME = "same"
    BETTER = "better"
    WORSE = "worse"
    MISSING = "missing"
    NEW = "new"
    NOT_JUDGED = "not judged"
    REACHED = "reached"
    NOT_REACHED = "not reached"

    @property
    def passed(self) -> bool:
        """Return whether a test of a verdict with this status passes."""
        return self in {Status.AGREES, Status.SAME, Status.BETTER}

    @property
    def failed(self) -> bool:
        """Return whether a test fails; one that neither passes nor fails is skipped."""
        return self in {Status.DEVIATES, Status.FAILED, Status.WORSE, Status.MISSING}


@dataclass(frozen=True, slots=True, order=True)
class Verdict:
    """A status, and the sentence that explains it with its numbers."""

    status: Status
    text: str

    def __str__(self) -> str:
        """Return the text, which is what tables and pages show."""
        return self.text
