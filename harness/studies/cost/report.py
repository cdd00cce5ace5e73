"""The report of the study of cost: words, prices to paste, the fairness contract, figures.

The fairness contract is the rules that every price was measured under, published with it.
"""

import math
from collections.abc import Iterable

import numpy as np

from harness.core.report_model import Artefact, Figure, Panel, Prose, Series
from harness.core.simulation import Outcome
from harness.engines.registry import export_settings
from harness.evaluation.case_record import RECORDED
from harness.evaluation.timing import FEWEST
from harness.metrics.convergence import pareto_front
from harness.studies.cost.design import priced
from harness.studies.cost.points import Point
from harness.studies.cost.prices import (
    FIXED,
    FOLLOWING,
    NOISE,
    TARGETS,
    Cost,
    Ladder,
    exponents,
    hard_rows,
)
from harness.studies.cost.tables import growth, hardness, orders, overhead, points, prices


def summary(cost: Cost) -> str:
    """Return what was found, a sentence an engine and a target."""
    plan = cost.plan
    parts = [
        (
            f"{len(cost.points)} runs of {len(plan.engines)} engines on {plan.scene.name}; "
            f"settings tuned on {plan.tuning_scene.name}; costs are processor seconds per "
            "simulated second."
        )
    ]
    for engine in plan.engines:
        for choice in (FIXED, FOLLOWING):
            told = _told(cost, engine, choice)
            if told:
                words = "" if engine == "reference" else f", {choice}"
                parts.append(f"{engine}{words}: {told}.")
            if engine == "reference":
                break
    grown = [
        f"{engine} with {steps} {found.exponent:+.2f}"
        for (engine, steps), found in exponents(cost).items()
    ]
    if grown:
        parts.append(f"One degree costs epsilon to the power of: {', '.join(grown)}.")
    return " ".join(parts)


def _told(cost: Cost, engine: str, choice: str) -> str:
    """Return what each target costs an engine, per simulated second."""
    told = []
    for target in TARGETS:
        price = cost.price(engine, choice, target)
        if price.winners:
            point = price.winners[0].point
            told.append(f"{target:g} degrees for {point.cost:.2g} s ({point.family})")
        elif price.best is not None:
            told.append(f"{target:g} degrees not reached, best is {price.best.error:.2g}")
    return "; ".join(told)


def all_pasted(cost: Cost) -> str:
    """Return the cheapest settings at a fixed step of every engine and target, as paragraphs.

    A model file has one timestep; what follows the motion needs a program, and has a command.
    """
    blocks = []
    for target in TARGETS:
        for engine in cost.plan.engines:
            price = cost.price(engine, FIXED, target)
            if price.winners and price.winners[0].point.timestep is not None:
                text = " ".join(export_settings(price.winners[0].point.case).split())
                blocks.append(f"{engine}, {target:g} degrees: {text}")
    return "\n\n".join(blocks)


