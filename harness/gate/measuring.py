"""Runs the members of every case and puts their spread beside its score."""

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor
from itertools import islice

from harness.case import Case
from harness.gate.ensemble import MOST, member, members, spread
from harness.gate.scores import Score, scored
from harness.runner import run

_AT_ONCE = 48
"""Members whose motions are held in memory together, some megabytes each."""


def count(designed: Sequence[Case], scores: Sequence[Score]) -> int:
    """Return how many members the cases have together."""
    return sum(1 for _ in _members(designed, scores))


def measured(
    designed: Sequence[Case],
    scores: Sequence[Score],
    executor: Executor,
    told: Callable[[str], None] | None = None,
) -> tuple[Score, ...]:
    """Return the scores with the spread of their members.

    Parameters
    ----------
    designed : sequence of Case
    scores : sequence of Score
        Of these cases, in their order.
    executor : Executor
    told : callable, optional
        Is told of each member that is done, by its label.
    """
    found: dict[int, list[Score]] = {number: [] for number in range(len(scores))}
    pending = _members(designed, scores)
    while batch := list(islice(pending, _AT_ONCE)):
        cases = [case for _, case in batch]
        evaluations = run(
            cases,
            executor,
            None if told is None else lambda e: told(e.simulation.case.label()),
        )
        for (number, _), one in zip(batch, scored(cases, evaluations), strict=True):
            found[number].append(one)
    return tuple(spread(one, found[number]) for number, one in enumerate(scores))


def _members(designed: Sequence[Case], scores: Sequence[Score]) -> Iterator[tuple[int, Case]]:
    """Yield each case's members with its place; those of one release together.

    They share the exact motion of that release, which costs more than most of the runs.
    """
    scenes: dict[str, list[int]] = {}
    for place, case in enumerate(designed):
        scenes.setdefault(case.scene.name, []).append(place)
    for places in scenes.values():
        for number in range(MOST):
            for place in places:
                if number < members(int(scores[place].values.get("steps", 0.0))):
                    yield place, member(designed[place], number)
