"""The attribution in a waterfall: from the engine as it ships down to what remains."""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from harness.artefact import Figure, Panel, Series
from harness.case import Case
from harness.runner import Evaluation
from harness.studies.attribution.accounts import Account, Level
from harness.studies.attribution.path import Path
from harness.studies.attribution.quantities import QUANTITIES, Quantity, uncounted
from harness.trajectory import Floats

_PANELS = 4


def waterfall(
    way: Path, evaluations: Mapping[Case, Evaluation], accounts: Mapping[str, Account]
) -> Figure:
    """Return the waterfall of the first quantities that are known anywhere on the way."""
    drawn = [
        quantity
        for quantity in QUANTITIES
        if any(level is not None for level in accounts[quantity.key].levels)
    ]
    return Figure(
        name=f"{way.scene.name}-{way.engine}-waterfall",
        title=f"From default to matched: {way.engine}",
        seen=_seen(way, evaluations),
        panels=tuple(_panel(way, quantity, accounts[quantity.key]) for quantity in drawn[:_PANELS]),
        scene=way.scene.name,
    )


def _panel(way: Path, quantity: Quantity, found: Account) -> Panel:
    """Return the waterfall of one quantity."""
    levels = _numbers(found.levels, quantity)
    alone = _numbers(found.alone, quantity)
    places = np.arange(1.0, len(way.names) + 1.0)
    amounts = [_told(value, quantity) for value in found.in_order]
    unit = f" [{quantity.unit}]" if quantity.unit else ""
    return Panel(
        title=quantity.words.capitalize(),
        x_label="gaps, closed from left to right",
        y_label=f"off by{unit}",
        x_names=("as shipped", *way.names, "matched"),
        series=(
            Series(
                label="discrepancy",
                kind=way.engine,
                x=np.array((0.0, len(way.names) + 1.0)),
                y=levels[[0, -1]],
                base=np.zeros(2),
                mark="bars",
            ),
            Series(
                label="taken away by a gap, in this order",
                kind=way.engine,
                x=places,
                y=levels[1:],
                base=levels[:-1],
                mark="bars",
                hover=tuple(map("{}: {}".format, way.names, amounts)),
            ),
            Series(
                label="where it would end if it took away as much as alone",
                kind="reference",
                x=places,
                y=levels[:-1] - alone,
                mark="points",
                hover=tuple(
                    f"{name}, alone: {_told(value, quantity)}"
                    for name, value in zip(way.names, found.alone, strict=True)
                ),
            ),
        ),
    )


def _numbers(values: Sequence[Level], quantity: Quantity) -> Floats:
    """Return values in the unit of the axis, NaN where they are not known."""
    return np.array([math.nan if value is None else value * quantity.scale for value in values])


def _told(value: Level, quantity: Quantity) -> str:
    if value is None:
        return "not known"
    return f"takes away {value * quantity.scale:+.3g} {quantity.unit}".rstrip()


def _seen(way: Path, evaluations: Mapping[Case, Evaluation]) -> str:
    """Return how to read the figure and what is missing in it."""
    lost = uncounted(evaluations.values())
    missing = (
        f"; bars that rest on the {lost} of {len(evaluations)} runs whose turn cannot be counted "
        "are left out"
        if lost
        else ""
    )
    return (
        f"Each bar is what closing one more gap takes away, from {way.engine} as it ships to "
        "matched. A mark off the end of its bar is interaction: alone, that gap takes away "
        f"another amount{missing}."
    )
