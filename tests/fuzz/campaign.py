"""Many scene files gone wrong, each given to the command line; what came of them, counted."""

from collections import Counter
from collections.abc import Callable
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
    slowest : float
        s, of one command.
    faults : list of (level, command, fault, file)
    """

    answered: Counter[str] = field(default_factory=Counter)
    refused: Counter[str] = field(default_factory=Counter)
    commands: int = 0
    slowest: float = 0.0
    faults: list[tuple[str, str, str, bytes]] = field(default_factory=list)


def campaign(
    count: int, seed: int, folder: Path, show: Callable[[Tally], None] = lambda _: None
) -> Tally:
    """Try so many scene files, a quarter of each level, and return what came of them.

    Parameters
    ----------
    count : int
    seed : int
    folder : Path
        For the one file that is there at a time; whatever else appears in it is a fault.
    show : callable, optional
        Is told now and then.
    """
    tally = Tally()
    share = -(-count // (len(LEVELS) + 1))

    def see(level: str, content: bytes) -> None:
        number = tally.answered.total() + tally.refused.total()
        _try(tally, level, content, folder / "scene.toml", number)
        if number % 100 == 0 or tally.faults:
            show(tally)

    for level in LEVELS:
        for content in mutations(level, share, seed):
            see(level, content)
    each_made(share, seed, lambda content: see(MADE, content))
    show(tally)
    return tally


def _try(tally: Tally, level: str, content: bytes, path: Path, number: int) -> None:
    """Give one file to the command line."""
    path.write_bytes(content)
    for place, words in enumerate(commands(path, number)):
        verdict = judged(words)
        tally.commands += 1
        tally.slowest = max(tally.slowest, verdict.seconds)
        if place == 0:
            (tally.answered if verdict.code == GOOD else tally.refused)[level] += 1
        if verdict.fault:
            tally.faults.append((level, words[0], verdict.fault, content))
    strange = sorted(p.name for p in path.parent.iterdir() if p != path)
    if strange:
        tally.faults.append((level, "all", f"files appeared: {strange}", content))
