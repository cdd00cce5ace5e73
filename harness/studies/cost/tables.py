"""The study of cost in tables: price list, every point, orders and plateaus, the overhead."""

import math
import statistics
from collections.abc import Iterable, Sequence

from harness.core.report_model import Column, Table, table_of
from harness.core.verdict import Status, Verdict
from harness.evaluation.case_record import RECORDED
from harness.metrics.convergence import pareto_front
from harness.metrics.quantities import finite
from harness.studies.cost.plateaus import falls
from harness.studies.cost.points import Point
from harness.studies.cost.prices import CHOICES, TARGETS, Cost, Offer, exponents, hard_rows, tied
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
    plan = cost.plan
    found = {name: cost.price(name, choice, target) for name in plan.engines}
    firsts = {name: price.winners[0] for name, price in found.items() if price.winners}
    least = min((offer.point.cost for offer in firsts.values()), default=math.nan)
    stepping = [o.point.cost for o in firsts.values() if o.point.timestep is not None]
    cheapest = min(firsts.values(), key=lambda offer: offer.point.cost, default=None)
    rows = []
    for name, price in found.items():
        row: dict[str, object] = {"choice": choice, "target_deg": target, "engine": name}
        if price.winners and cheapest is not None:
            first = price.winners[0]
            point = first.point
            row |= _offer(first) | {
                "verdict": Verdict(Status.REACHED, _verdict(cheapest, first, firsts.values())),
                "settings": point.family,
                "tied_with": ", ".join(_named(price.winners)[1:]),
                "relative_cost": point.cost / least,
                "relative_to_engines": None
                if point.timestep is None
                else point.cost / min(stepping),
            }
        elif price.best is not None:
            point = price.best.point
            row |= _offer(price.best) | {
                "verdict": Verdict(
                    Status.NOT_REACHED, f"not reached: best is {price.best.error:.2g} degrees"
                ),
                "settings": point.family,
            }
        elif choice == CHOICES[0] and all(p.timestep is None for p in _of(cost, name)):
            continue  # what chooses its own steps ships with one accuracy
        else:
            row["verdict"] = Verdict(Status.NOT_REACHED, "not reached: no run has this error")
        rows.append(row)
    return rows


def _of(cost: Cost, engine: str) -> list[Point]:
    return [point for point in cost.points if point.case.engine == engine]


def _offer(offer: Offer) -> dict[str, object]:
    point = offer.point
    return {
        "timestep_s": point.timestep,
        "error_deg": offer.error,
        "cost_s_s": finite(point.cost),
        "cost_median_s_s": finite(point.median),
        "case": point.digest,
        "command": point.command,
    }


def _verdict(cheapest: Offer, own: Offer, others: Iterable[Offer]) -> str:
    """Return whether an offer is the cheapest of the engines', or as good as."""
    if own is cheapest:
        return "tied" if any(o is not own and tied(own, o) for o in others) else "cheapest"
    return "tied" if tied(cheapest, own) else "dearer"


def _named(winners: tuple[Offer, ...]) -> list[str]:
    """Return the winners by name, each once; two rungs of one family are told apart."""
    return list(dict.fromkeys(offer.point.family for offer in winners))


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
    return {
        "engine": p.case.engine,
        "settings": p.family,
        "profile": p.case.profile,
        "timestep_s": p.timestep,
        "outcome": p.outcome.value + (f" ({p.note})" if p.note else ""),
        **{name: p.errors.get(name) for name in RECORDED},
        "cost_s_s": finite(p.cost),
        "cost_median_s_s": finite(p.median),
        "repeats": len(p.cpu),
        "clock_over_processor": sum(p.wall) / sum(p.cpu) if p.wall and sum(p.cpu) else None,
        "setup_s": p.setup,
        "simulated_s": p.simulated,
        "steps": p.steps,
        "solver_iterations": p.iterations,
        "constraint_rows": p.rows,
        "imposes": p.imposes,
        "case": p.digest,
        "command": p.command,
    }


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


def hardness(cost: Cost) -> Table:
    """Return the table of costs against hardness."""
    title = "What one degree costs as the bounce gets harder"
    return _table(cost, "degree", title, _HARD, hard_rows(cost))


def growth(cost: Cost) -> Table:
    """Return the table of exponents."""
    rows = [
        {
            "engine": engine,
            "steps": steps,
            "exponent": found.exponent,
            "confidence": finite(found.confidence),  # two points have none
            "points": found.points,
        }
        for (engine, steps), found in exponents(cost).items()
    ]
    return _table(cost, "exponents", "How the cost of a degree grows", _EXPONENTS, rows)
