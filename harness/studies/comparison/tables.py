"""The tables of the comparison: scorecard, all cases, bounces, model parity, observed orders."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

from harness.core.case import RECORDED
from harness.core.report_model import Column, Table, table_of
from harness.core.verdict import Status, Verdict
from harness.engines.ladder import rung_words
from harness.evaluation.evaluation import Evaluation
from harness.metrics.quantities import QUANTITIES, turn_error
from harness.studies.comparison.fidelity import excess, scorecard_verdict, undecided
from harness.studies.comparison.selection import by_case
from harness.studies.comparison.suite import Unsupported
from harness.studies.shared import run_columns


def _recorded(e: Evaluation) -> bool:
    """Whether a program outside wrote the motion of a run."""
    return e.simulation.case.profile == RECORDED


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
    Column("best_run", "Profile of the best run, and its timestep or accuracy."),
    Column("case", "Digest of the best run; its command is in the list of cases.", "best.digest"),
)


def scorecards(
    evaluations: Sequence[Evaluation], unsupported: Sequence[Unsupported] = ()
) -> tuple[Table, ...]:
    """Return the verdicts on engines, as they ship and at their best.

    Two matrices of engines by scenes, and a table with a row for each scene and engine.
    """
    rows = _verdicts(evaluations, unsupported)
    recorded = all(map(_recorded, evaluations))
    shipped = _matrix("shipped", "Engines as they ship, by scene", rows)
    return (
        _matrix("best", "Engines at their best, by scene", rows),
        *(() if recorded else (shipped,)),
        table_of("scorecard", "As it ships, and at its best", _SCORECARD, rows),
    )


def _verdicts(
    evaluations: Sequence[Evaluation], unsupported: Sequence[Unsupported]
) -> list[dict[str, Any]]:
    """Return the rows of the scorecard: one for each scene and engine."""
    rows = []
    for (scene, engine), own in by_case(evaluations, "scene", "engine").items():
        shipped = next((e for e in own if e.simulation.case.profile == "default"), None)
        tuned = [e for e in own if e.simulation.case.profile != "default"]
        best = min(tuned, key=_badness, default=None)
        row: dict[str, Any] = {"scene": scene, "engine": engine}
        for prefix, e in (("shipped", shipped), ("best", best)):
            if e is not None:
                row |= {
                    f"{prefix}_verdict": scorecard_verdict(e),
                    f"{prefix}_phi_rms_rad": QUANTITIES["phi_rms_rad"].of_run(e),
                    f"{prefix}_turn_error_deg": turn_error(e),
                    prefix: e.simulation,
                }
        if best is not None:
            run = best.simulation
            row |= {"best_run": ", ".join(filter(None, (run.case.profile, rung_words(run))))}
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
    return rows


def _matrix(side: str, title: str, rows: Sequence[Mapping[str, Any]]) -> Table:
    """Return the errors of engines by scenes: of the turn, or of phi where nothing turns.

    Parameters
    ----------
    side : str
        "best" or "shipped", and the name of the table.
    title : str
    rows : sequence of mapping
        Of the scorecard.
    """
    cells: dict[str, dict[str, object]] = {row["engine"]: {"engine": row["engine"]} for row in rows}
    columns = [run_columns.ENGINE.of("engine")]
    for scene in dict.fromkeys(row["scene"] for row in rows):
        own = [row for row in rows if row["scene"] == scene]
        turns = any(row.get(f"{s}_turn_error_deg") is not None for s in _SIDES for row in own)
        key, unit = ("turn_error_deg", "deg") if turns else ("phi_rms_rad", "rad")
        name, meant = f"{scene}_{unit}", "First angle of turn, engine minus truth"
        verdict, case = f"{name}_verdict", f"{name}_case"
        columns += [
            Column(
                name,
                f"{meant if turns else 'Root mean square error of phi'}, on {scene}.",
                verdict=verdict,
                case=case,
            ),
            Column(verdict, f"Verdict in words on all of {scene}.", shown=False),
            Column(case, f"Digest of the run of {scene}.", shown=False),
        ]
        for row in own:
            run = row.get(side)
            cells[row["engine"]] |= {
                name: row.get(f"{side}_{key}"),
                verdict: _short(row.get(f"{side}_verdict")),
                case: None if run is None else run.digest,
            }
    return table_of(side, title, columns, cells.values())


_SIDES = ("best", "shipped")


def _short(verdict: Verdict | None) -> Verdict | None:
    """Return a verdict without the reason where nothing can be decided: the scorecard has it."""
    if verdict is None or verdict.status is not Status.UNDECIDABLE:
        return verdict
    return Verdict(verdict.status, verdict.text.partition(":")[0])


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
        "Depth at which the can was released; empty of a record.",
        lambda e: None if _recorded(e) else e.simulation.static_penetration,
    ),
    Column("simulated_s", "Length of the run.", lambda e: e.motion and float(e.motion.time[-1])),
    run_columns.quantity_column("steps"),
    run_columns.quantity_column("constraint_rows", shown=False),
    run_columns.quantity_column("compile_s", shown=False),
    run_columns.quantity_column("setup_s", shown=False),
    run_columns.quantity_column("wall_s"),
    run_columns.quantity_column("cpu_s", shown=False),
    Column(
        "truth_pulls", "Whether the exact motion asks the plane to pull, which a contact's cannot."
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
