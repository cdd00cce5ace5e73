"""The tables of the comparison: scorecard, all cases, bounces, model parity, observed orders."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict

from harness.core.report_model import Column, Table, table_of
from harness.evaluation.evaluation import Evaluation
from harness.metrics.convergence import observed_order
from harness.metrics.quantities import QUANTITIES, turn_error
from harness.studies.comparison.fidelity import excess, scorecard_verdict, undecided
from harness.studies.comparison.selection import by_case
from harness.studies.comparison.suite import Unsupported
from harness.studies.shared import run_columns

_SCORECARD = (
    run_columns.SCENE,
    run_columns.ENGINE,
    Column(
        "shipped_verdict",
        "As it ships: agrees, deviates, failed, unsupported, or not decidable.",
    ),
    Column("shipped_turn_error_deg", "First angle of turn, engine minus truth, as it ships."),
    Column("shipped_phi_rms_rad", "Root mean square error of phi, as it ships."),
    Column("best_verdict", "The same at the best that was run."),
    Column("best_turn_error_deg", "First angle of turn, engine minus truth, of the best run."),
    Column("best_phi_rms_rad", "Root mean square error of phi of the best run."),
    Column("best_run", "Profile and timestep of the best run."),
    Column("case", "Digest of the best run; its command is in the list of cases.", "best.digest"),
)


def scorecard(evaluations: Sequence[Evaluation], unsupported: Sequence[Unsupported] = ()) -> Table:
    """Return the scorecard of the comparison: a row a scene and engine, as it ships and at best."""
    rows = []
    for (scene, engine), own in by_case(evaluations, "scene", "engine").items():
        shipped = next((e for e in own if e.simulation.case.profile == "default"), None)
        tuned = [e for e in own if e.simulation.case.profile != "default"]
        best = min(tuned, key=_badness, default=None)
        row: dict[str, object] = {"scene": scene, "engine": engine}
        for prefix, e in (("shipped", shipped), ("best", best)):
            if e is not None:
                row |= {
                    f"{prefix}_verdict": scorecard_verdict(e),
                    f"{prefix}_phi_rms_rad": QUANTITIES["phi_rms_rad"].of_run(e),
                    f"{prefix}_turn_error_deg": turn_error(e),
                }
        if best is not None:
            run = best.simulation
            row |= {"best": run, "best_run": f"{run.case.profile}, {run.timestep:.2g} s"}
        rows.append(row)
    rows += [
        {
            "scene": case.scene,
            "engine": case.engine,
            "shipped_verdict": case.verdict,
            "best_verdict": case.verdict,
        }
        for case in unsupported
    ]
    return table_of("scorecard", "As it ships, and at its best", _SCORECARD, rows)


def _badness(e: Evaluation) -> tuple[bool, float, float]:
    """Return the rank of a run, least for the best: a chaotic scene is to be followed longest."""
    return undecided(e) is not None, excess(e), -(math.inf if e.parts_at is None else e.parts_at)


_RESULTS = (
    *run_columns.RUN,
    run_columns.OUTCOME.of("simulation.ending"),
    run_columns.quantity_column("angle_of_turn_deg"),
    run_columns.quantity_column("angle_of_turn_error_deg"),
    Column(
        "turn_resolved",
        "Whether the record is dense enough to count the turns of psi.",
        lambda e: e.bounces[0].resolved if e.bounces else None,
    ),
    run_columns.quantity_column("bounce_time_error_s"),
    run_columns.quantity_column("phi_min_rad", shown=False),
    run_columns.quantity_column("peak_friction_ratio", shown=False),
    run_columns.quantity_column("peak_friction_ratio_error"),
    run_columns.quantity_column("phi_rms_rad"),
    run_columns.quantity_column("phi_rms_before_rad", shown=False),
    run_columns.quantity_column("phi_rms_after_rad", shown=False),
    run_columns.quantity_column("phi_max_rad", shown=False),
    run_columns.quantity_column("rotation_rms_rad", shown=False),
    run_columns.quantity_column("psi_rms_rad", shown=False),
    run_columns.quantity_column("theta_rms_rad", shown=False),
    run_columns.quantity_column("contact_locus_rms_m"),
    run_columns.quantity_column("contact_locus_hausdorff_m", shown=False),
    Column(
        "parts_at_s",
        "When the orientation is first 0.1 rad from the truth's; empty if it never is.",
        "parts_at",
    ),
    run_columns.quantity_column("energy_drift"),
    run_columns.quantity_column("max_penetration_m"),
    run_columns.quantity_column("max_slip_m_s"),
    run_columns.quantity_column("lift_off_fraction", shown=False),
    run_columns.quantity_column("multi_contact_fraction", shown=False),
    Column(
        "static_penetration_m",
        "Depth at which the can was released.",
        "simulation.static_penetration",
    ),
    Column("simulated_s", "Length of the run.", lambda e: e.motion and float(e.motion.time[-1])),
    run_columns.quantity_column("steps"),
    run_columns.quantity_column("constraint_rows", shown=False),
    run_columns.quantity_column("setup_s", shown=False),
    run_columns.quantity_column("wall_s"),
    run_columns.quantity_column("cpu_s", shown=False),
    Column(
        "truth_pulls", "Whether the exact motion asks the plane to pull, which no engine's can."
    ),
    Column("digest", "Names the case in this version of its engine.", "simulation.digest"),
    run_columns.COMMAND,
)


def results(evaluations: Sequence[Evaluation]) -> Table:
    """Return the table of all cases, with everything that was measured of them."""
    hidden = ("turn_resolved", "parts_at_s", "static_penetration_m", "simulated_s", "truth_pulls")
    columns = run_columns.without(_RESULTS, *hidden, "digest", "command")
    return table_of("results", "All cases", columns, evaluations)


_OF_A_RUN = (
    "angle_of_turn_deg",
    "bounce_time_s",
    "phi_min_rad",
    "peak_psi_dot_rad_s",
    "peak_friction_ratio",
    "phi_rms_rad",
    "contact_locus_rms_m",
    "energy_drift",
    "max_penetration_m",
    "max_slip_m_s",
    "steps",
    "cpu_s",
)
"""Keys of what is told of a single run."""

_QUANTITY = (
    Column("quantity", "What was measured, with its unit."),
    Column("run", "Of the run."),
    Column("exact", "The same of the exact motion."),
)


def run_table(e: Evaluation) -> Table:
    """Return the quantities of one run that it or the exact motion has, a row each."""
    rows = [
        {"quantity": quantity.axis, "run": quantity.of_run(e), "exact": quantity.of_truth(e)}
        for quantity in map(QUANTITIES.__getitem__, _OF_A_RUN)
    ]
    known = [row for row in rows if not row["run"] is row["exact"] is None]
    case = e.simulation.case
    return table_of("run", f"{case.label()}: {e.simulation.ending}", _QUANTITY, known)


_BOUNCES = (
    *run_columns.RUN,
    Column("bounce", "Number of the bounce, from 1."),
    Column("time_s", "Time of the minimum of phi."),
    Column("phi_min_rad", "Smallest phi."),
    Column("angle_of_turn_deg", "Change of psi between the maxima of phi on either side."),
    Column("angle_of_turn_true_deg", "The same of the exact motion."),
    run_columns.quantity_column("rotation_turn_deg"),
    Column("peak_psi_dot_rad_s", "Precession rate of largest magnitude."),
    Column("peak_friction_ratio", "Largest |F|/N."),
    Column("resolved", "Whether the record is dense enough to count the turns of psi."),
    run_columns.LINK,
)


def bounces(evaluations: Sequence[Evaluation]) -> Table:
    """Return the table of all bounces."""
    quantities = [QUANTITIES[c.name] for c in _BOUNCES if c.name in QUANTITIES]
    turn = QUANTITIES["angle_of_turn_deg"].of_bounce
    rows = []
    for e in evaluations:
        for place, bounce in enumerate(e.bounces):
            row: dict[str, object] = {
                "simulation": e.simulation,
                "bounce": place + 1,
                "time_s": QUANTITIES["bounce_time_s"].of_bounce(bounce),
                "angle_of_turn_true_deg": next(map(turn, e.true_bounces[place:]), None),
                "resolved": bounce.resolved,
            }
            rows.append(row | {q.key: q.of_bounce(bounce) for q in quantities})
    return table_of("bounces", "All bounces", _BOUNCES, rows)


_PARITY = (
    *run_columns.RUN,
    Column("quantity", "Property of the model."),
    Column("unit", "Its unit."),
    Column("declared", "What the scene declares."),
    Column("found", "What the compiled engine has."),
    Column(
        "verdict",
        "equal; imposed: the profile is known to differ here; mismatch: the run stopped.",
    ),
    Column("how", "How it was read or probed."),
    run_columns.LINK,
)


def parity(evaluations: Sequence[Evaluation]) -> Table:
    """Return the compiled model of each engine against the declared one, at one timestep each."""
    seen: set[tuple[str, str, str]] = set()
    rows = []
    for e in evaluations:
        case = e.simulation.case
        model = (case.scene.name, case.engine, case.profile)
        differs = any(row.verdict == "mismatch" for row in e.simulation.parity)
        if model not in seen or differs:
            rows += [{"simulation": e.simulation, **asdict(row)} for row in e.simulation.parity]
        seen.add(model)
    return table_of("parity", "Model parity: the can that each engine compiled", _PARITY, rows)


_ORDERS = (
    run_columns.SCENE,
    run_columns.ENGINE,
    Column("quantity", "Which error."),
    Column(
        "observed_order", "Slope of log error against log timestep, profile matched.", "order.order"
    ),
    Column(
        "spread", "Half the range of the slopes between neighbouring timesteps.", "order.spread"
    ),
    Column("timesteps", "How many timesteps it rests on.", "order.points"),
    Column("smallest_error", "Error at the smallest timestep, in the quantity's unit."),
    run_columns.LINK,
)

_ROUND_OFF = 1e-12
"""rad or deg: below it an error is the sum of roundings, which has no order."""


def orders(evaluations: Sequence[Evaluation]) -> Table:
    """Return the observed orders of all ladders; the case is the run at the smallest timestep."""
    reads: Mapping[str, Callable[[Evaluation], float | None]] = {
        "phi_rms_rad": QUANTITIES["phi_rms_rad"].of_run,
        "angle_of_turn_deg": turn_error,
    }
    known = [e for e in evaluations if e.errors is not None and e.simulation.timestep]
    rows: list[dict[str, object]] = []
    for (_, _, profile), ladder in by_case(known, "scene", "engine", "profile").items():
        for quantity, read in reads.items() if profile == "matched" else ():
            steps = [e.simulation.timestep or math.nan for e in ladder]
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
