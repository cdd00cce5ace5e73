"""Report of a sweep, read partition by partition in memory that does not grow with the sweep.

A curve over one parameter, a map over two, the extent of each quantity, and how the scenes ended.
A cell of a map shows the scene nearest to its middle and no mean: where the sign of the turn
changes, the mean of two turns is a turn that no can makes.
"""

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np
import pandas as pd

from harness.core.report_model import (
    Artefact,
    Column,
    Figure,
    Heatmap,
    Panel,
    Prose,
    Series,
    table_of,
)
from harness.core.trajectory import Floats
from harness.sweep.partition import OUTCOME
from harness.sweep.plan import SweepPlan
from harness.sweep.values import QUANTITIES

MOST_CELLS = 400
"""Cells across, and up: a figure has about as many pixels to distinguish."""

_PER_CELL = 2.0
"""Scenes of a sample for each cell, so that few stay blank."""

POINTS_MOST = 20_000
"""Points of a curve: more than a screen resolves."""

MOST_PANELS = 6
"""Quantities that are drawn; the table has all."""

_DECADES = 100.0
"""Ratio of largest to least from which an axis is logarithmic."""

_IN_A_MAP = 2


@dataclass(slots=True, kw_only=True)
class Extent:
    """A quantity over a sweep: how many scenes have it, and between what it lies."""

    name: str
    count: int = 0
    total: float = 0.0
    low: float = np.inf
    high: float = -np.inf

    @property
    def mean(self) -> float:
        """Over the scenes that have it."""
        return self.total / self.count

    def add(self, values: Floats) -> None:
        """Take further scenes into account."""
        known = values[~np.isnan(values)]
        if known.size:
            self.count += known.size
            self.total += float(known.sum())
            self.low = min(self.low, float(known.min()))
            self.high = max(self.high, float(known.max()))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Overview:
    """A sweep in a few numbers, and its figure.

    Parameters
    ----------
    plan : SweepPlan
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


def overview(
    plan: SweepPlan, parts: Iterable[pd.DataFrame], against: str | None = None
) -> Overview:
    """Return the overview of a sweep, in memory that does not grow with it.

    Parameters
    ----------
    plan : SweepPlan
    parts : iterable of DataFrame
        All of them, in order.
    against : str, optional
        A quantity to be the horizontal axis of curves, in place of a parameter.
    """
    mapped = against is None and len(plan.axes) >= _IN_A_MAP
    drawing = Map(plan) if mapped else Curves(plan, against)
    outcomes: Counter[str] = Counter()
    extents = {name: Extent(name=name) for name in plan.quantities}
    for part in parts:
        counts = part[OUTCOME].value_counts()
        outcomes.update({str(sentence): int(counts[sentence]) for sentence in sorted(counts.index)})
        for name, extent in extents.items():
            extent.add(part[name].to_numpy())
        drawing.add(part)
    return Overview(
        plan=plan,
        outcomes=dict(outcomes.most_common()),
        extents={name: extent for name, extent in extents.items() if extent.count},
        figure=drawing.figure(),
    )


EXTENTS = (
    Column("quantity", "With its unit last.", "name"),
    Column("scenes", "How many have it; why the others have not, their outcome says.", "count"),
    Column("least", "In the quantity's unit.", "low"),
    Column("mean", "In the quantity's unit, over the scenes that have it."),
    Column("largest", "In the quantity's unit.", "high"),
)

_OUTCOMES = (
    Column("outcome", "In the words of whatever ran them.", lambda pair: pair[0]),
    Column("scenes", "How many.", lambda pair: pair[1]),
)


def sweep_report(sweep: Overview) -> tuple[Artefact, ...]:
    """Return what a report of a sweep is made of."""
    return (
        Prose(name="summary", title="The sweep", text=_summary(sweep)),
        sweep.figure,
        table_of("quantities", "What the scenes have", EXTENTS, sweep.extents.values()),
        table_of("outcomes", "How the scenes ended", _OUTCOMES, sweep.outcomes.items()),
    )


def _summary(sweep: Overview) -> str:
    """Return the sweep in a few sentences."""
    plan = sweep.plan
    over = " and ".join(axis.text() for axis in plan.axes)
    how = "the exact bounce" if plan.exact else f"{plan.base.engine} {plan.engine_version}"
    sentences = [f"{plan.rows} scenes like {plan.base.scene.name}, over {over}, by {how}."]
    sentences += [f"{count}: {outcome}." for outcome, count in list(sweep.outcomes.items())[:5]]
    for name, extent in list(sweep.extents.items())[:1]:
        label = QUANTITIES[name].axis
        sentences.append(f"The {label} lies between {extent.low:.6g} and {extent.high:.6g}.")
    return " ".join(sentences)


class Map:
    """A map of each quantity over the first two parameters, filled part by part."""

    def __init__(self, plan: SweepPlan) -> None:
        self._plan = plan
        self._axes = plan.axes[:_IN_A_MAP]
        sampled = int(np.sqrt(plan.rows / _PER_CELL))
        self._counts = tuple(
            min(max(1, sampled if axis.count is None else axis.count), MOST_CELLS)
            for axis in self._axes
        )
        size = self._counts[0] * self._counts[1]
        self._nearest = np.full(size, np.inf)
        self._cells = {name: np.full(size, np.nan) for name in plan.quantities}

    def add(self, part: pd.DataFrame) -> None:
        """Take scenes into account: of a grid those in the middle of all further axes."""
        drawn = np.ones(len(part), dtype=bool)
        if self._plan.sample == "grid":
            places = self._plan.places(range(part.index[0], part.index[-1] + 1))
            for axis, place in zip(self._plan.axes[_IN_A_MAP:], places[_IN_A_MAP:], strict=True):
                drawn &= place == (axis.count or 1) // 2
        count_drawn = int(drawn.sum())
        cell, away = np.zeros(count_drawn, dtype=np.int64), np.zeros(count_drawn)
        for axis, count in zip(self._axes, self._counts, strict=True):
            share = axis.share(part[axis.column].to_numpy()[drawn])
            fine = share * (count - 1) if axis.count is not None else share * count - 0.5
            index = np.clip(np.rint(fine), 0, count - 1).astype(np.int64)
            away += (fine - index) ** 2
            cell = cell * count + index
        order = np.lexsort((away, cell))
        first = order[np.flatnonzero(np.diff(cell[order], prepend=-1))]
        better = first[away[first] < self._nearest[cell[first]]]
        self._nearest[cell[better]] = away[better]
        for name, cells in self._cells.items():
            cells[cell[better]] = part[name].to_numpy()[drawn][better]

    def image(self, name: str) -> Floats:
        """Return a quantity, shape (up, across)."""
        return self._cells[name].reshape(self._counts).T

    def figure(self) -> Figure:
        """Return the figure of all that was added."""
        across, up = self._axes
        x, y = (self._edges(number) for number in range(2))
        panels = []
        for name in self._plan.quantities[:MOST_PANELS]:
            known, z = QUANTITIES[name], self.image(name)
            finite = z[np.isfinite(z)]
            signed = bool(finite.size and finite.min() < 0.0 < finite.max())
            panels.append(
                Panel(
                    title=known.label,
                    x_label=across.label,
                    y_label=up.label,
                    series=(),
                    log_x=across.log,
                    log_y=up.log,
                    heat=Heatmap(label=known.axis, x=x, y=y, z=z, signed=signed),
                )
            )
        over, first = f"over {across.name} and {up.name}", self.image(self._plan.quantities[0])
        return _figure(self._plan, over, panels, first)

    def _edges(self, number: int) -> Floats:
        """Return the edges of the cells along an axis."""
        axis, count = self._axes[number], self._counts[number]
        ends = np.arange(count + 1, dtype=np.float64)
        if axis.low == axis.high or count == 1:
            return np.array((axis.low, axis.high if axis.high > axis.low else axis.low + 1.0))
        shares = (ends - 0.5) / (count - 1) if axis.count is not None else ends / count
        edges = axis.at(shares)
        return edges if edges[-1] > edges[0] else -np.sort(-edges)


class Curves:
    """A curve of each quantity over a parameter, or against another, filled part by part."""

    def __init__(self, plan: SweepPlan, against: str | None) -> None:
        self._plan = plan
        self._against = against
        self._stride = max(1, -(-plan.rows // POINTS_MOST))
        self._x: list[Floats] = []
        self._y: dict[str, list[Floats]] = {name: [] for name in plan.quantities}

    def add(self, part: pd.DataFrame) -> None:
        """Take consecutive scenes into account: every n-th, so that memory does not grow."""
        drawn = part[part.index % self._stride == 0]
        self._x.append(drawn[self._against or self._plan.axes[0].column].to_numpy())
        for name, parts in self._y.items():
            parts.append(drawn[name].to_numpy())

    def curve(self, name: str) -> tuple[Floats, Floats]:
        """Return a quantity along the horizontal axis, without scenes that have no place on it."""
        x, y = np.concatenate(self._x), np.concatenate(self._y[name])
        x, y = x[~np.isnan(x)], y[~np.isnan(x)]
        order = np.argsort(x, kind="stable")
        return x[order], y[order]

    def figure(self) -> Figure:
        """Return the figure of all that was added."""
        plan, against, axis = self._plan, self._against, self._plan.axes[0]
        engine = plan.base.engine
        line = plan.sample == "grid" and len(plan.axes) == 1
        mark: Literal["line", "points"] = "line" if line else "points"
        panels = []
        for name in [name for name in plan.quantities if name != against][:MOST_PANELS]:
            known, (x, y) = QUANTITIES[name], self.curve(name)
            panels.append(
                Panel(
                    title=known.label,
                    x_label=QUANTITIES[against].axis if against else axis.label,
                    y_label=known.axis,
                    series=(Series(label=engine, kind=engine, x=x, y=y, mark=mark),),
                    log_x=_wide(x) if against else axis.log,
                    log_y=_wide(y),
                )
            )
        over = f"against {against}" if against else f"over {axis.name}"
        return _figure(plan, over, panels, panels[0].series[0].y)


def _wide(values: Floats) -> bool:
    """Whether numbers span so much that a logarithm shows them better."""
    known = values[np.isfinite(values) & (values != 0.0)]
    return bool(known.size and known.min() > 0.0 and known.max() > _DECADES * known.min())


def _figure(plan: SweepPlan, over: str, panels: list[Panel], drawn: Floats) -> Figure:
    """Return the figure of these panels; `drawn` are the values in the first panel."""
    return Figure(
        name="sweep",
        title=f"{plan.base.scene.name} {over}",
        seen=_seen(plan, panels[0].title, drawn),
        panels=tuple(panels),
        columns=1 if len(panels) == 1 else 2,
    )


def _seen(plan: SweepPlan, title: str, drawn: Floats) -> str:
    """Return two sentences: the range of the first panel, and what all panels leave out."""
    how = "the exact bounce" if plan.exact else plan.base.engine
    span = drawn[np.isfinite(drawn)]
    extent = (
        f"runs from {span.min():.4g} to {span.max():.4g}" if span.size else "is nowhere defined"
    )
    seen = f"{title} {extent} in {plan.rows:,} scenes by {how}."
    left_out = "Blank is a scene without the quantity"
    further = plan.axes[_IN_A_MAP:]
    if further and plan.sample == "grid":
        middles = [axis.values(np.array([(axis.count or 1) // 2]))[0] for axis in further]
        fixed = (f"{a.name} = {m:.6g}" for a, m in zip(further, middles, strict=True))
        left_out += f"; drawn is the plane {', '.join(fixed)}, the table has all"
    elif further:
        left_out += "; the further parameters vary from cell to cell, the table has all"
    return f"{seen} {left_out}."
