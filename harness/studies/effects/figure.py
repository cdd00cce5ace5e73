"""The effects study in a figure: how much each effect changes, over the change that counts."""

import math
from collections.abc import Mapping

import numpy as np

from harness.artefact import Figure, Panel, Series
from harness.case import Case
from harness.runner import Evaluation
from harness.studies.effects.plan import Plan
from harness.studies.effects.quantities import QUANTITIES
from harness.studies.effects.verdict import Effect, threshold
from models.effects import KINDS

_LEAST = 1e-6
"""Change over what counts below which a bar would be longer than the axis is worth."""


def bars(made: Plan, found: Mapping[Case, Evaluation], effects: tuple[Effect, ...]) -> Figure:
    """Return the largest change of each effect, in units of the change that counts."""
    names = tuple(KINDS)
    series = []
    for place, mover in enumerate(made.engines):
        own = {one.name: one for one in effects if one.mover == mover}
        heights = [_height(made, found, own[name]) for name in names]
        shift = 0.8 * ((place + 0.5) / len(made.engines) - 0.5)
        series.append(
            Series(
                label=mover,
                kind=mover,
                x=np.arange(len(names), dtype=np.float64) + shift,
                y=np.array(heights),
                mark="points",
                hover=tuple(
                    f"{name}: {own[name].verdict.value}. {own[name].why}" for name in names
                ),
            )
        )
    series.append(
        Series(
            label="what counts",
            kind="truth",
            x=np.array((-0.5, len(names) - 0.5)),
            y=np.ones(2),
            dashed=True,
        )
    )
    return Figure(
        name=f"{made.scene.name}-effect-changes",
        title="What each effect changes",
        seen=_seen(made, effects),
        panels=(
            Panel(
                title="Largest change of any quantity, over the change that counts",
                x_label="effect",
                y_label="change over what counts []",
                x_names=tuple(
                    f"{name} (declared)" if name in made.declared else name for name in names
                ),
                series=tuple(series),
                log_y=True,
            ),
        ),
        columns=1,
        scene=made.scene.name,
    )


def _height(made: Plan, found: Mapping[Case, Evaluation], one: Effect) -> float:
    """Return the largest change of an effect over what counts; NaN where none is known."""
    shares = [
        abs(value) / threshold(made, found, one.mover, quantity.key)
        for quantity in QUANTITIES
        if (value := one.changes.get(quantity.key)) is not None
    ]
    return max(*shares, _LEAST) if shares else math.nan


def _seen(made: Plan, effects: tuple[Effect, ...]) -> str:
    """Return in two sentences which effects count and which do not."""
    own = [one for one in effects if one.mover == made.engines[0]]
    counts = [one.name for one in own if one.verdict.value in {"needed", "missing"}]
    nothing = [one.name for one in own if one.verdict.value == "harmless"]
    return (
        f"By {made.engines[0]}, above the dashed line lie {', '.join(counts) or 'no effects'}: at "
        "the strength declared or assumed they change the outcome. Below it lie "
        f"{', '.join(nothing) or 'none'}, which cost time and change nothing that counts."
    )
