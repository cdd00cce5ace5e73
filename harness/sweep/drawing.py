"""What is drawn of a sweep: a map over two parameters, or a curve over one, filled part by part.

A cell of a map shows the scene nearest to its middle and no mean: where the sign of the turn
changes, the mean of two turns is a turn that no can makes. Of scenes as near it is the first, so
that the order of the parts changes nothing.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from harness.core.report_model import Figure, Heatmap, Panel, Series
from harness.core.trajectory import Floats
from harness.sweep.plan import SweepPlan
from harness.sweep.values import QUANTITIES

MOST_CELLS = 400
"""Cells across, and up: a figure has about as many pixels to distinguish."""

REDUCED_CELLS = 100
"""The same of a sample without rows: each of its partitions fills all cells of a map."""

_PER_CELL = 2.0
"""Scenes of a sample for each cell, so that few stay blank."""

POINTS_MOST = 20_000
"""Points of a curve: more than a screen resolves."""

MOST_PANELS = 6
"""Quantities that are drawn; the table has all."""

_DECADES = 100.0
"""Ratio of largest to least from which an axis is logarithmic."""

_IN_A_MAP = 2


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Drawn:
    """The scenes that are drawn of some scenes.

    Parameters
    ----------
    rows : ndarray of int, shape (n,)
        Their numbers.
    cells : ndarray of int, shape (n,)
        Of a map, where each is drawn; of a curve their numbers again.
    where : ndarray, shape (n,)
        Of a map the squared distances from the middles of cells; of a curve the horizontal axis.
    numbers : ndarray, shape (quantities, n)
    """

    rows: NDArray[np.int64]
    cells: NDArray[np.int64]
    where: Floats
    numbers: Floats


class Map:
    """A map of each quantity over the first two parameters, filled part by part."""

    def __init__(self, plan: SweepPlan) -> None:
        self._plan = plan
        self._axes = plan.axes[:_IN_A_MAP]
        most = REDUCED_CELLS if plan.reduced and plan.sample != "grid" else MOST_CELLS
        sampled = int(np.sqrt(plan.rows / _PER_CELL))
        self._counts = tuple(
            min(max(1, sampled if axis.count is None else axis.count), most) for axis in self._axes
        )
        size = self._counts[0] * self._counts[1]
        self._nearest = np.full(size, np.inf)
        self._rows = np.full(size, -1, dtype=np.int64)
        self._values = np.full((len(plan.quantities), size), np.nan)

    def of(self, part: pd.DataFrame) -> Drawn:
        """Return the scene nearest to each cell's middle.

        Of a grid only scenes in the middle of all further axes are drawn.
        """
        start, drawn = int(part.index[0]), np.arange(len(part))
        if self._plan.sample == "grid" and len(self._plan.axes) > _IN_A_MAP:
            places = self._plan.places(range(start, start + len(part)))
            for axis, place in zip(self._plan.axes[_IN_A_MAP:], places[_IN_A_MAP:], strict=True):
                drawn = drawn[place[drawn] == (axis.count or 1) // 2]
        cell, away = np.zeros(drawn.size, dtype=np.int64), np.zeros(drawn.size)
        for axis, count in zip(self._axes, self._counts, strict=True):
            share = axis.share(part[axis.column].to_numpy()[drawn])
            fine = share * (count - 1) if axis.count is not None else share * count - 0.5
            index = np.clip(np.rint(fine), 0, count - 1).astype(np.int64)
            away += (fine - index) ** 2
            cell = cell * count + index
        order = np.lexsort((away, cell))
        first = order[np.flatnonzero(np.diff(cell[order], prepend=-1))]
        near = drawn[first]
        values = np.stack([part[name].to_numpy()[near] for name in self._plan.quantities])
        return Drawn(rows=start + near, cells=cell[first], where=away[first], numbers=values)

    def merge(self, drawn: Drawn) -> None:
        """Take the drawn scenes of other scenes into account."""
        here = self._nearest[drawn.cells]
        earlier = (drawn.where == here) & (drawn.rows < self._rows[drawn.cells])
        better = (drawn.where < here) | earlier
        cells = drawn.cells[better]
        self._nearest[cells], self._rows[cells] = drawn.where[better], drawn.rows[better]
        self._values[:, cells] = drawn.numbers[:, better]

    def add(self, part: pd.DataFrame) -> None:
        """Take scenes into account."""
        self.merge(self.of(part))

    def drawn(self) -> Drawn:
        """Return all that is drawn."""
        cells = np.flatnonzero(self._rows >= 0)
        return Drawn(
            rows=self._rows[cells],
            cells=cells,
            where=self._nearest[cells],
            numbers=self._values[:, cells],
        )

    def image(self, name: str) -> Floats:
        """Return a quantity, shape (up, across)."""
        values: Floats = self._values[self._plan.quantities.index(name)]
        return values.reshape(self._counts).T

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
        self._parts: list[Drawn] = []

    def of(self, part: pd.DataFrame) -> Drawn:
        """Return every n-th scene, so that memory does not grow with the sweep."""
        drawn = part[part.index % self._stride == 0]
        rows = drawn.index.to_numpy(np.int64)
        return Drawn(
            rows=rows,
            cells=rows,
            where=drawn[self._against or self._plan.axes[0].column].to_numpy(),
            numbers=np.stack([drawn[name].to_numpy() for name in self._plan.quantities]),
        )

    def merge(self, drawn: Drawn) -> None:
        """Take the drawn scenes of other scenes into account."""
        self._parts.append(drawn)

    def add(self, part: pd.DataFrame) -> None:
        """Take consecutive scenes into account."""
        self.merge(self.of(part))

    def drawn(self) -> Drawn:
        """Return all that is drawn, in the order of the scenes."""
        parts = self._parts
        order = np.argsort(np.concatenate([part.rows for part in parts]))
        rows = np.concatenate([part.rows for part in parts])[order]
        return Drawn(
            rows=rows,
            cells=rows,
            where=np.concatenate([part.where for part in parts])[order],
            numbers=np.concatenate([part.numbers for part in parts], axis=1)[:, order],
        )

    def curve(self, name: str) -> tuple[Floats, Floats]:
        """Return a quantity along the horizontal axis, without scenes that have no place on it."""
        drawn = self.drawn()
        x, y = drawn.where, drawn.numbers[self._plan.quantities.index(name)]
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
                    log_x=is_wide(x) if against else axis.log,
                    log_y=is_wide(y),
                )
            )
        over = f"against {against}" if against else f"over {axis.name}"
        return _figure(plan, over, panels, panels[0].series[0].y)


def drawing_of(plan: SweepPlan, against: str | None = None) -> Map | Curves:
    """Return an empty map, or curves where there is one parameter.

    Parameters
    ----------
    plan : SweepPlan
    against : str, optional
        A quantity to be the horizontal axis of curves, in place of a parameter.
    """
    mapped = against is None and len(plan.axes) >= _IN_A_MAP
    return Map(plan) if mapped else Curves(plan, against)


def is_wide(values: Floats) -> bool:
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
