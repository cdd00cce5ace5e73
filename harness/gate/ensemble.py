"""How far a result is free to move when nothing of an engine has changed.

On one machine a run repeats to the last bit. On another, or built by another compiler, each step
may differ in its last bit, and a contact that opens and closes amplifies that. What that does is
measured: each case is run again with releases, and headings, that differ by 1e-13 to 1e-9. A last
bit is 1e-16, and a million steps that each differ by one come to between 1e-13 and 1e-10; so the
sizes bracket what a machine can do, and the largest departure stands for all of them.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType

from harness.case import Case
from harness.gate.quantities import QUANTITIES, Kind
from harness.gate.scores import Number, Score
from harness.studies.errors.ensemble import perturbed

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


def spread(middle: Score, found: Sequence[Score]) -> Score:
    """Return a score with the spread of its members about it."""
    endings: dict[str, int] = {}
    for one in (middle, *found):
        endings[one.outcome] = endings.get(one.outcome, 0) + 1
    return replace(
        middle,
        members=len(found),
        spread=MappingProxyType(_spreads(middle, found)),
        endings=MappingProxyType(endings),
    )


def _spreads(middle: Score, found: Sequence[Score]) -> Mapping[str, Number]:
    """Return the largest departure of each quantity that is judged."""
    alike = [one for one in found if one.outcome == middle.outcome]
    spreads: dict[str, Number] = {}
    for quantity in (one for one in QUANTITIES if one.kind is not Kind.TIME):
        values = [one.values.get(quantity.column) for one in alike]
        own = middle.values.get(quantity.column)
        if own is None and all(value is None for value in values):
            continue
        known = [value for value in values if value is not None]
        if own is None or len(known) < len(values):
            spreads[quantity.column] = None
        else:
            spreads[quantity.column] = max((abs(value - own) for value in known), default=0.0)
    return spreads
