"""The study of cost in tables: price list, every point, orders and plateaus, the overhead.

A ladder of one change to `matched` owes its plateau to that change if the matched ladder lies below
it at the same timestep. That of the engine as it ships is taken apart by its gaps, all at the
finest timestep: the one to blame is the gap that by itself, all others closed, leaves the most.
"""

import statistics
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass

from harness.core.report_model import Column, Table, table_of
from harness.core.simulation import Outcome
from harness.core.verdict import Status, Verdict
from harness.engines.registry import engine
from harness.evaluation.case_record import RECORDED
from harness.metrics.convergence import (
    AsymptoticOrder,
    Plateau,
    asymptotic_order,
    pareto_front,
    plateau,
)
from harness.metrics.quantities import finite
from harness.studies.cost.design import gap_cases
from harness.studies.cost.points import Family, Point, hard_command
from harness.studies.cost.prices import (
    CHOICES,
    SHIPPED,
    TARGETS,
    Cost,
    Offer,
    cost_of,
    exponent,
    offers,
    tied,
)
from harness.studies.shared.ablation import AblationPath
from harness.studies.shared.run_columns import COMMAND, ENGINE, OUTCOME, without

_SETTINGS = Column("settings", "Name of the settings.")
_CASE = Column("case", "Digest of the case; its command is in the list of cases.")
_COST = Column("cost_s_s", "Processor seconds per simulated second, minimum of the repeats.")
_MEDIAN = Column("cost_median_s_s", "The same, median.")
_STEPS = Column("steps", "Fixed, or following the motion.")

_PRICES = (
    Column("choice", "Where settings come from: shipped, tuned on another scene, or best here."),
    Column("target_deg", "Error asked for, of the turn; of the orientation if no bounce."),
    ENGINE,
    Column("verdict", "cheapest: of all; tied: with it, within the noise; dearer; not reached."),
    Column("settings", "Name of the cheapest settings of this engine."),
    Column("tied_with", "Other settings of this engine that cost the same within the noise."),
    Column("timestep_s", "Timestep of the cheapest, s; the largest of an adaptive run."),
    Column("error_deg", "Error that the setting keeps from here to the finest step."),
    _COST,
    _MEDIAN,
    Column("relative_cost", "Cost over that of the cheapest at this target, reference included."),
    Column("relative_to_engines", "Cost over that of the cheapest stepping engine at this target."),
    _CASE,
    COMMAND,
)


def prices(cost: Cost) -> Table:
    """Return the price list."""
    rows = [
        row for choice in CHOICES for target in TARGETS for row in price_rows(cost, choice, target)
    ]
    columns = without(_PRICES, "command", "cost_median_s_s")
    return _table(cost, "prices", "What accuracy costs", columns, rows)


def _table(
    cost: Cost, name: str, title: str, columns: Sequence[Column], rows: Iterable[object]
) -> Table:
    scene = cost.plan.scene.name
    return table_of(f"{scene}-{name}", title, columns, rows, scene=scene)


def price_rows(cost: Cost, choice: str, target: float) -> list[dict[str, object]]:
    """Return the rows of the price list for one target, an engine each."""
    entries = {name: cost.price(name, choice, target) for name in cost.plan.engines}
    firsts = [entry.winners[0] for entry in entries.values() if entry.winners]
    cheapest = min(firsts, key=lambda offer: offer.point.cost, default=None)
    stepping = [o.point.cost for o in firsts if o.point.timestep is not None]
    rows = []
    for name, entry in entries.items():
        row: dict[str, object] = {"choice": choice, "target_deg": target, "engine": name}
        offer = entry.winners[0] if entry.winners else entry.best
        if offer is not None:
            point = offer.point
            row |= {
                "settings": point.variant.name,
                "timestep_s": point.timestep,
                "error_deg": offer.error,
                "cost_s_s": finite(point.cost),
                "cost_median_s_s": finite(point.median),
                "case": point.digest,
                "command": point.run["command"],
            }
        if offer is not None and entry.winners and cheapest is not None:
            names = dict.fromkeys(winner.point.variant.name for winner in entry.winners)
            row |= {
                "verdict": Verdict(Status.REACHED, _verdict(cheapest, offer, firsts)),
                "tied_with": ", ".join([*names][1:]),
                "relative_cost": offer.point.cost / cheapest.point.cost,
                "relative_to_engines": None
                if offer.point.timestep is None
                else offer.point.cost / min(stepping),
            }
        elif offer is not None:
            words = f"not reached: best is {offer.error:.2g} degrees"
            row["verdict"] = Verdict(Status.NOT_REACHED, words)
        elif choice == SHIPPED and all(
            p.timestep is None for p in cost.points if p.case.engine == name
        ):
            continue  # what chooses its own steps ships with one accuracy
        else:
            row["verdict"] = Verdict(Status.NOT_REACHED, "not reached: no run has this error")
        rows.append(row)
    return rows


