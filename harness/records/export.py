"""The exact motion of a scene as a record, for tests in any language."""

from typing import TYPE_CHECKING, Any

import numpy as np

from harness.core.errors import InvalidSettingError
from harness.engines.reference.to_reference_problem import refusal
from harness.engines.reference.truth import sample_truth, truth
from harness.metrics.quantities import QUANTITIES
from harness.records.columns import CONTACT, FORCE, POSITION, QUATERNION, SPIN, UNITS, VELOCITY
from models.kinematics import angles_of_record
from models.scene import Scene

if TYPE_CHECKING:
    import pandas as pd

_BOUNCE = ("phi_min_rad", "angle_of_turn_deg", "rotation_turn_deg", "peak_psi_dot_rad_s")


def exact_frame(scene: Scene) -> "pd.DataFrame":
    """Return the exact motion as the columns of a record, on a grid that resolves its bounces.

    Raises
    ------
    InvalidSettingError
        If the scene has no exact motion.
    """
    import pandas as pd  # noqa: PLC0415 - takes half a second to import

    if why := refusal(scene):
        raise InvalidSettingError("scene", scene.name, f"one with an exact motion: {why}")
    t = sample_truth(truth(scene))
    columns = {"time": t.time}
    for group, values in (
        (POSITION, t.position),
        (QUATERNION, t.quaternion),
        (VELOCITY, t.velocity),
        (SPIN, t.angular_velocity),
        (CONTACT, t.contact_point[:, :2]),
        (FORCE, t.contact_force),
    ):
        columns |= dict(zip(group, values.T, strict=True))
    columns["depth"] = t.penetration
    return pd.DataFrame({_si(name): values for name, values in columns.items()})


def _si(quantity: str) -> str:
    """Return the name of a quantity's column in SI units."""
    unit = next(iter(UNITS[quantity]))
    return f"{quantity}_{unit}" if unit else quantity


def exact_json(scene: Scene) -> dict[str, Any]:
    """Return the exact motion with its angles, period, turns and friction.

    Raises
    ------
    InvalidSettingError
        If the scene has no exact motion.
    """
    frame, exact = exact_frame(scene), truth(scene)
    record = angles_of_record(
        scene.can,
        frame["time_s"].to_numpy(),
        frame[list(QUATERNION)].to_numpy(),
        frame[[_si(name) for name in SPIN]].to_numpy(),
        start=(scene.release.psi, scene.release.theta),
    )
    columns = {name: frame[name].to_numpy() for name in frame.columns} | {
        f"{name}_rad": getattr(record, name) for name in ("phi", "psi", "theta")
    }
    first = exact.bounces[0] if exact.bounces else None
    return {
        "scene": scene.to_dict(),
        "ends_s": exact.ends,
        "period_s": None if first is None else first.end - first.start,
        "bounces": [
            {"time_s": bounce.time, "peak_friction_ratio": _finite(bounce.peak_friction_ratio)}
            | {name: QUANTITIES[name].of_bounce(bounce) for name in _BOUNCE}
            for bounce in exact.bounces
        ],
        "columns": {name: _numbers(values) for name, values in columns.items()},
    }


def _finite(value: float) -> float | None:
    return value if np.isfinite(value) else None


def _numbers(values: np.ndarray) -> list[float | None]:
    """Return numbers of which JSON has all; null for those it has not."""
    return [_finite(value) for value in values.tolist()]
