"""What an integrator hands over: the path, and what was seen on it."""

from dataclasses import dataclass
from typing import Protocol

from reference.states import Floats, States
from reference.track import Track


class Path(Protocol):
    """A motion known at every instant up to its end."""

    def at(self, times: Floats) -> States:
        """States at the given times."""
        ...

    def nodes(self) -> tuple[Floats, States]:
        """Return times and states the solver itself has, from the start to the end."""
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class Run:
    """A finished integration.

    Attributes
    ----------
    path : Path
    track : Track
    steps, evaluations : int
        Solver work.
    """

    path: Path
    track: Track
    steps: int
    evaluations: int
