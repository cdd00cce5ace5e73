"""Verdicts: a status that programs read, and a text that people read."""

from dataclasses import dataclass
from enum import Enum


class Status(Enum):
    """What a verdict comes to; colours, JUnit and gates read it, never the text.

    The value is the word with which a text of this status begins.
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
        """Whether a test of it passes."""
        return self in {Status.AGREES, Status.SAME, Status.BETTER}

    @property
    def failed(self) -> bool:
        """Whether a test of it fails; what neither passes nor fails is skipped."""
        return self in {Status.DEVIATES, Status.FAILED, Status.WORSE, Status.MISSING}


@dataclass(frozen=True, slots=True, order=True)
class Verdict:
    """A status, and the sentence that says it with its numbers.

    Parameters
    ----------
    status : Status
    text : str
    """

    status: Status
    text: str

    def __str__(self) -> str:
        """Return the text, which is what tables and pages show."""
        return self.text
