"""How errors fall with the timestep, or with the accuracy of an engine that chooses its own steps.

A figure of every run, and the observed orders.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from itertools import product

import numpy as np

from harness.core.case import RECORDED
from harness.core.report_model import Column, Figure, Panel, Table, table_of
from harness.engines.base import TIMESTEP
from harness.engines.ladder import fineness, finer_by
from harness.evaluation.evaluation import Evaluation
from harness.metrics.convergence import observed_order
from harness.metrics.quantities import QUANTITIES, turn_error
from harness.studies.comparison.selection import MANY, by_case, contacts, curve, digests
from harness.studies.shared import run_columns

_CONVERGING = (
    ("Nutation", "phi, rms [rad]", "phi_rms_rad"),
    ("Angle of turn", "error of the turn [deg]", "angle_of_turn_error_deg"),
)


def convergence(scene: str, evaluations: Sequence[Evaluation]) -> Figure | None:
    """Return errors against the timestep, with every run as a point."""
    known = [e for e in evaluations if e.errors and fineness(e.simulation) is not None]
    ladders = {", ".join(own): runs for own, runs in by_case(known, "engine", "profile").items()}
    of_many = {
        name: ladder
        for name, ladder in ladders.items()
        if len({fineness(e.simulation) for e in ladder}) > 1
    }
    if not of_many:
        return None
    if len(by_case(known, "engine")) > MANY:  # points without a line are in the tables
        ladders = of_many
    panels = []
    finer = {name: finer_by(ladder[0].simulation.case.engine) for name, ladder in ladders.items()}
    kinds = sorted(dict.fromkeys(finer.values()), key=lambda along: along != TIMESTEP)
    for along, (title, y_label, key) in product(kinds, _CONVERGING):
        series = []
        for name in (each for each in ladders if finer[each] == along):
            ladder = ladders[name]
            points = sorted((fineness(e.simulation) or 0.0, abs(_error(e, key))) for e in ladder)
            x, y = np.array(points).T
            series.append(curve(ladder[0], x, np.where(y > 0.0, y, np.nan), "both", name))
        if any(np.isfinite(s.y).any() for s in series):
            panels.append(
                Panel(
                    title=title,
                    x_label="timestep [s]" if along == TIMESTEP else along,
                    y_label=y_label,
                    series=tuple(series),
                    log_x=True,
                    log_y=True,
                )
            )
    return Figure(
        name=f"{scene}-convergence",
        title=f"Errors against the {' and the '.join(kinds)}",
        seen=_falls(ladders),
        panels=tuple(panels),
        columns=2,
        scene=scene,
        cases=digests(evaluations),
    )


def _falls(ladders: Mapping[str, Sequence[Evaluation]]) -> str:
    """Return two sentences: whose error is smallest and largest, and how errors fall."""
    ranked = contacts([e for ladder in ladders.values() for e in ladder])
    every = [(_error(e), name) for name, ladder in ladders.items() for e in ladder if e in ranked]
    (least, best), (most, worst) = min(every), max(every)
    orders: dict[str, list[str]] = {}
    for name, ladder in ladders.items():
        steps = [fineness(e.simulation) or math.nan for e in ladder]
        if len(set(steps)) > 1:
            order = observed_order(steps, [_error(e) for e in ladder]).order
            along = finer_by(ladder[0].simulation.case.engine)
            orders.setdefault(along, []).append(f"{order:.2g} in {name}")
    powers = (
        f"It goes with the {along} to the power of {' and '.join(own)}."
        for along, own in orders.items()
    )
    return (
        f"The error of phi is smallest in {best}, {least:.2g} rad, and largest in {worst}, "
        f"{most:.2g} rad. {' '.join(powers)}"
    )


def _error(e: Evaluation, key: str = "phi_rms_rad") -> float:
    """Return an error of a run; NaN where it has none."""
    error = QUANTITIES[key].of_run(e)
    return math.nan if error is None else error


_ORDERS = (
    run_columns.SCENE,
    run_columns.ENGINE,
    Column("quantity", "Which error."),
    Column(
        "observed_order",
        "Slope of log error against log timestep or accuracy, profile matched.",
        "order.order",
    ),
    Column(
        "spread", "Half the range of the slopes between neighbouring timesteps.", "order.spread"
    ),
    Column("timesteps", "How many timesteps, or accuracies, it rests on.", "order.points"),
    Column("smallest_error", "Error where it is finest, in the quantity's unit."),
    run_columns.LINK,
)

_ROUND_OFF = 1e-12
"""rad or deg: below it an error is the sum of roundings, which has no order."""


def orders(evaluations: Sequence[Evaluation]) -> Table:
    """Return the observed orders of all ladders; the case is the finest run."""
    reads: Mapping[str, Callable[[Evaluation], float | None]] = {
        "phi_rms_rad": QUANTITIES["phi_rms_rad"].of_run,
        "angle_of_turn_deg": turn_error,
    }
    known = [e for e in evaluations if e.errors is not None and fineness(e.simulation)]
    rows: list[dict[str, object]] = []
    for (_, _, profile), ladder in by_case(known, "scene", "engine", "profile").items():
        for quantity, read in reads.items() if profile in {"matched", RECORDED} else ():
            steps = [fineness(e.simulation) or math.nan for e in ladder]
            errors = [math.nan if error is None else error for error in map(read, ladder)]
            order = observed_order(steps, [_weighty(errors, error) for error in errors])
            finest = steps.index(min(steps))
            if order.points > 1:
                rows.append(
                    {
                        "simulation": ladder[finest].simulation,
                        "quantity": quantity,
                        "order": order,
                        "smallest_error": errors[finest],
                    }
                )
    return table_of("orders", "Observed order", _ORDERS, rows)


def _weighty(errors: Sequence[float], error: float) -> float:
    """Return an error that an order can rest on; NaN for round-off and where the sign changes."""
    signs = {math.copysign(1.0, other) for other in errors if math.isfinite(other)}
    return error if len(signs) == 1 and abs(error) > _ROUND_OFF else math.nan
