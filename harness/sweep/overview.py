"""Reads a sweep partition by partition into what a report shows of it."""

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from harness.core.report_model import Artefact, Column, Figure, Prose, table_of
from harness.core.trajectory import Floats
from harness.sweep.figure import Cells, Points, curves, maps
from harness.sweep.partition import Partition
from harness.sweep.plan import SweepPlan
from harness.sweep.quantities import QUANTITIES

_IN_A_MAP = 2


@dataclass(frozen=True, slots=True, kw_only=True)
class Extent:
    """A quantity over a sweep: how many scenes have it, and between what it lies."""

    count: int
    low: float
    mean: float
    high: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Overview:
    """A sweep in a few numbers, and its figure.

    Parameters
    ----------
    plan : Plan
    outcomes : mapping of str to int
        Scenes by how they ended, most frequent first.
    extents : mapping of str to Extent
        Of each quantity that a scene has.
    figure : Figure
    """

    plan: SweepPlan
    outcomes: Mapping[str, int]
    extents: Mapping[str, Extent]
    figure: Figure


def overview(plan: SweepPlan, parts: Iterable[Partition], against: str | None = None) -> Overview:
    """Return the overview of a sweep, in memory that does not grow with it.

    Parameters
    ----------
    plan : Plan
    parts : iterable of Part
        All of them, in order.
    against : str, optional
        A quantity to be the horizontal axis of curves, in place of a parameter.
    """
    mapped = against is None and len(plan.axes) >= _IN_A_MAP
    cells = Cells(plan.axes[0], plan.axes[1], plan.rows, plan.quantities) if mapped else None
    points = None if mapped else Points(plan.rows, plan.quantities)
    outcomes: Counter[str] = Counter()
    sums = {name: _Sum() for name in plan.quantities}
    for part in parts:
        counts = np.bincount(part.code, minlength=len(part.sentences)).tolist()
        outcomes.update(dict(zip(part.sentences, counts, strict=True)))
        values = dict(part.quantities)
        for name, total in sums.items():
            total.add(values[name])
        if cells is not None:
            there = _in_the_slice(plan, part)
            across, up = (part.parameters[axis.column][there] for axis in plan.axes[:2])
            cells.add((across, up), {name: column[there] for name, column in values.items()})
        elif points is not None:
            column = values[against] if against else part.parameters[plan.axes[0].column]
            points.add(part.rows, column, values)
    figure = maps(plan, cells) if cells is not None else None
    if points is not None:
        figure = curves(plan, points, against)
    assert figure is not None  # noqa: S101 - one of the two
    return Overview(
        plan=plan,
        outcomes=dict(outcomes.most_common()),
        extents={name: total.extent() for name, total in sums.items() if total.count},
        figure=figure,
    )


def sweep_report(found: Overview) -> tuple[Artefact, ...]:
    """Return what a report of a sweep is made of."""
    return (
        Prose(name="summary", title="The sweep", text=_words(found)),
        found.figure,
        table_of("quantities", "What the scenes have", _QUANTITIES, found.extents.items()),
        table_of("outcomes", "How the scenes ended", _OUTCOMES, found.outcomes.items()),
    )


_QUANTITIES = (
    Column("quantity", "With its unit last.", lambda item: item[0]),
    Column(
        "scenes",
        "How many have it; why the others have not, their outcome says.",
        lambda item: item[1].count,
    ),
    Column("least", "In the quantity's unit.", lambda item: item[1].low),
    Column(
        "mean",
        "In the quantity's unit, over the scenes that have it.",
        lambda item: item[1].mean,
    ),
    Column("largest", "In the quantity's unit.", lambda item: item[1].high),
)

_OUTCOMES = (
    Column("outcome", "In the words of whatever ran them.", lambda item: item[0]),
    Column("scenes", "How many.", lambda item: item[1]),
)


class _Sum:
    """Least, largest and mean of numbers that come in parts."""

    def __init__(self) -> None:
        self.count, self._total = 0, 0.0
        self._low, self._high = np.inf, -np.inf

    def add(self, values: Floats) -> None:
        there = values[~np.isnan(values)]
        if there.size:
            self.count += there.size
            self._total += float(there.sum())
            self._low = min(self._low, float(there.min()))
            self._high = max(self._high, float(there.max()))

    def extent(self) -> Extent:
        mean = self._total / self.count
        return Extent(count=self.count, low=self._low, mean=mean, high=self._high)


def _in_the_slice(plan: SweepPlan, part: Partition) -> Floats:
    """Return which rows a map shows: of a grid those in the middle of all further axes."""
    there = np.ones(len(part.rows), dtype=bool)
    if plan.sample == "grid":
        places = plan.places(part.rows)
        for axis, place in zip(plan.axes[_IN_A_MAP:], places[_IN_A_MAP:], strict=True):
            there &= place == (axis.count or 1) // 2
    return there


def _words(found: Overview) -> str:
    """Return the sweep in a few sentences."""
    plan = found.plan
    over = " and ".join(axis.text() for axis in plan.axes)
    how = "the exact bounce" if plan.exact else f"{plan.engine} {plan.engine_version}"
    sentences = [f"{plan.rows} scenes like {plan.scene.name}, over {over}, by {how}."]
    sentences += [f"{count}: {outcome}." for outcome, count in list(found.outcomes.items())[:5]]
    for name, extent in list(found.extents.items())[:1]:
        label = QUANTITIES[name].axis
        sentences.append(f"The {label} lies between {extent.low:.6g} and {extent.high:.6g}.")
    return " ".join(sentences)
