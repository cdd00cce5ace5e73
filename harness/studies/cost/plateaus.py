"""The order of each ladder, where it levels off, and what is to blame for that.

A ladder of one change to `matched` owes its plateau to that change if the matched ladder lies below
it at the same timestep. That of the engine as it ships is taken apart by its gaps, all at the
finest timestep: the one to blame is the gap that by itself, all others closed, leaves the most.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from harness.core.simulation import Outcome
from harness.engines.registry import engine
from harness.metrics.convergence import AsymptoticOrder, Plateau, asymptotic_order, plateau
from harness.studies.cost.design import gap_cases
from harness.studies.cost.points import Family, Point, Record
from harness.studies.cost.prices import Cost
from harness.studies.shared.ablation import AblationPath

_MOST = 0.5
"""Share of a plateau from which one gap alone is said to make it."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Fall:
    """How the error of a ladder falls, and where it stops.

    Parameters
    ----------
    family : Family
    quantity : str
    order : AsymptoticOrder or None
    plateau : Plateau or None
    cause : str
        A sentence; empty without a plateau.
    """

    family: Family
    quantity: str
    order: AsymptoticOrder | None
    plateau: Plateau | None
    cause: str


def falls(cost: Cost, quantities: Sequence[str]) -> tuple[Fall, ...]:
    """Return how each ladder of timesteps falls, in each quantity."""
    return tuple(
        _fall(cost, family, ladder, quantity)
        for family, ladder in cost.ladders
        if family.steps
        for quantity in quantities
    )


def _fall(cost: Cost, family: Family, ladder: Sequence[Point], quantity: str) -> Fall:
    steps = [point.timestep or 0.0 for point in ladder]
    errors = [
        point.errors.get(quantity) if point.outcome is Outcome.FINISHED else None
        for point in ladder
    ]
    level = plateau(steps, errors)
    return Fall(
        family=family,
        quantity=quantity,
        order=asymptotic_order(steps, errors, 0.0 if level is None else level.level),
        plateau=level,
        cause="" if level is None else _cause(cost, family, quantity, level),
    )


def _cause(cost: Cost, family: Family, quantity: str, found: Plateau) -> str:
    """Return what a plateau comes from, in a sentence."""
    path = next((path for path in cost.plan.paths if path.engine == family.engine), None)
    if family.variant.profile == "default" and not family.variant.settings and path is not None:
        return _from_gaps(path, cost, quantity, abs(found.level))
    matched = next(
        (
            ladder
            for other, ladder in cost.ladders
            if other.engine == family.engine and other.name == "matched"
        ),
        (),
    )
    floor = min((point.error(quantity) for point in matched), default=0.0)
    if family.variant.settings and floor < _MOST * abs(found.level):
        imposed = family.variant.imposes or "no effect of its own, but less than the solver needs"
        return f"{family.name}: {imposed}."
    imposed = "; ".join(
        f"{name} ({sentence})"
        for name, sentence in engine(family.engine).capabilities.imposes.items()
    )
    return f"Shared with matched: {imposed or 'nothing that the engine declares'}."


def _from_gaps(path: AblationPath, cost: Cost, quantity: str, level: float) -> str:
    """Return which gap makes the plateau of an engine as it ships."""
    open_: dict[str, float] = {}
    for (kind, gap), case in gap_cases(path).items():
        size = _size(cost.gaps.get(case), quantity)
        if kind == "left open" and size is not None:
            open_[gap] = size
    if not open_:
        return "Not known: no run with the other gaps closed has this number."
    ranked = sorted(open_, key=open_.__getitem__, reverse=True)
    first = ranked[0]
    sentence = next(gap.sentence for gap in path.gaps if gap.name == first)
    share = open_[first] / level
    if share >= _MOST:
        return f"{first}: alone it leaves {open_[first]:.2g}. {sentence}"
    told = ", ".join(f"{name} ({open_[name]:.2g} alone)" for name in ranked[:2])
    return f"Several together; the largest are {told}."


def _size(record: Record | None, quantity: str) -> float | None:
    if record is None or record["outcome"] != Outcome.FINISHED.name:
        return None
    value = record["errors"].get(quantity)
    return None if value is None else abs(value)