def _verdict(cheapest: Offer, own: Offer, others: Iterable[Offer]) -> str:
    """Return whether an offer is the cheapest of the engines', or as good as."""
    if own is cheapest:
        return "tied" if any(o is not own and tied(own, o) for o in others) else "cheapest"
    return "tied" if tied(cheapest, own) else "dearer"


_POINTS = (
    ENGINE,
    _SETTINGS,
    Column("profile", "default: as it ships; matched: as the scene declares; adaptive: own steps."),
    Column("timestep_s", "Timestep, s; the largest of an adaptive run; none if solver's choice."),
    OUTCOME,
    *(Column(key, quantity.meaning) for key, quantity in RECORDED.items()),
    _COST,
    _MEDIAN,
    Column("repeats", "How many times it was timed."),
    Column(
        "clock_over_processor", "Seconds by the clock over processor seconds: above 1 it waited."
    ),
    Column("setup_s", "Compiling, parity and settling, by the clock; in no cost."),
    Column("simulated_s", "Length of the run."),
    Column("steps", "Timesteps taken."),
    Column("solver_iterations", "Of the solver over the run, from 100 instants; empty: not told."),
    Column("constraint_rows", "Rows that the solver worked on, summed over the steps."),
    Column("on_front", "Whether no other point is both cheaper and nearer in the target error."),
    Column("imposes", "What the settings make of the can that the scene does not declare."),
    _CASE,
    COMMAND,
)

_POINTS_SHOWN = (
    "engine",
    "settings",
    "timestep_s",
    "phi_rms_rad",
    "cost_s_s",
    "cost_median_s_s",
    "setup_s",
    "steps",
    "solver_iterations",
    "constraint_rows",
    "on_front",
    "outcome",
    "case",
    "command",
)


def points(cost: Cost) -> Table:
    """Return every point, failures too."""
    target, known = cost.plan.target, cost.points
    front = set(pareto_front([p.cost for p in known], [p.error(target) for p in known]))
    hidden = [c.name for c in _POINTS if c.name not in {*_POINTS_SHOWN, target}]
    rows = [_point(p) | {"on_front": place in front} for place, p in enumerate(known)]
    title = "Every run: what it costs and what it errs"
    return _table(cost, "points", title, without(_POINTS, *hidden), rows)


