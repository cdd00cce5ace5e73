"""Motions that were followed from event to event: not twice in a process.

A scene with friction may take seconds, and is asked for as an engine's answer, as the truth that
it is held to, and by the command that prints it. All are the same bits.
"""

from collections import OrderedDict

from reference import Problem, Solution, smallest

MODELS = frozenset({"coulomb", "general"})
"""Models that are integrated from event to event; the choice of tolerance does not reach them."""

MOST = 16
"""Motions that are kept, each of some megabytes at most."""


class Followed:
    """The last motions that were followed."""

    def __init__(self) -> None:
        self._kept: OrderedDict[tuple[Problem, str], Solution] = OrderedDict()

    def find(self, problem: Problem, model: str) -> Solution | None:
        """Return the motion of a problem by a model, if it is kept; "auto" is the smallest."""
        return self._kept.get((problem, smallest(problem).model if model == "auto" else model))

    def keep(self, solution: Solution) -> None:
        """Keep a motion, if it is one that was followed, and let the oldest go."""
        if solution.model in MODELS:
            self._kept[solution.problem, solution.model] = solution
            while len(self._kept) > MOST:
                self._kept.popitem(last=False)
