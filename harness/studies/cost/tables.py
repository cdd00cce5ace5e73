"""The study of cost in tables: price list, every point, orders and plateaus, the overhead.

A ladder of one change to `matched` owes its plateau to that change if the matched ladder lies below
it at the same timestep. That of the engine as it ships is taken apart by its gaps, all at the
finest timestep: the one to blame is the gap that by itself, all others closed, leaves the most.
"""

import statistics
from collections.abc import Iterable, Sequence
from dataclasses import asdict

from harness.core.report_model import Column, Table
from harness.core.simulation import Outcome
from harness.core.verdict import Status, Verdict
from harness.engines.ladder import takes_timestep
from harness.engines.registry import engine, is_constraint
from harness.evaluation.case_record import RECORDED
from harness.metrics.convergence import (
    asymptotic_order,
    plateau,
)
from harness.metrics.quantities import finite
from harness.studies.cost.design import gap_cases
from harness.studies.cost.points import Family, Point, fronts, hard_command
from harness.studies.cost.prices import (
    CHOICES,
    FIXED,
    SHIPPED,
    TARGETS,
    Cost,
    Offer,
    cost_of,
    exponent,
    offers,
    tied,
)
from harness.studies.shared import run_columns
from harness.studies.shared.ablation import AblationPath

_SETTINGS = Column("settings", "Name of the settings.")
_CASE = Column("case", "Digest of the case; its command is in the list of cases.")
_COST = Column("cost_s_s", "Processor seconds per simulated second, minimum of the repeats.")
_MEDIAN = Column("cost_median_s_s", "The same, median.")
_STEPS = Column("steps", "Fixed, or following the motion.")

_PRICES = (
    Column("choice", "Where settings come from: shipped, tuned on another scene, or best here."),
    Column("target_deg", "Error asked for, of the turn; of the orientation if no bounce."),
    run_columns.ENGINE,
    Column(
        "verdict",
        "cheapest: of contacts, or of constraints; tied: with it, within the noise; dearer; "
        "not reached.",
    ),
    Column("settings", "Name of the cheapest settings of this engine."),
    Column("tied_with", "Other settings of this engine that cost the same within the noise."),
    Column("timestep_s", "Timestep of the cheapest, s; the largest of an adaptive run."),
    Column("error_deg", "Error that the setting keeps from here to the finest step."),
    _COST,
    _MEDIAN,
    Column("relative_cost", "Cost over that of the cheapest at this target, reference included."),
    Column("relative_to_engines", "Cost over that of the cheapest stepping engine at this target."),
    _CASE,
    run_columns.COMMAND,
)


def prices(cost: Cost, targets: Sequence[float] = TARGETS) -> Table:
    """Return the price list of targets in degrees."""
    rows = (
        row for choice in CHOICES for target in targets for row in price_rows(cost, choice, target)
    )
    hidden = ("command", "cost_median_s_s")
    return run_columns.scene_table(
        cost.plan.scene.name, "prices", "What accuracy costs", _PRICES, rows, *hidden
    )


def price_rows(cost: Cost, choice: str, target: float) -> list[dict[str, object]]:
    """Return the rows of the price list for one target, an engine each.

    Contacts are the cheapest of contacts, and constraints, which solve another problem, of theirs.
    """
    return [
        row
        for apart in (False, True)
        for row in _ranked(
            cost, choice, target, [n for n in cost.plan.engines if is_constraint(n) is apart]
        )
    ]


def _ranked(
    cost: Cost, choice: str, target: float, engines: Sequence[str]
) -> list[dict[str, object]]:
    """Return the rows of engines that are ranked with each other."""
    entries = {name: cost.price(name, choice, target) for name in engines}
    firsts = [entry.winners[0] for entry in entries.values() if entry.winners]
    cheapest = min(firsts, key=lambda offer: offer.point.cost, default=None)
    stepping = [o.point.cost for o in firsts if o.point.rung is not None]
    rows = []
    for name, entry in entries.items():
        offer = entry.winners[0] if entry.winners else entry.best
        own = [p for p in cost.points if p.case.engine == name]
        if offer is None and choice == SHIPPED and all(p.rung is None for p in own):
            continue  # what chooses its own steps ships with one accuracy
        if choice == FIXED and not takes_timestep(name):
            continue
        words = "no run has this error" if offer is None else f"best is {offer.error:.2g} degrees"
        row: dict[str, object] = {
            "choice": choice,
            "target_deg": target,
            "engine": name,
            "verdict": Verdict(Status.NOT_REACHED, f"not reached: {words}"),
        }
        if offer is not None:
            row |= _cells(offer.point) | {"error_deg": offer.error}
        if offer is not None and entry.winners and cheapest is not None:
            names = dict.fromkeys(winner.point.variant.name for winner in entry.winners)
            row |= {
                "verdict": Verdict(Status.REACHED, _verdict(cheapest, offer, firsts)),
                "tied_with": ", ".join([*names][1:]),
                "relative_cost": offer.point.cost / cheapest.point.cost,
                "relative_to_engines": None
                if offer.point.rung is None
                else offer.point.cost / min(stepping),
            }
        rows.append(row)
    return rows


