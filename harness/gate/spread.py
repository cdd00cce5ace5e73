"""How far a result is free to move when nothing of an engine has changed.

On one machine a run repeats to the last bit. On another, or built by another compiler, each step
may differ in its last bit, and a contact that opens and closes amplifies that. What that does is
measured: each case is run again with releases, and headings, that differ by 1e-13 to 1e-9. A last
bit is 1e-16, and a million steps that each differ by one come to between 1e-13 and 1e-10; so the
sizes bracket what a machine can do, and the largest departure stands for all of them.

Runs the members of every case and puts their spread beside its score.
"""

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor
from dataclasses import replace
from itertools import islice

from harness.core.case import Case
from harness.evaluation.run_cases import run_cases
from harness.execution.cache import CacheFolder
from harness.results.scores import QUANTITIES, QuantityKind, Score, scored
from harness.studies.shared.perturbation import perturbed

SIZES = (1e-9, 1e-13, 1e-11, 1e-12, 1e-10)
"""Relative to phi, psi' and theta', and rad of heading; taken in turn."""

FEWEST, MOST = 4, 12
"""Members of a case. What amplifies most are coarse timesteps, whose runs cost least."""

STEPS = 200_000
"""Steps that the members of a case may take together, if that is not too few of them."""


def members(steps: int) -> int:
    """Return how many members a case has, by the steps that it takes; not by any clock."""
    return max(FEWEST, min(MOST, STEPS // max(steps, 1)))


def member(case: Case, number: int) -> Case:
    """Return a case with another release, which no measurement could tell from its own."""
    size = SIZES[number % len(SIZES)]
    scene = perturbed(case.scene, size, number)
    # a heading changes the bits of every number, also of a release at rest or in balance
    turned = scene.release.psi + size
    return replace(case, scene=replace(scene, release=replace(scene.release, psi=turned)))


def spread(middle: Score, runs: Sequence[Score]) -> Score:
    """Return a score with the spread of its members about it: the largest departures."""
    alike = [run for run in runs if run.outcome == middle.outcome]
    spreads: dict[str, float | None] = {}
    for quantity in (q for q in QUANTITIES if q.kind is not QuantityKind.TIME):
        own = middle.values.get(quantity.column)
        values = [run.values.get(quantity.column) for run in alike]
        known = [value for value in values if value is not None]
        if own is not None and len(known) == len(values):
            spreads[quantity.column] = max((abs(value - own) for value in known), default=0.0)
        elif own is not None or known:
            spreads[quantity.column] = None
    endings = dict(Counter(run.outcome for run in (middle, *runs)))
    return middle.model_copy(update={"members": len(runs), "spread": spreads, "endings": endings})


_AT_ONCE = 48
"""Members whose motions are held in memory together, a few megabytes each."""


def measured(
    designed: Sequence[Case],
    scores: Sequence[Score],
    executor: Executor,
    listener: Callable[[str], None] | None = None,
    *,
    store: CacheFolder | None = None,
) -> tuple[Score, ...]:
    """Return the scores with the spread of their members.

    Parameters
    ----------
    designed : sequence of Case
    scores : sequence of Score
        Of these cases, in their order.
    executor : Executor
    listener : callable, optional
        Called with the label of each member that is done.
    store : CacheFolder, optional
        Where members are kept and found; nowhere if left out.
    """
    by_case: list[list[Score]] = [[] for _ in scores]
    pending = planned_members(designed, scores)
    while batch := list(islice(pending, _AT_ONCE)):
        cases = [case for _, case in batch]
        on_done = None if listener is None else lambda e: listener(e.simulation.case.label())
        evaluations = run_cases(cases, executor, on_done, store=store)
        for (number, _), score in zip(batch, scored(cases, evaluations), strict=True):
            by_case[number].append(score)
    return tuple(map(spread, scores, by_case))


def planned_members(
    designed: Sequence[Case], scores: Sequence[Score]
) -> Iterator[tuple[int, Case]]:
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
