"""Report of a sweep, read partition by partition in memory that does not grow with the sweep.

A curve over one parameter or a map over two, the distribution of each quantity, its extremes with
their scenes, and how the scenes ended. It is made of reductions: those that a sweep keeps in place
of rows, or those of its rows.
"""

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import partial

import numpy as np
import pandas as pd

from harness.core.report_model import (
    Artefact,
    Column,
    Figure,
    Panel,
    Prose,
    Series,
    Table,
    table_of,
)
from harness.sweep.derivatives import caveats
from harness.sweep.drawing import MOST_PANELS, drawing_of, is_wide
from harness.sweep.plan import SweepPlan
from harness.sweep.reduction import Extent, Reduction, merged, reduction_of
from harness.sweep.values import QUANTITIES

_BARS = 128
"""Of the figure of a distribution, at most: each as wide as a few points."""


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
    plan: SweepPlan, parts: Iterable[pd.DataFrame | Reduction], against: str | None = None
) -> Overview:
    """Return the overview of a sweep, in memory that does not grow with it.

    Parameters
    ----------
    plan : SweepPlan
    parts : iterable of DataFrame or Reduction
        All of them.
    against : str, optional
        A quantity to be the horizontal axis of curves, in place of a parameter.
    """
    drawing = drawing_of(plan, against)
    whole = merged(
        plan,
        (
            part if isinstance(part, Reduction) else reduction_of(plan, part, drawing)
            for part in parts
        ),
        drawing,
    )
    return Overview(
        plan=plan,
        outcomes=dict(Counter(whole.outcomes).most_common()),
        extents={extent.name: extent for extent in whole.extents if extent.count},
        figure=drawing.figure(),
    )


def _quantile(share: float, extent: Extent) -> float:
    """Return the middle of the numbers between which a quantile lies."""
    low, high = extent.quantile(share)
    return low + (high - low) / 2.0


EXTENTS = (
    Column("quantity", "With its unit last.", "name"),
    Column(
        "scenes", "How many have a finite one; why others have none, their outcome says.", "count"
    ),
    Column("infinite", "How many have an infinite one, which no other column has."),
    Column("least", "In the quantity's unit.", "low"),
    Column("mean", "In the quantity's unit, over the scenes that have it."),
    Column("largest", "In the quantity's unit.", "high"),
    Column("deviation", "Standard deviation, in the quantity's unit."),
    *(
        Column(
            f"p{percent}",
            f"What {percent} % of the scenes that have it lie below, in the quantity's unit: the "
            "middle of the bin that holds it.",
            partial(_quantile, percent / 100),
        )
        for percent in (1, 50, 99)
    ),
)

_EXTREMES = (
    Column("quantity", "With its unit last."),
    Column("extreme", "Least or largest."),
    Column("value", "In the quantity's unit."),
    Column("row", "Number of the scene, from 0."),
)


def _extremes(sweep: Overview) -> Table:
    """Return the table of the scenes with the least and the largest of each quantity."""
    records = []
    for extent in sweep.extents.values():
        for word, value, row in (
            ("least", extent.low, extent.low_row),
            ("largest", extent.high, extent.high_row),
        ):
            scene = sweep.plan.values(range(row, row + 1))
            numbers = {axis.column: float(scene[axis.name][0]) for axis in sweep.plan.axes}
            records.append(
                {"quantity": extent.name, "extreme": word, "value": value, "row": row, **numbers}
            )
    parameters = (Column(axis.column, f"{axis.name} of the scene.") for axis in sweep.plan.axes)
    title = "The scenes with the extremes"
    return table_of("extremes", title, (*_EXTREMES, *parameters), records)


def _distribution(sweep: Overview) -> Figure:
    """Return the figure of how each quantity is distributed."""
    panels = []
    for name, extent in list(sweep.extents.items())[:MOST_PANELS]:
        ends = np.array((extent.low, extent.high))
        wide = is_wide(ends)
        bins = extent.rising if wide else extent.even
        bundle = -(-bins.counts.size // _BARS)
        edges, counts = (
            bins.edges(),
            np.add.reduceat(bins.counts, range(0, bins.counts.size, bundle)),
        )
        left = edges[:-1][::bundle]
        right = np.append(left[1:], edges[-1])
        # a density: bars of an octave's equal parts are not equally wide on either axis
        width = np.log10(right / left) if wide else right - left
        density = counts / counts.sum() / width
        panels.append(
            Panel(
                title=QUANTITIES[name].label,
                x_label=QUANTITIES[name].axis,
                y_label=f"share of scenes per {'decade' if wide else _unit(name)}",
                series=(
                    Series(
                        label=sweep.plan.base.engine,
                        kind=sweep.plan.base.engine,
                        x=np.column_stack((left, right)).ravel(),
                        y=np.repeat(density, 2),
                    ),
                ),
                log_x=wide,
            )
        )
    return Figure(
        name="distribution",
        title="How often each value occurs",
        seen=_distribution_seen(sweep),
        panels=tuple(panels),
        columns=1 if len(panels) == 1 else 2,
    )


def _unit(name: str) -> str:
    """Return the unit of a quantity, or one."""
    return QUANTITIES[name].unit or "1"


def _distribution_seen(sweep: Overview) -> str:
    """Return two sentences on the distribution of the first quantity."""
    extent = next(iter(sweep.extents.values()))
    low, high = (_quantile(share, extent) for share in (0.01, 0.99))
    label = QUANTITIES[extent.name].axis
    return (
        f"In 98 % of {extent.count:,} scenes the {label} lies between {low:.5g} and {high:.5g}. "
        "Every scene is counted; the area below a curve is one."
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
        *([_distribution(sweep)] if sweep.extents else []),
        table_of("quantities", "What the scenes have", EXTENTS, sweep.extents.values()),
        _extremes(sweep),
        table_of("outcomes", "How the scenes ended", _OUTCOMES, sweep.outcomes.items()),
    )


def _summary(sweep: Overview) -> str:
    """Return the sweep in a few sentences."""
    plan = sweep.plan
    over = " and ".join(axis.text() for axis in plan.axes)
    how = "the exact bounce" if plan.exact else f"{plan.base.engine} {plan.engine_version}"
    sentences = [f"{plan.rows:,} scenes like {plan.base.scene.name}, over {over}, by {how}."]
    sentences += [f"{count:,}: {outcome}." for outcome, count in list(sweep.outcomes.items())[:5]]
    for name, extent in list(sweep.extents.items())[:1]:
        label = QUANTITIES[name].axis
        sentences.append(f"The {label} lies between {extent.low:.6g} and {extent.high:.6g}.")
    sentences += caveats(plan.quantities)
    return " ".join(sentences)