def _cells(point: Point) -> dict[str, object]:
    """Return the cells that the price list and the list of all points share."""
    return {
        "settings": point.variant.name,
        "timestep_s": point.timestep,
        "cost_s_s": finite(point.cost),
        "cost_median_s_s": finite(point.median),
        "case": point.digest,
        "command": point.run["command"],
    }


def _verdict(cheapest: Offer, own: Offer, others: Iterable[Offer]) -> str:
    """Return whether an offer is the cheapest of the engines', or as good as."""
    if own is cheapest:
        return "tied" if any(o is not own and tied(own, o) for o in others) else "cheapest"
    return "tied" if tied(cheapest, own) else "dearer"


_POINTS = (
    run_columns.ENGINE,
    _SETTINGS,
    run_columns.PROFILE,
    Column("timestep_s", "Timestep, s; the largest of an adaptive run; none if solver's choice."),
    run_columns.OUTCOME,
    *(Column(key, quantity.meaning) for key, quantity in RECORDED.items()),
    _COST,
    _MEDIAN,
    Column("repeats", "How many times it was timed."),
    Column(
        "clock_over_processor", "Seconds by the clock over processor seconds: above 1 it waited."
    ),
    Column(
        "compile_s",
        "Of an engine that compiles itself, in the first run of a process, by the clock; in no "
        "cost.",
    ),
    Column("setup_s", "Compiling the model, parity and settling, by the clock; in no cost."),
    Column("simulated_s", "Length of the run."),
    Column("steps", "Timesteps taken."),
    Column("solver_iterations", "Of the solver over the run, from 100 instants; empty: not told."),
    Column("constraint_rows", "Rows that the solver worked on, summed over the steps."),
    Column(
        "on_front",
        "Whether no other point of a contact, or of a constraint, is both cheaper and nearer.",
    ),
    Column("imposes", "What the settings make of the can that the scene does not declare."),
    _CASE,
    run_columns.COMMAND,
)

_HIDDEN = ("profile", "repeats", "clock_over_processor", "simulated_s", "imposes")
"""Columns of the points that the page does not show, in addition to most errors."""


def points(cost: Cost) -> Table:
    """Return every point, failures too."""
    target, known = cost.plan.target, cost.points
    front = {p.case for own in fronts(known, target) for p in own}
    hidden = (*_HIDDEN, *(key for key in RECORDED if key not in {"phi_rms_rad", target}))
    title = "Every run: what it costs and what it errs"
    rows = (
        p.run["errors"]
        | p.run
        | _cells(p)
        | {
            "engine": p.case.engine,
            "profile": p.case.profile,
            "outcome": p.outcome.value + (f" ({p.run['note']})" if p.run["note"] else ""),
            "repeats": len(p.times["cpu_s"]),
            "clock_over_processor": p.waiting,
            "setup_s": p.times["setup_s"],
            "on_front": p.case in front,
            "imposes": p.variant.imposes,
        }
        for p in known
    )
    return run_columns.scene_table(cost.plan.scene.name, "points", title, _POINTS, rows, *hidden)


_FALLS = (
    run_columns.ENGINE.of("family.engine"),
    _SETTINGS.of("family.name"),
    Column("quantity", "Which error."),
    Column("order", "Slope of log error above the plateau against log timestep.", "fit.order"),
    Column("confidence", "Half-width of its 95 % interval.", "fit.confidence"),
    Column("coarsest_s", "Coarsest timestep of the asymptotic range.", "fit.coarsest"),
    Column("finest_s", "Finest timestep of it.", "fit.finest"),
    Column("rungs", "Timesteps in it.", "fit.points"),
    Column(
        "plateau",
        "Error that is left as the timestep goes to zero, in the unit of the quantity.",
        lambda row: row["level"] and abs(row["level"].level),
    ),
    Column(
        "plateau_below_s",
        "Timestep, or accuracy, below which it outweighs the rest.",
        "level.timestep",
    ),
    Column("erratic", "Whether the ladder is flat, but follows no power.", "level.erratic"),
    Column("cause", "What the plateau comes from."),
)


def orders(cost: Cost, quantities: Sequence[str]) -> Table:
    """Return the order and the plateau of each ladder of timesteps or accuracies."""
    rows = []
    for family, ladder in cost.ladders:
        for quantity in quantities if family.steps else ():
            steps = [point.rung or 0.0 for point in ladder]
            errors = [point.signed_error(quantity) for point in ladder]
            level = plateau(steps, errors)
            size = 0.0 if level is None else level.level
            rows.append(
                {
                    "family": family,
                    "quantity": quantity,
                    "fit": asymptotic_order(steps, errors, size),
                    "level": level,
                    "cause": _cause(cost, family, quantity, abs(size)) if level else "",
                }
            )
    title = "How errors fall with the timestep, and where they stop"
    return run_columns.scene_table(cost.plan.scene.name, "orders", title, _FALLS, rows)


_MOST = 0.5
"""Share of a plateau from which one gap alone is said to make it."""


