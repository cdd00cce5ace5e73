"""Many scene files gone wrong, each given to the command line; what came of them, counted."""

from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

from tests.fuzz.made import each_made
from tests.fuzz.mutations import LEVELS, mutations
from tests.fuzz.verdict import GOOD, commands, judged

MADE = "made"


@dataclass
class Tally:
    """What came of scene files.

    Parameters
    ----------
    answered, refused : Counter
        Files by level: given an answer, and given a message with exit code 2.
    commands : int
    seconds, slowest : float
        s of the processor, of all commands and of one.
    faults : list of (level, command, fault, file)
    """

    answered: Counter[str] = field(default_factory=Counter)
    refused: Counter[str] = field(default_factory=Counter)
    commands: int = 0
    seconds: float = 0.0
    slowest: float = 0.0
    faults: list[tuple[str, str, str, bytes]] = field(default_factory=list)

    @property
    def files(self) -> int:
        """Scene files that were tried."""
        return self.answered.total() + self.refused.total()

    def add(self, other: "Tally") -> None:
        """Count what came of other files, too."""
        self.answered += other.answered
        self.refused += other.refused
        self.commands += other.commands
        self.seconds += other.seconds
        self.slowest = max(self.slowest, other.slowest)
        self.faults += other.faults


def campaign(count: int, seed: int, folder: Path) -> Tally:
    """Try so many scene files and return what came of them.

    A tenth is made, of which most have to be solved; the mutations, of which most are refused,
    share the rest.

    Parameters
    ----------
    count : int
    seed : int
    folder : Path
        For the one file that is there at a time; whatever else appears in it is a fault.
    """
    tally = Tally()
    share = -(-count * 3 // 10)

    def see(level: str, content: bytes) -> None:
        _try(tally, level, content, folder / "scene.toml", tally.files)

    for level in LEVELS:
        for content in mutations(level, share, seed):
            see(level, content)
    each_made(count - share * len(LEVELS), seed, lambda content: see(MADE, content))
    return tally


def _try(tally: Tally, level: str, content: bytes, path: Path, number: int) -> None:
    """Give one file to the command line."""
    path.write_bytes(content)
    for place, words in enumerate(commands(path, number)):
        verdict = judged(words)
        tally.commands += 1
        tally.seconds += verdict.seconds
        tally.slowest = max(tally.slowest, verdict.seconds)
        if place == 0:
            (tally.answered if verdict.code == GOOD else tally.refused)[level] += 1
        if verdict.fault:
            tally.faults.append((level, words[0], verdict.fault, content))
    strange = sorted(p.name for p in path.parent.iterdir() if p != path)
    if strange:
        tally.faults.append((level, "all", f"files appeared: {strange}", content))
