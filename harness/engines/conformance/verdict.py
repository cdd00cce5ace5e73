"""What a check is, and what it says: passed, failed or not applicable, and by which number."""

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum

from harness.engines.conformance.bench import Bench


class Result(Enum):
    """How a check ended."""

    PASSED = "passed"
    FAILED = "failed"
    NOT_APPLICABLE = "not applicable"


@dataclass(frozen=True, slots=True, kw_only=True)
class Verdict:
    """What one check found.

    Parameters
    ----------
    name, sentence : str
        Of the check.
    result : Result
    number, allowed : float or None
        What was measured, and the most that passes; None where the answer is yes or no.
    unit : str
    detail : str
        What was looked at, or what was wrong.
    """

    name: str
    sentence: str
    result: Result
    number: float | None = None
    allowed: float | None = None
    unit: str = ""
    detail: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Found:
    """What a check's function hands back, before it is put under the check's name."""

    result: Result
    number: float | None = None
    allowed: float | None = None
    unit: str = ""
    detail: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Check:
    """One clause of the contract.

    Parameters
    ----------
    name : str
        A word or two.
    sentence : str
        What an adapter promises.
    look : callable
        Finds out; whatever it raises is a failure of the adapter.
    needs_run : bool
        Whether it has nothing to look at where no run hands over a trajectory.
    """

    name: str
    sentence: str
    look: Callable[[Bench], Found]
    needs_run: bool = True


def within(number: float, allowed: float, unit: str, detail: str) -> Found:
    """Return passed if a number is at most what is allowed; a number that is none fails."""
    result = Result.PASSED if number <= allowed else Result.FAILED
    return Found(result=result, number=number, allowed=allowed, unit=unit, detail=detail)


def holds(wrong: str, detail: str) -> Found:
    """Return failed with what is wrong, or passed with what was looked at if nothing is."""
    result = Result.FAILED if wrong else Result.PASSED
    return Found(result=result, detail=wrong or detail)


def not_applicable(why: str) -> Found:
    """Return that a check does not apply."""
    return Found(result=Result.NOT_APPLICABLE, detail=why)
