"""Errors of accepted results and reports that are of another run."""

from dataclasses import dataclass
from pathlib import Path

from harness.results.errors import BaselineError


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
