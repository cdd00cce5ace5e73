"""The study of cost: error runs, then times alone of those that came back; words and figures.

The fairness contract is the rules that every price was measured under, published with it.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from statistics import median_high
from typing import Any

import numpy as np

from harness.core.case import Case
from harness.core.report_model import Artefact, Figure, Panel, Prose, Series
from harness.core.simulation import Outcome
from harness.engines.base import features_of
from harness.engines.registry import engine, export_settings
from harness.evaluation.case_record import LOST, RECORDED
from harness.evaluation.evaluation import Record
from harness.evaluation.timing import FEWEST, aloft, untimed
from harness.studies.cost.design import CostPlan, priced
from harness.studies.cost.points import (
    HARD_MEASURING,
    MEASURING,
    OVERHEAD,
    Point,
    fronts,
)
from harness.studies.cost.prices import (
    COSTS,
    FIXED,
    FOLLOWING,
    NOISE,
    TARGETS,
    Cost,
    Ladder,
    all_pasted,
    cost,
    hardness_figure,
)
from harness.studies.cost.tables import (
    growth,
    hardness,
    orders,
    overhead,
    points,
    prices,
)
from harness.studies.study import TIMING, Job, Results


@dataclass(frozen=True, slots=True, kw_only=True)
class CostStudy:
    """Price every setting of every engine, tuned on another scene than the one scored.

    Parameters
    ----------
    plan : CostPlan
        From `harness.studies.cost.design.plan_cost`.
    targets : tuple of float
        Of the price list that is printed, degrees; a report has all of `TARGETS`.
    """

    plan: CostPlan
    targets: tuple[float, ...] = TARGETS

    @property
    def name(self) -> str:
        """Title of the study."""
        return f"what accuracy costs: {self.plan.scene.name}"

    def next_jobs(self, done: Results) -> list[Job[Case, Record]]:
        """Return the error runs; then the timing of those that came back, and of steps aloft."""
        hard = frozenset(self.plan.hard_cases())
        jobs = [
            Job(HARD_MEASURING if case in hard else MEASURING, case) for case in self.plan.cases()
        ]
        errors = self._errors(done)
        if errors:
            jobs += self._timings(
                c for c in self.plan.timed_cases() if errors[c]["outcome"] not in LOST
            )
        return jobs

    def foreseen(self, done: Results) -> list[Job[Case, Record]]:
        """Return the timings, before they are among the jobs."""
        return [] if self._errors(done) else self._timings(self.plan.timed_cases())

    def _timings(self, cases: Iterable[Case]) -> list[Job[Case, Record]]:
        """Return the jobs that time cases, and steps aloft."""
        return [
            *(Job(TIMING, case) for case in cases),
            *(Job(OVERHEAD, case) for case in self._overhead_cases().values()),
        ]

    def _errors(self, done: Results) -> dict[Case, Record]:
        return done.of(MEASURING) | done.of(HARD_MEASURING)

    def _overhead_cases(self) -> dict[str, Case]:
        """Return by engine the case whose world is stepped aloft, of engines that open one."""
        return {
            name: aloft(self.plan.scene, name)
            for name in self.plan.engines
            if features_of(engine(name)).open is not None
        }

    def findings(self, done: Results) -> Cost:
        """Return every point with its price."""
        times, overheads = done.of(TIMING), done.of(OVERHEAD)
        return cost(
            self.plan,
            self._errors(done),
            {case: times.get(case, untimed(case)) for case in self.plan.timed_cases()},
            {name: overheads[case] for name, case in self._overhead_cases().items()},
        )

    def report(self, done: Results) -> tuple[Artefact, ...]:
        """Return words, the fairness contract, figures and tables."""
        return cost_report(self.findings(done))

    def answer(self, done: Results) -> dict[str, Any]:
        """Return the price list as `--json` prints it."""
        costs = self.findings(done)

        def paste(row: Mapping[Any, Any]) -> str | None:
            price = costs.price(row["engine"], row["choice"], row["target_deg"])
            return export_settings(price.winners[0].point.case) if price.winners else None

        return {
            "scene": self.plan.scene.name,
            "tuned_on": self.plan.tuning_scene.name,
            "tuned": {f"{name}, {choice}": own for (name, choice), own in costs.tuned.items()},
            "prices": [
                row | {"paste": paste(row)}
                for row in prices(costs, self.targets).frame.to_dict("records")
            ],
        }


def summary(cost: Cost) -> str:
    """Return a summary: a sentence for each engine and kind of step."""
    plan = cost.plan
    parts = [
        (
            f"{len(cost.points)} runs of {len(plan.engines)} engines on {plan.scene.name}; "
            f"settings tuned on {plan.tuning_scene.name}; costs are processor seconds per "
            "simulated second."
        )
    ]
    for name in plan.engines:
        steps = {f"{name}, {choice}": choice for choice in (FIXED, FOLLOWING)}
        own = {name: FIXED} if name == "reference" else steps
        by_steps = {label: _target_costs(cost, name, choice) for label, choice in own.items()}
        parts += [f"{label}: {words}." for label, words in by_steps.items() if words]
    grown = [
        f"{row.engine} with {row.steps} {row.exponent:+.2f}"
        for row in growth(cost).frame.itertuples()
    ]
    if grown:
        parts.append(f"One degree costs epsilon to the power of: {', '.join(grown)}.")
    return " ".join(parts)


def _target_costs(cost: Cost, engine: str, choice: str) -> str:
    """Return the cost of each target in an engine, per simulated second, in words."""
    parts = []
    for target in TARGETS:
        price = cost.price(engine, choice, target)
        if price.winners:
            point = price.winners[0].point
            name = point.variant.name
            parts.append(f"{target:g} degrees for {point.cost:.2g} s ({name})")
        elif price.best is not None:
            parts.append(f"{target:g} degrees not reached, best is {price.best.error:.2g}")
    return "; ".join(parts)


def contract(cost: Cost) -> Prose:
    """Return the contract of a study, with its numbers in it."""
    plan, points = cost.plan, cost.points
    versions = ", ".join(
        f"{engine} {next(p.run['version'] for p in points if p.case.engine == engine)}"
        for engine in plan.engines
    )
    repeats = [len(p.times["cpu_s"]) for p in points if p.times["cpu_s"]]
    middle = _middle([p.spread for p in points if len(p.times["cpu_s"]) > 1], 0.0)
    clock = _middle([p.waiting for p in points if p.waiting is not None], 1.0)
    failed = sum(p.outcome is not Outcome.FINISHED for p in points)
    uncounted = sum(p.signed_error(plan.target) is None for p in points) - failed
    chosen = (
        "; ".join(
            f"{engine}, {'own steps' if choice == FOLLOWING else 'fixed step'}: {name}"
            for (engine, choice), name in cost.tuned.items()
        )
        or "none"
    )
    sizes = ", ".join(f"{len(priced(engine, plan.suite))} of {engine}" for engine in plan.engines)
    ties = f"{100 * NOISE:.0f} %"
    text = f"""
        The scene. Every engine runs {plan.scene.name}: the same can, release and horizon, checked
        in the compiled engine before the run.

        The ladder. Every fixed-step setting of every engine runs the same timesteps, over two
        decades or more; an engine as it ships runs its own timestep as well.

        The settings. {sizes}. Those of an engine as it ships and those tuned have rows of their
        own. Tuned settings were chosen on {plan.tuning_scene.name}, not on the scene scored
        ({chosen}); the timestep is the buyer's. What is best of all on this very scene is listed
        apart, since whoever chooses after the race wins it.

        Error runs and timing runs are apart. Errors are read in runs that are not timed for the
        tables, and may run beside each other; times are taken in runs that nothing is read from.

        Alone. Timing runs go one after the other, in a process with one thread for linear algebra,
        under a lock on the machine so that no two studies time at once.

        Warm-up. The beginning of each case is run first and not counted. Compiling, parity and
        settling are set-up, reported in a column of their own.

        Repeats. Each case is timed {min(repeats, default=FEWEST)} to
        {max(repeats, default=FEWEST)} times; the price is the least processor time over simulated
        time, the median stands beside it. Half of the medians lie within {100 * middle:.0f} % of
        their minimum; by the clock a run took {clock:.2g} times its processor time, which says how
        busy the machine was.

        Ties. Costs that differ by less than {ties} each, or by more where the two least of its
        repeats do, are tied and listed together.

        No luck. A timestep reaches a target only if all finer ones on its ladder do.

        What is paid for. An engine's cost holds its stepping and the harness's reading of each
        state, which the overhead row tells apart; the reference's cost is that of the motion known
        at any instant. The reference knows this one problem; engines know all. The truth is its
        fast integrator, which tests hold to forty digits: its own error reads zero.

        Failures. {failed} of {len(points)} runs did not reach the horizon and in {uncounted} that
        did the error is not known; they are rows like all others.

        Versions: {versions}. Processor, platform and commit are in the provenance.
    """
    return Prose(
        name=f"{plan.scene.name}-contract",
        title="Fairness contract",
        text="\n\n".join(" ".join(part.split()) for part in text.split("\n\n")),
        scene=plan.scene.name,
    )


def _middle(values: list[float], default: float) -> float:
    return median_high(values) if values else default


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

_SHOWN = (
    "phi_rms_rad",
    "bounce_time_s",
    "contact_locus_rms_m",
    "peak_friction_ratio",
    "energy_drift",
)
"""Errors that have a panel of their own, in addition to the target's."""


