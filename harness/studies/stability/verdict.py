"""What can be said of a run of a hard case: eight verdicts, each with a time and a number."""

from dataclasses import dataclass
from enum import Enum

from harness.simulation import Simulation


class Verdict(Enum):
    """How a run went; the value is what a person reads. From good to bad."""

    ACCURATE = "accurate"
    STABLE = "stable, no exact motion"
    INACCURATE = "stable but inaccurate"
    UNRESOLVED = "unresolved"
    DISSIPATES = "dissipates"
    FLAT = "sleeps or sticks flat"
    GAINS = "gains energy"
    TUNNELS = "tunnels"
    DIVERGES = "diverges"
    REFUSED = "refused"


MEANINGS = {
    Verdict.ACCURATE: "phi, every turn or the orientation is within tolerance of the exact motion",
    Verdict.STABLE: "nothing failed, and there is no exact motion to be accurate to",
    Verdict.INACCURATE: "nothing failed, but the motion is another one",
    Verdict.UNRESOLVED: "the steps are too long to tell how often the contact point went round",
    Verdict.DISSIPATES: "energy is lost where the exact motion keeps it",
    Verdict.FLAT: "the can stays flat where the exact motion rises again",
    Verdict.GAINS: "energy comes from nowhere",
    Verdict.TUNNELS: "the can sinks into the plane",
    Verdict.DIVERGES: "the numbers grow without bound or are no numbers",
    Verdict.REFUSED: "the engine could not compile the can of the scene, or its adapter broke",
}
"""What each verdict says, in a few words."""

SOUND = frozenset({Verdict.ACCURATE, Verdict.STABLE, Verdict.INACCURATE})
"""Verdicts of a run in which nothing failed."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Sign:
    """Something that was seen in a run.

    Parameters
    ----------
    time : float
        When it was seen first, s.
    number : float
        The number behind it.
    words : str
        What the number is; its unit, if it has one, comes last, after a comma.
    """

    time: float
    number: float
    words: str


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Judged:
    """A run, without its motion, and what is said of it.

    Parameters
    ----------
    simulation : Simulation
        Its trajectory is left out, so that thousands can be kept.
    verdict : Verdict
    sign : Sign
        The number behind the verdict, and when.
    """

    simulation: Simulation
    verdict: Verdict
    sign: Sign

    @property
    def sound(self) -> bool:
        """Whether nothing failed."""
        return self.verdict in SOUND

    @property
    def accurate(self) -> bool:
        """Whether it follows the exact motion."""
        return self.verdict is Verdict.ACCURATE

    @property
    def good(self) -> bool:
        """Whether it is as good as can be told: accurate, or sound where no motion is exact."""
        return self.verdict in {Verdict.ACCURATE, Verdict.STABLE}
