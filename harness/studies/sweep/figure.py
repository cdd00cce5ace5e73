"""The figure of a sweep: a curve over one parameter, a map over two."""

import numpy as np

from harness.artefact import Figure, Floats, Heat, Panel, Series
from harness.studies.sweep.cells import Cells
from harness.studies.sweep.points import Points
from harness.sweep import QUANTITIES, Plan

MOST_PANELS = 6
"""Quantities that are drawn; the table has all."""

_DECADES = 100.0
"""Ratio of largest to least from which an axis is logarithmic."""

_FIRST_TWO = 2


def maps(plan: Plan, cells: Cells) -> Figure:
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
                title=known.label.partition(" [")[0],
                x_label=across.label,
                y_label=up.label,
                series=(),
                log_x=across.log,
                log_y=up.log,
                heat=Heat(label=known.label, x=x, y=y, z=z, signed=signed),
            )
        )
    return Figure(
        name="sweep",
        title=f"{plan.scene.name} over {across.name} and {up.name}",
        seen=_seen(plan, panels[0].title, cells.image(plan.quantities[0])),
        panels=tuple(panels),
        columns=1 if len(panels) == 1 else 2,
    )


def curves(plan: Plan, points: Points, against: str | None) -> Figure:
    """Return the curve of each quantity over the parameter, or against another quantity."""
    axis = plan.axes[0]
    label = QUANTITIES[against].label if against else axis.label
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
                title=known.label.partition(" [")[0],
                x_label=label,
                y_label=known.label,
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


def _seen(plan: Plan, title: str, drawn: Floats) -> str:
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