def _cause(cost: Cost, family: Family, quantity: str, level: float) -> str:
    """Return the cause of a plateau, in a sentence."""
    path = next((path for path in cost.plan.paths if path.engine == family.engine), None)
    if family.variant.profile == "default" and not family.variant.settings and path is not None:
        return _from_gaps(path, cost, quantity, level)
    matched = [
        point.error(quantity)
        for other, ladder in cost.ladders
        if other.engine == family.engine and other.name == "matched"
        for point in ladder
    ]
    if family.variant.settings and min(matched, default=0.0) < _MOST * level:
        imposed = family.variant.imposes or "no effect of its own, but less than the solver needs"
        return f"{family.name}: {imposed}."
    effects = engine(family.engine).capabilities.imposes.items()
    imposed = "; ".join(f"{name} ({sentence})" for name, sentence in effects)
    return f"Shared with matched: {imposed or 'nothing that the engine declares'}."


def _from_gaps(path: AblationPath, cost: Cost, quantity: str, level: float) -> str:
    """Return which gap makes the plateau of an engine as it ships."""
    sizes = {
        gap: abs(run["errors"][quantity])
        for gap, case in gap_cases(path).items()
        if (run := cost.runs[case])["outcome"] == Outcome.FINISHED.name
        if run["errors"].get(quantity) is not None
    }
    if not sizes:
        return "Not known: no run with the other gaps closed has this number."
    ranked = sorted(sizes, key=sizes.__getitem__, reverse=True)
    first = ranked[0]
    if sizes[first] >= _MOST * level:
        sentence = next(gap.sentence for gap in path.gaps if gap.name == first)
        return f"{first}: alone it leaves {sizes[first]:.2g}. {sentence}"
    largest = ", ".join(f"{name} ({sizes[name]:.2g} alone)" for name in ranked[:2])
    return f"Several together; the largest are {largest}."


_OVERHEAD = (
    run_columns.ENGINE,
    Column("loop", "Who loops over the steps, and whether states are read."),
    Column("step_us", "Processor time of a step of one free body aloft, least of the repeats."),
    Column("step_median_us", "The same, median."),
)


def overhead(cost: Cost) -> Table:
    """Return the table of the cost of a step without anything to solve."""
    rows = [
        {
            "engine": engine,
            "loop": way,
            "step_us": 1e6 * min(taken),
            "step_median_us": 1e6 * statistics.median(taken),
        }
        for engine, record in cost.overheads.items()
        for way, taken in record["ways"].items()
    ]
    return run_columns.scene_table(
        cost.plan.scene.name, "overhead", "Overhead: one free body, no contact", _OVERHEAD, rows
    )


_HARD = (
    run_columns.ENGINE,
    _STEPS,
    Column("epsilon", "B_{-2}^2 (a_p + 1) of the exact motion: 1.4e-10 at the paper's release."),
    Column("cost_s_s", "Processor seconds per simulated second for one degree, between rungs."),
    Column("at_most", "Whether no coarser step has an error, so that it costs this or less."),
    Column("case", "Digest of the finer of the two cases; its command is in the list of cases."),
    Column("command", "Runs it again, in the folder given as --out."),
)

_EXPONENTS = (
    run_columns.ENGINE,
    _STEPS,
    Column("exponent", "Of the cost of one degree against epsilon: -1/2 doubles it for a quarter."),
    Column("confidence", "Half-width of its 95 % interval; empty for two points."),
    Column("points", "Hardnesses that it comes from; bounds count where there are not two others."),
)


_ONE_DEGREE = 1.0


def hardness(cost: Cost) -> Table:
    """Return the table of the cost of a degree at each hardness."""
    rows = []
    for hard, ladders in cost.hardness:
        for family, ladder in ladders:
            sold = offers(ladder, "turn_deg", steps=True)
            degree, at_most = cost_of(sold, _ONE_DEGREE) or (None, None)
            within = [offer.point for offer in sold if offer.error <= _ONE_DEGREE]
            point = ladder[-1] if degree is None else within[0]
            rows.append(
                {
                    "engine": family.engine,
                    "steps": family.name,
                    "epsilon": hard.epsilon,
                    "cost_s_s": degree,
                    "at_most": at_most,
                    "case": point.digest,
                    "command": hard_command(point.case),
                }
            )
    title = "What one degree costs as the bounce gets harder"
    return run_columns.scene_table(cost.plan.scene.name, "degree", title, _HARD, rows)


def growth(cost: Cost) -> Table:
    """Return the exponents of the cost of a degree, by engine and kind of step.

    Costs that are but bounds count where there are not two others.
    """
    rows = []
    frame = hardness(cost).frame
    known = frame[frame["cost_s_s"].notna()]
    for (name, steps), own in known.groupby(["engine", "steps"], sort=False):
        sure = own[~own["at_most"].astype(bool)]
        used = sure if len(sure) > 1 else own
        fit = exponent([*used["epsilon"]], [*used["cost_s_s"]])
        if fit is not None:
            row = {"engine": name, "steps": steps, **asdict(fit)}
            rows.append(row | {"confidence": finite(fit.confidence)})  # two points have none
    return run_columns.scene_table(
        cost.plan.scene.name, "exponents", "How the cost of a degree grows", _EXPONENTS, rows
    )