def contract(cost: Cost) -> Prose:
    """Return the contract of a study, with its numbers in it."""
    plan, points = cost.plan, cost.points
    versions = ", ".join(
        f"{engine} {next(p.version for p in points if p.case.engine == engine)}"
        for engine in plan.engines
    )
    repeats = [len(p.cpu) for p in points if p.cpu]
    spreads = sorted(p.spread for p in points if len(p.cpu) > 1)
    middle = spreads[len(spreads) // 2] if spreads else 0.0
    waited = sorted(sum(p.wall) / sum(p.cpu) for p in points if p.wall and sum(p.cpu) > 0.0)
    clock = waited[len(waited) // 2] if waited else 1.0
    failed = [p for p in points if p.outcome is not Outcome.FINISHED]
    uncounted = sum(
        p.outcome is Outcome.FINISHED and p.errors.get(plan.target) is None for p in points
    )
    chosen = (
        "; ".join(
            f"{engine}, {'own steps' if choice == FOLLOWING else 'fixed step'}: {name}"
            for (engine, choice), name in cost.tuned.items()
        )
        or "none"
    )
    sizes = ", ".join(f"{len(priced(engine, plan.suite))} of {engine}" for engine in plan.engines)
    lines = (
        (
            f"The scene. Every engine runs {plan.scene.name}: the same can, release and horizon, "
            "checked in the compiled engine before the run."
        ),
        (
            "The ladder. Every fixed-step setting of every engine runs the same timesteps, over "
            "two decades or more; an engine as it ships runs its own timestep as well."
        ),
        (
            f"The settings. {sizes}. Those of an engine as it ships and those tuned have rows of "
            f"their own. Tuned settings were chosen on {plan.tuning_scene.name}, not on the scene "
            f"scored ({chosen}); the timestep is the buyer's. What is best of all on this very "
            "scene is listed apart, since whoever chooses after the race wins it."
        ),
        (
            "Error runs and timing runs are apart. Errors are read in runs that are not timed for "
            "the tables, and may run beside each other; times are taken in runs that nothing is "
            "read from."
        ),
        (
            "Alone. Timing runs go one after the other, in a process with one thread for linear "
            "algebra, under a lock on the machine so that no two studies time at once."
        ),
        (
            "Warm-up. The beginning of each case is run first and not counted. Compiling, parity "
            "and settling are set-up, reported in a column of their own."
        ),
        (
            f"Repeats. Each case is timed {min(repeats, default=FEWEST)} to "
            f"{max(repeats, default=FEWEST)} times; the price is the least processor time over "
            f"simulated time, the median stands beside it. Half of the medians lie within "
            f"{100 * middle:.0f} % of their minimum; by the clock a run took {clock:.2g} times its "
            "processor time, which says how busy the machine was."
        ),
        (
            f"Ties. Costs that differ by less than {100 * NOISE:.0f} % each, or by more where the "
            "two least of its repeats do, are tied and listed together."
        ),
        "No luck. A timestep reaches a target only if all finer ones on its ladder do.",
        (
            "What is paid for. An engine's cost holds its stepping and the harness's reading of "
            "each state, which the overhead row tells apart; the reference's cost is that of the "
            "motion known at any instant. The reference knows this one problem; engines know all. "
            "The truth is its fast integrator, which tests hold to forty digits: its own error "
            "reads zero."
        ),
        (
            f"Failures. {len(failed)} of {len(points)} runs did not reach the horizon and in "
            f"{uncounted} that did the error is not known; they are rows like all others."
        ),
        f"Versions: {versions}. Processor, platform and commit are in the provenance.",
    )
    return Prose(
        name=f"{plan.scene.name}-contract",
        title="Fairness contract",
        text="\n\n".join(lines),
        scene=plan.scene.name,
    )


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


_FALLING = ("turn_deg", "phi_rms_rad", "bounce_time_s")
"""Errors whose order is read: one of the bounce, one of the whole, one of the time."""

_FALLING_WITHOUT = ("rotation_rms_deg", "phi_rms_rad")
"""The same for a scene that has no bounce."""


def cost_report(cost: Cost) -> tuple[Artefact, ...]:
    """Return the artefacts of the study; no price without the contract and the overhead."""
    name = cost.plan.scene.name
    falling = _FALLING if cost.plan.target in _FALLING else _FALLING_WITHOUT
    hard = hardness_figure(cost)
    artefacts: list[Artefact] = [
        Prose(name="summary", title="Summary", text=summary(cost)),
        work_precision(cost),
        contract(cost),
        prices(cost),
        overhead(cost),
        Prose(
            name=f"{name}-paste",
            title="The tuned settings, to paste",
            text=all_pasted(cost) or "No engine reaches a target.",
            scene=name,
        ),
        orders(cost, falling),
    ]
    if hard is not None:
        artefacts += [hard, hardness(cost), growth(cost)]
    artefacts.append(points(cost))
    return tuple(artefacts)
