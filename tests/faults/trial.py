"""One trial: what was done, what must come of it, what did."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class Trial:
    """What was tried, and how it went.

    Parameters
    ----------
    name : str
    done : str
        What was done to the program.
    demanded : str
        What must come of it.
    found : tuple of str
        What came of it, with the counts behind it.
    passed : bool
    seconds : float
        That the trial took.
    """

    name: str
    done: str
    demanded: str
    found: tuple[str, ...]
    passed: bool
    seconds: float
