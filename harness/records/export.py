"""The exact motion of a scene as a record, for tests in any language."""

from typing import TYPE_CHECKING, Any

import numpy as np

from harness.core.errors import InvalidSettingError
from harness.core.trajectory import Floats
from harness.engines.reference.to_reference_problem import refusal
from harness.engines.reference.truth import Truth, truth
from harness.metrics.motion import motion
from harness.metrics.quantities import QUANTITIES
from harness.records.columns import CONTACT, FORCE, POSITION, QUATERNION, SPIN, UNITS, VELOCITY
from models.kinematics import angles_of_record
from models.scene import Scene

if TYPE_CHECKING:
    import pandas as pd

_BOUNCE = ("phi_min_rad", "angle_of_turn_deg", "rotation_turn_deg", "peak_psi_dot_rad_s")


def exact_frame(scene: Scene) -> "pd.DataFrame":
    """Return the exact motion as the columns of a record, on a grid that resolves its bounces.

    The grid holds the instants of the largest friction, so that a score of the record has no error.

    Raises
    ------
    InvalidSettingError
        If the scene has no exact motion.
    """
    import pandas as pd  # noqa: PLC0415 - takes half a second to import

    if why := refusal(scene):
        raise InvalidSettingError("scene", scene.name, f"one with an exact motion: {why}")
    exact = truth(scene)
    t = exact.at(np.union1d(exact.grid(), _peaks_of_friction(exact)))
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


_SAMPLES = 17
"""Between the neighbours of the best sample, of which the best is sought again."""

_ROUNDS = 8
"""Each narrows an instant down to an eighth of its interval: a ten millionth of it in the end, in
which the ratio, level at its peak, changes by the square."""

_LEVEL = 1e-14
"""A peak that is higher than the best sample of the grid by less than this share is that sample."""


def _peaks_of_friction(exact: Truth) -> Floats:
    """Return when |F|/N is largest in each bounce, shape (k,), s.

    Without the peaks that are samples of the grid, and those of a ratio that grows without bound.
    """
    grid = exact.grid()
    bounces = [bounce for bounce in exact.bounces if np.isfinite(bounce.peak_friction_ratio)]
    if not bounces:
        return grid[:0]
    ratio = _friction(exact, grid)
    low, high, known = [], [], []
    for bounce in bounces:
        inside = np.flatnonzero((grid >= bounce.start) & (grid <= bounce.end))
        best = int(inside[np.argmax(ratio[inside])])
        low.append(grid[max(best - 1, inside[0])])
        high.append(grid[min(best + 1, inside[-1])])
        known.append(ratio[best])
    left, right, rows = np.array(low), np.array(high), np.arange(len(low))
    for _ in range(_ROUNDS):
        times = np.linspace(left, right, _SAMPLES, axis=1)
        ratio = _friction(exact, times.ravel()).reshape(times.shape)
        peak = ratio.argmax(axis=1)
        left = times[rows, np.maximum(peak - 1, 0)]
        right = times[rows, np.minimum(peak + 1, _SAMPLES - 1)]
    higher = ratio[rows, peak] > np.array(known) * (1.0 + _LEVEL)
    peaks: Floats = times[rows, peak][higher]
    return peaks


def _friction(exact: Truth, times: Floats) -> Floats:
    """Return |F|/N at the given times, shape (n,); negative where nothing bears."""
    # next to an impact samples are an ulp apart, and what is between them is one of the two
    apart, place = np.unique(times, return_inverse=True)
    ratio = motion(exact.at(apart), exact.scene).friction_ratio[place]
    return np.where(np.isfinite(ratio), ratio, -1.0)


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
