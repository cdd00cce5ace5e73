"""The three errors in figures: against the timestep, against effort, and what cannot be decided."""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from harness.core.case import Case
from harness.core.report_model import Figure, Panel, Series
from harness.core.trajectory import Floats
from harness.evaluation.evaluation import Evaluation
from harness.metrics.quantities import Number, Quantity
from harness.studies.errors.plan import ErrorsPlan, Way
from harness.studies.errors.split import Split, Spread
from harness.studies.shared.perturbation import SIZES


def ladder_figure(
    plan: ErrorsPlan,
    evaluations: Mapping[Case, Evaluation],
    splits: Mapping[tuple[str, str], Split],
    known: Sequence[Quantity],
) -> Figure:
    """Return the errors against the timestep: from the truth, and from the engine's own limit."""
    x = np.array(plan.timesteps)
    panels = []
    for quantity in known:
        series = []
        for way in plan.ways:
            found = splits[way.name, quantity.key]
            values = [quantity.of_run(evaluations[plan.on_ladder(way, h)]) for h in plan.timesteps]
            for told, level in (
                ("truth", found.true),
                ("limit", None if found.limit is None else found.limit.value),
            ):
                series.append(
                    Series(
                        label=f"off {told}, {way.name}",
                        kind=_kind(plan, way),
                        x=x,
                        y=_off(values, level),
                        mark="both",
                        dashed=told == "limit",
                    )
                )
        panels.append(_panel(quantity, "timestep [s]", tuple(series)))
    seen = (
        "Off its own limit (dashed) an engine falls with the timestep: discretisation. Where the "
        "error against the truth (solid) falls with it, the limit is the truth; where it levels "
        "off, what is left is model form, and no timestep takes it away."
    )
    return _figure(plan, "errors", "Model form and discretisation", seen, panels)


def _figure(plan: ErrorsPlan, name: str, title: str, seen: str, panels: Sequence[Panel]) -> Figure:
    """Return a figure whose name and title say engine and profile."""
    return Figure(
        name=f"{plan.scene.name}-{plan.engine}-{plan.profile}-{name}",
        title=f"{title}: {plan.engine}, {plan.profile}",
        seen=seen,
        panels=tuple(panels),
        scene=plan.scene.name,
    )


def effort_figure(
    plan: ErrorsPlan, evaluations: Mapping[Case, Evaluation], known: Sequence[Quantity]
) -> Figure | None:
    """Return the solver error against the effort, or None if the engine declares none."""
    lesser = plan.efforts[:-1]
    if not lesser:
        return None
    panels = []
    for quantity in known:
        series = []
        for way in plan.ways:
            values = [quantity.of_run(evaluations[plan.tried(way, effort)]) for effort in lesser]
            converged = quantity.of_run(evaluations[plan.on_ladder(way, plan.probe)])
            series.append(
                Series(
                    label=way.name,
                    kind=_kind(plan, way),
                    x=np.arange(float(len(lesser))),
                    y=_off(values, converged),
                    mark="points",
                )
            )
        panels.append(
            _panel(
                quantity,
                "effort of the solver",
                tuple(series),
                names=tuple(effort.name for effort in lesser),
            )
        )
    seen = (
        f"Each mark is how far the engine, at a timestep of {plan.probe:.2g} s, is from itself "
        "with its solver converged. Efforts without a mark are equal to it in every digit."
    )
    return _figure(plan, "solver", "Solver error", seen, panels)


def ensemble_figure(
    plan: ErrorsPlan, spreads: Mapping[tuple[str, float], Spread], known: Sequence[Quantity]
) -> Figure:
    """Return how far slightly perturbed releases spread."""
    x = np.array(SIZES)
    panels = []
    for quantity in known:
        own = [spreads[quantity.key, size] for size in SIZES]
        series = (
            Series(
                label="exact motion",
                kind="reference",
                x=x,
                y=_off([one.of_truth for one in own], 0.0),
                mark="both",
            ),
            Series(
                label=f"{plan.engine}, {plan.profile}, {plan.probe:.2g} s",
                kind=plan.engine,
                x=x,
                y=_off([one.of_engine for one in own], 0.0),
                mark="both",
            ),
        )
        panels.append(_panel(quantity, "relative size of the perturbation", series, log_x=True))
    seen = (
        "How far releases spread that differ by so little. A discrepancy smaller than that cannot "
        "be told from a release known no better; where the engine lies above the exact motion, it "
        "is itself not smooth at this size."
    )
    return _figure(plan, "ensemble", "What is not decidable", seen, panels)


def _kind(plan: ErrorsPlan, way: Way) -> str:
    """Return what decides the colour of a way."""
    return plan.engine if way is plan.ways[0] else f"{plan.engine}, {way.name}"


def _panel(
    quantity: Quantity,
    x_label: str,
    series: tuple[Series, ...],
    *,
    log_x: bool | None = None,
    names: tuple[str, ...] = (),
) -> Panel:
    unit = f" [{quantity.unit}]" if quantity.unit else ""
    return Panel(
        title=quantity.label.capitalize(),
        x_label=x_label,
        y_label=f"off by{unit}",
        series=series,
        log_x=not names if log_x is None else log_x,
        log_y=True,
        x_names=names,
    )


def _off(values: Sequence[Number], level: Number) -> Floats:
    """Return magnitudes of differences, NaN where unknown or zero: no place on a log axis."""
    differences = [
        math.nan if value is None or level is None or value == level else abs(value - level)
        for value in values
    ]
    return np.array(differences)
