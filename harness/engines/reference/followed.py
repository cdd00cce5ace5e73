"""The last exact motions that were solved: not twice in a process.

A scene with friction may take seconds, and is asked for as an engine's answer, as the truth that
it is held to, and by the command that prints it, from the same samples. All are the same bits.
"""

from collections import OrderedDict
from typing import Generic, TypeVar

from models.scene import Scene
from reference import Problem, smallest

T = TypeVar("T")

MOST = 16
"""Motions that are kept, each of some megabytes at most."""


class Followed(Generic[T]):
    """The last motions, by scene, problem and the model that solves it."""

    def __init__(self) -> None:
        self._kept: OrderedDict[tuple[Scene, Problem, str], T] = OrderedDict()

    def find(self, scene: Scene, problem: Problem, model: str) -> T | None:
        """Return a motion that was asked for by a model or "auto", if it is kept."""
        return self._kept.get((scene, problem, _meant(model, problem)))

    def keep(self, scene: Scene, problem: Problem, model: str, motion: T) -> None:
        """Keep a motion, and let the oldest go."""
        self._kept[scene, problem, _meant(model, problem)] = motion
        while len(self._kept) > MOST:
            self._kept.popitem(last=False)


def _meant(model: str, problem: Problem) -> str:
    """Return the model that "auto" means; of a rim that rolls it is the formula, by that name."""
    needed = smallest(problem).model
    return needed if model == "auto" and needed != "rolling" else model
