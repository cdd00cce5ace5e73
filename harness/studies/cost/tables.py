"""The study of cost in tables: the price list, every point, orders and plateaus, the overhead."""

import math
import statistics
from collections.abc import Iterable, Mapping

import pandas as pd

from harness.core.report_model import Table
from harness.core.verdict import Status, Verdict
from harness.evaluation.case_record import RECORDED
from harness.metrics.convergence import pareto_front
from harness.studies.cost.plateaus import Fall
from harness.studies.cost.points import Point
from harness.studies.cost.prices import TARGETS, Offer, tied
from harness.studies.cost.results import CHOICES, Cost

_PRICES: Mapping[str, str] = {
    "choice": "Where the settings come from: shipped, tuned on another scene, or best on this one.",
    "target_deg": "Error that is asked for, of the angle of turn; of the orientation if no bounce.",
    "engine": "Name of the engine.",
    "verdict": "cheapest: of all engines; tied: with it, within the noise; dearer; or not reached.",
    "settings": "Name of the cheapest settings of this engine.",
    "tied_with": "Other settings of this engine that cost the same within the noise.",
    "timestep_s": "Timestep of the cheapest, s; the largest of an adaptive run.",
    "error_deg": "Error that the setting keeps from here to the finest step.",
    "cost_s_s": "Processor seconds per simulated second, minimum of the repeats.",
    "cost_median_s_s": "The same, median.",
    "relative_cost": "Cost over that of the cheapest of all at this target, reference included.",
    "relative_to_engines": "Cost over that of the cheapest stepping engine at this target.",
    "case": "Digest of the case; its command is in the list of cases.",
    "command": "Runs the case again.",
}

_POINTS: Mapping[str, str] = {
    "engine": "Name of the engine.",
    "settings": "Name of the settings.",
    "profile": "default: as it ships; matched: what the scene declares; adaptive: and own steps.",
    "timestep_s": "Timestep, s; the largest of an adaptive run; none if the solver chooses.",
    "outcome": "How the run ended.",
    **{name: quantity.meaning for name, quantity in RECORDED.items()},
    "cost_s_s": "Processor seconds per simulated second, minimum of the repeats.",
    "cost_median_s_s": "The same, median.",
    "repeats": "How many times it was timed.",
    "clock_over_processor": "Seconds by the clock over processor seconds: above 1 it waited.",
    "setup_s": "Compiling, parity and settling, by the clock; in no cost.",
    "simulated_s": "Length of the run.",
    "steps": "Timesteps taken.",
    "solver_iterations": "Of the solver over the run, from steps at 100 instants; empty: not told.",
    "constraint_rows": "Rows that the solver worked on, summed over the steps.",
    "on_front": "Whether no other point is both cheaper and nearer in the target error.",
    "imposes": "What the settings make of the can that the scene does not declare.",
    "case": "Digest of the case; its command is in the list of cases.",
    "command": "Runs the case again.",
}

_FALLS: Mapping[str, str] = {
    "engine": "Name of the engine.",
    "settings": "Name of the settings.",
    "quantity": "Which error.",
    "order": "Slope of log error, above the plateau, against log timestep; empty: none seen.",
    "confidence": "Half-width of its 95 % interval.",
    "coarsest_s": "Coarsest timestep of the asymptotic range.",
    "finest_s": "Finest timestep of it.",
    "rungs": "Timesteps in it.",
    "plateau": "Error that is left as the timestep goes to zero, in the unit of the quantity.",
    "plateau_below_s": "Timestep below which it outweighs what goes with the timestep.",
    "erratic": "Whether the ladder is flat without following a power of the timestep.",
    "cause": "What the plateau comes from.",
}

_OVERHEAD: Mapping[str, str] = {
    "engine": "Name of the engine.",
    "loop": "Who loops over the steps, and whether states are read.",
    "step_us": "Processor time of a step of one free body without contact, least of the repeats.",
    "step_median_us": "The same, median.",
}


def prices(cost: Cost) -> Table:
    """Return the price list."""
    rows = []
    for choice in CHOICES:
        for target in TARGETS:
            rows += price_rows(cost, choice, target)
    return Table(
        name=f"{cost.plan.scene.name}-prices",
        title="What accuracy costs",
        frame=pd.DataFrame(rows, columns=list(_PRICES)),
        columns=_PRICES,
        shown=tuple(name for name in _PRICES if name not in {"command", "cost_median_s_s"}),
        scene=cost.plan.scene.name,
    )


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
        "cost_s_s": _known(point.cost),
        "cost_median_s_s": _known(point.median),
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


def points(cost: Cost) -> Table:
    """Return every point, failures too."""
    target = cost.plan.target
    known = cost.points
    front = set(pareto_front([p.cost for p in known], [p.error(target) for p in known]))
    return Table(
        name=f"{cost.plan.scene.name}-points",
        title="Every run: what it costs and what it errs",
        frame=pd.DataFrame(
            [_point(p, on_front=place in front) for place, p in enumerate(known)],
            columns=list(_POINTS),
        ),
        columns=_POINTS,
        shown=(
            "engine",
            "settings",
            "timestep_s",
            target,
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
        ),
        scene=cost.plan.scene.name,
    )


def _point(p: Point, *, on_front: bool) -> dict[str, object]:
    return {
        "engine": p.case.engine,
        "settings": p.family,
        "profile": p.case.profile,
        "timestep_s": p.timestep,
        "outcome": p.outcome.value + (f" ({p.note})" if p.note else ""),
        **{name: p.errors.get(name) for name in RECORDED},
        "cost_s_s": _known(p.cost),
        "cost_median_s_s": _known(p.median),
        "repeats": len(p.cpu),
        "clock_over_processor": sum(p.wall) / sum(p.cpu) if p.wall and sum(p.cpu) else None,
        "setup_s": p.setup,
        "simulated_s": p.simulated,
        "steps": p.steps,
        "solver_iterations": p.iterations,
        "constraint_rows": p.rows,
        "on_front": on_front,
        "imposes": p.imposes,
        "case": p.digest,
        "command": p.command,
    }


def orders(cost: Cost, found: tuple[Fall, ...]) -> Table:
    """Return the orders and plateaus."""
    return Table(
        name=f"{cost.plan.scene.name}-orders",
        title="How errors fall with the timestep, and where they stop",
        frame=pd.DataFrame([_fall(fall) for fall in found], columns=list(_FALLS)),
        columns=_FALLS,
        scene=cost.plan.scene.name,
    )


def _fall(fall: Fall) -> dict[str, object]:
    order, level = fall.order, fall.plateau
    return {
        "engine": fall.family.engine,
        "settings": fall.family.name,
        "quantity": fall.quantity,
        "order": order and order.order,
        "confidence": order and order.confidence,
        "coarsest_s": order and order.coarsest,
        "finest_s": order and order.finest,
        "rungs": order and order.points,
        "plateau": level and abs(level.level),
        "plateau_below_s": level and level.timestep,
        "erratic": level and level.erratic,
        "cause": fall.cause,
    }


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
    return Table(
        name=f"{cost.plan.scene.name}-overhead",
        title="Overhead: one free body, no contact",
        frame=pd.DataFrame(rows, columns=list(_OVERHEAD)),
        columns=_OVERHEAD,
        scene=cost.plan.scene.name,
    )


def _known(value: float) -> float | None:
    return value if math.isfinite(value) else None