def work_precision(cost: Cost) -> Figure:
    """Return the work-precision diagram: a mark a run, hover shows its setting."""
    target = cost.plan.target
    contacts, constraints = fronts(cost.points, target)
    front = f"{_on_front(contacts)}." + (
        f" Apart from them, as rolling is imposed there: {_on_front(constraints)}."
        if constraints
        else ""
    )
    return Figure(
        name=f"{cost.plan.scene.name}-cost",
        title="What accuracy costs",
        seen=(
            "Each mark is a run, a line joins one setting over its ladder of timesteps, and where "
            "it is level, a plateau, more cost brings nothing. On the front, beaten by nothing "
            f"that is lower or further left: {front}"
        ),
        panels=tuple(_panel(cost, key) for key in (target, *_SHOWN)),
        scene=cost.plan.scene.name,
    )


def _on_front(points: Sequence[Point]) -> str:
    """Return how many runs are on a front, and of which engines."""
    return f"{len(points)} runs of {', '.join(dict.fromkeys(p.case.engine for p in points))}"


def _panel(cost: Cost, key: str) -> Panel:
    quantity, (low, high) = RECORDED[key], AXES[key]
    series = []
    for group, ladders in _groups(cost).items():
        marks: list[tuple[float, float, str]] = []
        for family, ladder in ladders:
            for point in ladder:
                error = point.error(key)
                known = math.isfinite(error) and math.isfinite(point.cost)
                # what is exact to round-off is drawn at the foot
                place = (point.cost, max(error, 1.3 * low)) if known else (math.nan, math.nan)
                marks.append((*place, f"{family.name}, {_size(point)}: {point.run['command']}"))
            marks.append((math.nan, math.nan, ""))  # ends the line
        x, y, hover = zip(*marks, strict=True)
        if any(map(math.isfinite, x)):
            series.append(
                Series(
                    label=group,
                    kind=ladders[0][0].engine,
                    x=np.array(x),
                    y=np.array(y),
                    mark="points" if group.endswith(_VARIED) else "both",
                    dashed=group.endswith(_SHIPPED),
                    hover=hover,
                )
            )
    return Panel(
        title=quantity.label.capitalize(),
        x_label="processor seconds per simulated second",
        y_label=f"error: {quantity.axis}",
        series=tuple(series),
        log_x=True,
        log_y=True,
        x_range=COSTS,
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


_FALLING = ("turn_deg", "phi_rms_rad", "bounce_time_s")
"""Errors whose order is read: one of the bounce, one of the whole, one of the time."""

_FALLING_WITHOUT = ("rotation_rms_deg", "phi_rms_rad")
"""The same for a scene that has no bounce."""


def cost_report(cost: Cost) -> tuple[Artefact, ...]:
    """Return the artefacts of the study; no price without the contract and the overhead."""
    name = cost.plan.scene.name
    falling = _FALLING if cost.plan.target in _FALLING else _FALLING_WITHOUT
    degree, exponents = hardness(cost), growth(cost)
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
    if degree.frame["cost_s_s"].notna().any():
        artefacts += [hardness_figure(degree, exponents), degree, exponents]
    return (*artefacts, points(cost))
