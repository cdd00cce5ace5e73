"""The study of cost in figures: work against precision, and cost against hardness."""

import math
from collections.abc import Iterable

import numpy as np

from harness.core.report_model import Figure, Panel, Series
from harness.evaluation.case_record import RECORDED
from harness.metrics.convergence import pareto_front
from harness.studies.cost.points import Point
from harness.studies.cost.prices import Cost, Ladder, exponents, hard_rows

AXES = {
    "turn_deg": (1e-8, 1e3),
    "phi_rms_rad": (1e-12, 1.0),
    "phi_max_rad": (1e-12, 1.0),
    "bounce_time_s": (1e-12, 1.0),
    "contact_locus_rms_m": (1e-9, 1e-1),
    "peak_friction_ratio": (1e-10, 1e2),
    "energy_drift": (1e-12, 1e2),
    "rotation_rms_deg": (1e-8, 1e3),
}
"""Ends of the axis of each error of `RECORDED`, the same for all scenes."""

COST_LOW, COST_HIGH = 1e-3, 1e3
"""Processor seconds per simulated second: ends of the axis of costs, the same for all scenes."""

_SHOWN = (
    "phi_rms_rad",
    "bounce_time_s",
    "contact_locus_rms_m",
    "peak_friction_ratio",
    "energy_drift",
)
"""Errors with a panel of their own beside the target's."""


def work_precision(cost: Cost) -> Figure:
    """Return the work-precision diagram: a mark a run, hover shows its setting."""
    target = cost.plan.target
    known = cost.points
    front = pareto_front([p.cost for p in known], [p.error(target) for p in known])
    engines = list(dict.fromkeys(known[place].case.engine for place in front))
    return Figure(
        name=f"{cost.plan.scene.name}-cost",
        title="What accuracy costs",
        seen=(
            "Each mark is a run, a line joins one setting over its ladder of timesteps, and where "
            "it is level, a plateau, more cost brings nothing. On the front, beaten by nothing "
            f"that is lower or further left: {len(front)} runs of {', '.join(engines)}."
        ),
        panels=tuple(_panel(cost, key) for key in (target, *_SHOWN)),
        scene=cost.plan.scene.name,
    )


def _panel(cost: Cost, key: str) -> Panel:
    quantity, (low, high) = RECORDED[key], AXES[key]
    series = []
    for group, ladders in _groups(cost).items():
        x: list[float] = []
        y: list[float] = []
        hover: list[str] = []
        for family, ladder in ladders:
            for point in ladder:
                error = point.error(key)
                seen = math.isfinite(error) and math.isfinite(point.cost)
                x.append(point.cost if seen else math.nan)
                # what is exact to round-off is drawn at the foot
                y.append(max(error, 1.3 * low) if seen else math.nan)
                hover.append(f"{family.name}, {_size(point)}: {point.command}")
            x.append(math.nan)
            y.append(math.nan)
            hover.append("")
        if any(map(math.isfinite, x)):
            series.append(
                Series(
                    label=group,
                    kind=ladders[0][0].engine,
                    x=np.array(x),
                    y=np.array(y),
                    mark="points" if group.endswith(_VARIED) else "both",
                    dashed=group.endswith(_SHIPPED),
                    hover=tuple(hover),
                )
            )
    return Panel(
        title=quantity.label.capitalize(),
        x_label="processor seconds per simulated second",
        y_label=f"error: {quantity.axis}",
        series=tuple(series),
        log_x=True,
        log_y=True,
        x_range=(COST_LOW, COST_HIGH),
        y_range=(low, high),
    )


_VARIED, _SHIPPED = "variants", "as shipped"


def _groups(cost: Cost) -> dict[str, list[Ladder]]:
    """Return the ladders by legend entry: a few for each engine."""
    groups: dict[str, list[Ladder]] = {}
    for family, ladder in cost.ladders:
        profile = family.variant.profile
        if not family.steps:
            name = f"{family.engine}, inexact model" if family.variant.imposes else family.engine
        elif family.variant.settings and profile != "adaptive":
            name = f"{family.engine}, {_VARIED}"
        elif profile == "default":
            name = f"{family.engine}, {_SHIPPED}"
        else:
            name = f"{family.engine}, {profile}"
        groups.setdefault(name, []).append((family, ladder))
    return groups


def _size(point: Point) -> str:
    """Return how fine a run is, in words."""
    if point.timestep is not None:
        return f"{point.timestep:.2g} s"
    return ", ".join(f"{n} {v:g}" for n, v in point.case.options if isinstance(v, float)) or "exact"


def hardness_figure(cost: Cost) -> Figure | None:
    """Return the cost of a degree against epsilon, or None if there is no such ladder."""
    rows = hard_rows(cost)
    if not any(row["cost_s_s"] is not None for row in rows):
        return None
    series = []
    for engine, steps in dict.fromkeys((str(r["engine"]), str(r["steps"])) for r in rows):
        own = [r for r in rows if (r["engine"], r["steps"]) == (engine, steps)]
        series.append(
            Series(
                label=f"{engine}, {steps}",
                kind=engine,
                x=_numbers(r["epsilon"] for r in own),
                y=_numbers(r["cost_s_s"] for r in own),
                mark="both",
                dashed=steps != "fixed step",
                hover=tuple("at most" if r["at_most"] else "one degree" for r in own),
            )
        )
    told = "; ".join(
        f"{engine}, {steps}: {found.exponent:+.2f}"
        for (engine, steps), found in exponents(cost).items()
    )
    return Figure(
        name=f"{cost.plan.scene.name}-hardness",
        title="What one degree costs as the bounce gets harder",
        seen=(
            "From right to left the bounce gets harder, down to the paper's. Exponents of the cost "
            f"against epsilon: {told or 'none'}."
        ),
        panels=(
            Panel(
                title="Cost of one degree",
                x_label="epsilon",
                y_label="processor seconds per simulated second",
                series=tuple(series),
                log_x=True,
                log_y=True,
                x_range=(1e-11, 1e-3),
                y_range=(COST_LOW, COST_HIGH),
            ),
        ),
        columns=1,
        scene=cost.plan.scene.name,
    )


def _numbers(values: Iterable[object]) -> np.ndarray:
    return np.array([math.nan if v is None else float(v) for v in values])  # type: ignore[arg-type]