def _point(p: Point) -> dict[str, object]:
    errors: dict[str, object] = p.run["errors"]
    return (
        errors
        | p.run
        | {
            "engine": p.case.engine,
            "settings": p.variant.name,
            "profile": p.case.profile,
            "outcome": p.outcome.value + (f" ({p.run['note']})" if p.run["note"] else ""),
            "cost_s_s": finite(p.cost),
            "cost_median_s_s": finite(p.median),
            "repeats": len(p.times["cpu_s"]),
            "clock_over_processor": p.waiting,
            "setup_s": p.times["setup_s"],
            "imposes": p.variant.imposes,
            "case": p.digest,
        }
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Fall:
    """How the error of a ladder falls, and where it stops.

    Parameters
    ----------
    family : Family
    quantity : str
    order : AsymptoticOrder or None
    plateau : Plateau or None
    cause : str
        A sentence; empty without a plateau.
    """

    family: Family
    quantity: str
    order: AsymptoticOrder | None
    plateau: Plateau | None
    cause: str


_FALLS = (
    Column("engine", ENGINE.meaning, "family.engine"),
    Column("settings", _SETTINGS.meaning, "family.name"),
    Column("quantity", "Which error."),
    Column("order", "Slope of log error above the plateau against log timestep.", "order.order"),
    Column("confidence", "Half-width of its 95 % interval.", "order.confidence"),
    Column("coarsest_s", "Coarsest timestep of the asymptotic range.", "order.coarsest"),
    Column("finest_s", "Finest timestep of it.", "order.finest"),
    Column("rungs", "Timesteps in it.", "order.points"),
    Column(
        "plateau",
        "Error that is left as the timestep goes to zero, in the unit of the quantity.",
        lambda fall: fall.plateau and abs(fall.plateau.level),
    ),
    Column("plateau_below_s", "Timestep below which it outweighs the rest.", "plateau.timestep"),
    Column("erratic", "Whether the ladder is flat, but follows no power.", "plateau.erratic"),
    Column("cause", "What the plateau comes from."),
)


def orders(cost: Cost, quantities: Sequence[str]) -> Table:
    """Return the orders and plateaus."""
    title = "How errors fall with the timestep, and where they stop"
    return _table(cost, "orders", title, _FALLS, falls(cost, quantities))


def falls(cost: Cost, quantities: Sequence[str]) -> list[Fall]:
    """Return how each ladder of timesteps falls, in each quantity."""
    found = []
    for family, ladder in cost.ladders:
        for quantity in quantities if family.steps else ():
            steps = [point.timestep or 0.0 for point in ladder]
            errors = [point.signed_error(quantity) for point in ladder]
            level = plateau(steps, errors)
            found.append(
                Fall(
                    family=family,
                    quantity=quantity,
                    order=asymptotic_order(steps, errors, 0.0 if level is None else level.level),
                    plateau=level,
                    cause="" if level is None else _cause(cost, family, quantity, abs(level.level)),
                )
            )
    return found


_MOST = 0.5
"""Share of a plateau from which one gap alone is said to make it."""


def _cause(cost: Cost, family: Family, quantity: str, level: float) -> str:
    """Return what a plateau comes from, in a sentence."""
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
    told = ", ".join(f"{name} ({sizes[name]:.2g} alone)" for name in ranked[:2])
    return f"Several together; the largest are {told}."


_OVERHEAD = (
    ENGINE,
    Column("loop", "Who loops over the steps, and whether states are read."),
    Column("step_us", "Processor time of a step of one free body aloft, least of the repeats."),
    Column("step_median_us", "The same, median."),
)


def overhead(cost: Cost) -> Table:
    """Return what a step costs without anything to solve."""
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
    return _table(cost, "overhead", "Overhead: one free body, no contact", _OVERHEAD, rows)


_HARD = (
    ENGINE,
    _STEPS,
    Column("epsilon", "B_{-2}^2 (a_p + 1) of the exact motion: 1.4e-10 at the paper's release."),
    Column("cost_s_s", "Processor seconds per simulated second for one degree, between rungs."),
    Column("at_most", "Whether no coarser step has an error, so that it costs this or less."),
    Column("case", "Digest of the finer of the two cases; its command is in the list of cases."),
    Column("command", "Runs it again, in the folder given as --out."),
)

_EXPONENTS = (
    ENGINE,
    _STEPS,
    Column("exponent", "Of the cost of one degree against epsilon: -1/2 doubles it for a quarter."),
    Column("confidence", "Half-width of its 95 % interval; empty for two points."),
    Column("points", "Hardnesses that it comes from; bounds count where there are not two others."),
)


_ONE_DEGREE = 1.0


def hardness(cost: Cost) -> Table:
    """Return what a degree costs at each hardness."""
    rows = []
    for hard, ladders in cost.hardness:
        for family, ladder in ladders:
            sold = offers(ladder, "turn_deg", steps=True)
            degree, at_most = cost_of(sold, _ONE_DEGREE) or (None, None)
            within = [offer.point for offer in sold if offer.error <= _ONE_DEGREE]
            told = ladder[-1] if degree is None else within[0]
            rows.append(
                {
                    "engine": family.engine,
                    "steps": family.name,
                    "epsilon": hard.epsilon,
                    "cost_s_s": degree,
                    "at_most": at_most,
                    "case": told.digest,
                    "command": hard_command(told.case),
                }
            )
    title = "What one degree costs as the bounce gets harder"
    return _table(cost, "degree", title, _HARD, rows)


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
        found = exponent([*used["epsilon"]], [*used["cost_s_s"]])
        if found is not None:
            row = {"engine": name, "steps": steps, **asdict(found)}
            rows.append(row | {"confidence": finite(found.confidence)})  # two points have none
    return _table(cost, "exponents", "How the cost of a degree grows", _EXPONENTS, rows)
