"""The main table of the comparison: a row a case, with everything that was measured of it.

What every table of the comparison has in common: the columns that name a case.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd

from harness.core.report_model import Table
from harness.evaluation.evaluation import Evaluation

Row = dict[str, Any]

CASE: Mapping[str, str] = {
    "scene": "Name of the scene.",
    "engine": "Name of the engine.",
    "profile": "default: as it ships; matched: what the scene declares; adaptive: and own steps.",
    "timestep_s": "Timestep of the engine, s; the largest of an adaptive run.",
}


def key(e: Evaluation) -> Row:
    """Return what names a case in every table."""
    case = e.simulation.case
    return {
        "scene": case.scene.name,
        "engine": case.engine,
        "profile": case.profile,
        "timestep_s": e.simulation.timestep,
    }


def frame(rows: list[Row], columns: Mapping[str, str]) -> pd.DataFrame:
    """Return rows as a frame with just these columns, in this order."""
    return pd.DataFrame(rows, columns=list(columns))


LINK: Mapping[str, str] = {"case": "Digest of the case; its command is in the list of cases."}
"""The column that leads to the case behind a row."""


def link(e: Evaluation) -> Row:
    """Return what leads to the case behind a row."""
    return {"case": e.simulation.case.digest(e.simulation.engine_version)}


_RESULTS: Mapping[str, str] = {
    **CASE,
    "outcome": "How the run ended.",
    "angle_of_turn_deg": "Change of psi between the maxima of phi around the first bounce.",
    "angle_of_turn_error_deg": "The same, engine minus truth.",
    "turn_resolved": "Whether the record is dense enough to count the turns of psi.",
    "bounce_time_error_s": "Time of the first minimum of phi, engine minus truth.",
    "phi_min_rad": "Smallest phi of the first bounce.",
    "peak_friction_ratio": "Largest |F|/N in the first bounce, from the engine's forces.",
    "peak_friction_ratio_error": "The same, engine minus truth.",
    "phi_rms_rad": "Root mean square error of phi over the run.",
    "phi_rms_before_rad": "The same up to the first bounce.",
    "phi_rms_after_rad": "The same after the first bounce.",
    "phi_max_rad": "Largest error of phi.",
    "rotation_rms_rad": "Angle between the true and the engine's orientation, root mean square.",
    "psi_rms_rad": "Root mean square error of psi, without jumps.",
    "theta_rms_rad": "Root mean square error of theta, without jumps.",
    "contact_locus_rms_m": "Distance of the contact points at the same instant, rms.",
    "contact_locus_hausdorff_m": "Largest distance between the two loci as curves.",
    "parts_at_s": "When the orientation is first 0.1 rad from the truth's; empty if it never is.",
    "energy_drift": "Largest departure of the energy from its first value, over m g R.",
    "max_penetration_m": "Depth of the deepest contact.",
    "max_slip_m_s": "Largest horizontal speed of the can's material at the contact point.",
    "lift_off_fraction": "Share of the time without contact force.",
    "multi_contact_fraction": "Share of the time with several contact points that bear force.",
    "static_penetration_m": "Depth at which the can was released.",
    "simulated_s": "Length of the run.",
    "steps": "Timesteps taken.",
    "constraint_rows": "Rows that the solver worked on, summed over the steps.",
    "setup_s": "Compiling and probing, wall clock.",
    "wall_s": "Stepping and reading, wall clock, while other cases may have run beside it.",
    "cpu_s": "Stepping and reading, processor time.",
    "truth_pulls": "Whether the exact motion asks the plane to pull, which no engine's can.",
    "digest": "Names the case in this version of its engine.",
    "command": "Runs the case again.",
}


def results(evaluations: Sequence[Evaluation]) -> Table:
    """Return the table of all cases."""
    return Table(
        name="results",
        title="All cases",
        frame=frame([_result(evaluation) for evaluation in evaluations], _RESULTS),
        columns=_RESULTS,
        shown=(
            "scene",
            "engine",
            "profile",
            "timestep_s",
            "angle_of_turn_deg",
            "angle_of_turn_error_deg",
            "bounce_time_error_s",
            "phi_rms_rad",
            "contact_locus_rms_m",
            "peak_friction_ratio_error",
            "energy_drift",
            "max_penetration_m",
            "max_slip_m_s",
            "steps",
            "wall_s",
            "outcome",
        ),
    )


def _result(e: Evaluation) -> Row:
    """Return the row of a case."""
    s, errors, contact = e.simulation, e.errors, e.contact
    first = e.bounces[0] if e.bounces else None
    row: Row = {
        **key(e),
        "outcome": s.outcome.value + (f" ({s.note})" if s.note else ""),
        "parts_at_s": e.parts_at,
        "energy_drift": e.energy_drift,
        "static_penetration_m": s.static_penetration,
        "simulated_s": None if e.motion is None else float(e.motion.time[-1]),
        "steps": s.steps,
        "constraint_rows": s.constraint_rows,
        "setup_s": s.setup_s,
        "wall_s": s.wall_s,
        "cpu_s": s.cpu_s,
        "truth_pulls": e.truth_pulls,
        "digest": s.case.digest(s.engine_version),
        "command": s.case.command(),
    }
    if first is not None:
        row |= {
            "angle_of_turn_deg": math.degrees(first.angle_of_turn),
            "turn_resolved": first.resolved,
            "phi_min_rad": first.phi_min,
            "peak_friction_ratio": first.peak_friction_ratio,
        }
    if errors is not None:
        row |= {f"{name}_rad": getattr(errors, name) for name in _ANGLE_ERRORS}
        row |= {
            "contact_locus_rms_m": errors.contact_locus_rms,
            "contact_locus_hausdorff_m": errors.contact_locus_hausdorff,
        }
        if errors.angle_of_turn:
            row |= {
                "angle_of_turn_error_deg": math.degrees(errors.angle_of_turn[0]),
                "bounce_time_error_s": errors.time_of_bounce[0],
                "peak_friction_ratio_error": errors.peak_friction_ratio[0],
            }
    if contact is not None:
        row |= {
            "max_penetration_m": contact.max_penetration,
            "max_slip_m_s": contact.max_slip,
            "lift_off_fraction": contact.lift_off_fraction,
            "multi_contact_fraction": contact.multi_contact_fraction,
        }
    return row


_ANGLE_ERRORS = (
    "phi_rms",
    "phi_rms_before",
    "phi_rms_after",
    "phi_max",
    "rotation_rms",
    "psi_rms",
    "theta_rms",
)
