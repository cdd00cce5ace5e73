"""The answers of `--json`: one object, exactly the documented keys; what is unknown is null."""

import json
import math
from collections.abc import Mapping, Sequence
from typing import Any

from harness.core.bounce import Bounce
from harness.core.verdict import Verdict
from harness.engines.reference.assumption_checks import Divergence
from harness.evaluation.evaluation import Evaluation
from models.modelling_choices import modelling_choices

Answer = dict[str, Any]


def reference_json(e: Evaluation, bounces: Sequence[Bounce]) -> Answer:
    """Return the answer of `reference`: the exact motion in numbers."""
    simulation = e.simulation
    return {
        "scene": simulation.case.scene.name,
        "engine": simulation.model,
        "outcome": simulation.ending,
        "wall_s": simulation.wall_s,
        "steps": simulation.steps,
        "period_s": bounces[0].end - bounces[0].start if bounces else None,
        "energy_drift": e.energy_drift,
        "bounces": [
            {
                "time_s": bounce.time,
                "phi_min_rad": bounce.phi_min,
                "angle_of_turn_deg": math.degrees(bounce.angle_of_turn),
                "rotation_turn_deg": math.degrees(bounce.rotation_turn),
                "peak_psi_dot_rad_s": bounce.peak_psi_dot,
                "peak_friction_ratio": bounce.peak_friction_ratio,
            }
            for bounce in bounces
        ],
        "modelling_choices": list(modelling_choices(simulation.case.scene.effects)),
    }


def run_json(e: Evaluation) -> Answer:
    """Return the answer of `run`: the motion in numbers, its errors, its contact, and chaos."""
    errors, contact = e.errors, e.contact
    return reference_json(e, e.bounces) | {
        "errors": {
            "phi_rms_rad": errors and errors.phi_rms,
            "angle_of_turn_deg": [math.degrees(turn) for turn in errors.angle_of_turn]
            if errors
            else [],
            "contact_locus_rms_m": errors and errors.contact_locus_rms,
            "peak_friction_ratio": list(errors.peak_friction_ratio) if errors else [],
        },
        "contact": {
            "max_penetration_m": contact and contact.max_penetration,
            "max_slip_m_s": contact and contact.max_slip,
            "lift_off_fraction": contact and contact.lift_off_fraction,
            "multi_contact_fraction": contact and contact.multi_contact_fraction,
        },
        "divergence": divergence_json(e.divergence),
        "parts_at_s": e.parts_at,
    }


def divergence_json(found: Divergence | None) -> Answer | None:
    """Return how disturbed releases part; None of a scene that cannot be chaotic."""
    if found is None:
        return None
    return {
        "chaotic": found.chaotic,
        "growth": found.growth,
        "lyapunov_time_s": found.lyapunov_time,
        "parted_s": found.parted,
    }


def to_json(answer: Mapping[str, Any]) -> str:
    """Return an answer as JSON text in which every number is one."""
    return json.dumps(_finite(answer), indent=2, allow_nan=False)


def _finite(value: Any) -> Any:  # noqa: ANN401 - JSON is of any type
    """Return a value with null for what is no number."""
    if isinstance(value, Mapping):
        return {key: _finite(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(inner) for inner in value]
    if isinstance(value, Verdict):
        return value.text
    if isinstance(value, float):
        return float(value) if math.isfinite(value) else None
    return value
