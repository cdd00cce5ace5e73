"""The figure of a sweep: a curve over one parameter, a map over two.

One scene for each cell of a map: of all that fall into it the one nearest to its middle.

Not a mean: where the sign of the turn changes, the mean of two turns is a turn that no can makes.

Points of a curve: every so-manieth scene of a sweep, so that memory does not grow with it.
"""

import numpy as np

from harness.core.report_model import Figure, Heatmap, Panel, Series
from harness.core.trajectory import Floats
from harness.sweep.axes import Axis
from harness.sweep.plan import SweepPlan
from harness.sweep.quantities import QUANTITIES

MOST = 400
"""Cells across, and up: a figure has about as many pixels to tell apart."""

_PER_CELL = 2.0
"""Scenes of a sample for each cell, so that few stay blank."""


class Cells:
    """A map that is filled part by part, in memory that does not grow.

    Parameters
    ----------
    across, up : Axis
    rows : int
        Scenes to come.
    quantities : tuple of str
    """

    def __init__(self, across: Axis, up: Axis, rows: int, quantities: tuple[str, ...]) -> None:
        self._axes = (across, up)
        sampled = int(np.sqrt(rows / _PER_CELL))
        self._counts = tuple(
            min(max(1, sampled if axis.count is None else axis.count), MOST) for axis in self._axes
        )
        size = self._counts[0] * self._counts[1]
        self._nearest = np.full(size, np.inf)
        self._found = {name: np.full(size, np.nan) for name in quantities}

    def add(self, places: tuple[Floats, Floats], values: dict[str, Floats]) -> None:
        """Take scenes into account: their parameters, shape (n,), and quantities."""
        cell, away = np.zeros(len(places[0]), dtype=np.int64), np.zeros(len(places[0]))
        for axis, count, place in zip(self._axes, self._counts, places, strict=True):
            share = axis.share(place)
            fine = share * (count - 1) if axis.count is not None else share * count - 0.5
            index = np.clip(np.rint(fine), 0, count - 1).astype(np.int64)
            away += (fine - index) ** 2
            cell = cell * count + index
        order = np.lexsort((away, cell))
        first = order[np.flatnonzero(np.diff(cell[order], prepend=-1))]
        better = first[away[first] < self._nearest[cell[first]]]
        self._nearest[cell[better]] = away[better]
        for name, found in self._found.items():
            found[cell[better]] = values[name][better]

    def image(self, name: str) -> Floats:
        """Return a quantity, shape (up, across)."""
        return self._found[name].reshape(self._counts).T

    def edges(self) -> tuple[Floats, Floats]:
        """Return the edges of the cells across and up."""
        across, up = (self._edges(n) for n in range(2))
        return across, up

    def _edges(self, number: int) -> Floats:
        axis, count = self._axes[number], self._counts[number]
        ends = np.arange(count + 1, dtype=np.float64)
        if axis.low == axis.high or count == 1:
            return np.array((axis.low, axis.high if axis.high > axis.low else axis.low + 1.0))
        shares = (ends - 0.5) / (count - 1) if axis.count is not None else ends / count
        edges = axis.at(shares)
        return edges if edges[-1] > edges[0] else -np.sort(-edges)


POINTS_MOST = 20_000
"""Points of a curve; what lies closer no screen shows."""


class Points:
    """A curve that is filled part by part.

    Parameters
    ----------
    rows : int
        Scenes to come.
    quantities : tuple of str
    """

    def __init__(self, rows: int, quantities: tuple[str, ...]) -> None:
        self._stride = max(1, -(-rows // POINTS_MOST))
        self._x: list[Floats] = []
        self._y: dict[str, list[Floats]] = {name: [] for name in quantities}

    def add(self, rows: range, x: Floats, values: dict[str, Floats]) -> None:
        """Take consecutive scenes into account."""
        there = np.arange(rows.start, rows.stop) % self._stride == 0
        self._x.append(x[there])
        for name, parts in self._y.items():
            parts.append(values[name][there])

    def curve(self, name: str) -> tuple[Floats, Floats]:
        """Return a quantity along the horizontal axis, without what has no place there."""
        x, y = np.concatenate(self._x), np.concatenate(self._y[name])
        x, y = x[~np.isnan(x)], y[~np.isnan(x)]
        order = np.argsort(x, kind="stable")
        return x[order], y[order]


MOST_PANELS = 6
"""Quantities that are drawn; the table has all."""

_DECADES = 100.0
"""Ratio of largest to least from which an axis is logarithmic."""

_FIRST_TWO = 2


def maps(plan: SweepPlan, cells: Cells) -> Figure:
    """Return the map of each quantity over the first two parameters."""
    across, up = plan.axes[:_FIRST_TWO]
    x, y = cells.edges()
    panels = []
    for name in plan.quantities[:MOST_PANELS]:
        known, z = QUANTITIES[name], cells.image(name)
        there = z[np.isfinite(z)]
        signed = bool(there.size and there.min() < 0.0 < there.max())
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
    return Figure(
        name="sweep",
        title=f"{plan.scene.name} over {across.name} and {up.name}",
        seen=_seen(plan, panels[0].title, cells.image(plan.quantities[0])),
        panels=tuple(panels),
        columns=1 if len(panels) == 1 else 2,
    )


def curves(plan: SweepPlan, points: Points, against: str | None) -> Figure:
    """Return the curve of each quantity over the parameter, or against another quantity."""
    axis = plan.axes[0]
    label = QUANTITIES[against].axis if against else axis.label
    panels = []
    for name in [name for name in plan.quantities if name != against][:MOST_PANELS]:
        known, (x, y) = QUANTITIES[name], points.curve(name)
        series = Series(
            label=plan.engine,
            kind=plan.engine,
            x=x,
            y=y,
            mark="line" if plan.sample == "grid" and len(plan.axes) == 1 else "points",
        )
        panels.append(
            Panel(
                title=known.label,
                x_label=label,
                y_label=known.axis,
                series=(series,),
                log_x=axis.log if against is None else _wide(x),
                log_y=_wide(y),
            )
        )
    over = f"against {against}" if against else f"over {axis.name}"
    return Figure(
        name="sweep",
        title=f"{plan.scene.name} {over}",
        seen=_seen(plan, panels[0].title, panels[0].series[0].y),
        panels=tuple(panels),
        columns=1 if len(panels) == 1 else 2,
    )


def _wide(values: Floats) -> bool:
    """Whether numbers span so much that a logarithm shows them better."""
    there = values[np.isfinite(values) & (values != 0.0)]
    return bool(there.size and there.min() > 0.0 and there.max() > _DECADES * there.min())


def _seen(plan: SweepPlan, title: str, drawn: Floats) -> str:
    """Return in two sentences what the first panel shows, and what is left out of all."""
    how = "the exact bounce" if plan.exact else plan.engine
    there = drawn[np.isfinite(drawn)]
    told = (
        f"runs from {there.min():.4g} to {there.max():.4g}" if there.size else "is nowhere defined"
    )
    seen = f"{title} {told} in {plan.rows:,} scenes by {how}."
    left_out = "Blank is a scene without the quantity"
    further = plan.axes[_FIRST_TWO:]
    if further and plan.sample == "grid":
        middles = [axis.values(np.array([(axis.count or 1) // 2]))[0] for axis in further]
        fixed = (f"{a.name} = {m:.6g}" for a, m in zip(further, middles, strict=True))
        left_out += f"; drawn is the plane {', '.join(fixed)}, the table has all"
    elif further:
        left_out += "; the further parameters vary from cell to cell, the table has all"
    return f"{seen} {left_out}."
