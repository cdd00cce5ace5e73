"""The numbers of a run that have a limit: of its first bounce, or of its end if it has none."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from harness.core.bounce import Bounce
from harness.evaluation.evaluation import Evaluation
from harness.metrics.motion import Motion
from models.scene import Scene

Number = float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class ErrorQuantity:
    """A number of a run and the same of the exact motion; None where there is none."""

    key: str
    words: str
    unit: str
    meaning: str
    found: Callable[[Evaluation], Number]
    true: Callable[[Evaluation], Number]


def quantities(scene: Scene) -> tuple[ErrorQuantity, ...]:
    """Return the quantities of a scene: of the first bounce if that is its horizon."""
    if scene.horizon.seconds is None:
        return _OF_THE_BOUNCE
    return tuple(_at_end(name, scene.horizon.seconds) for name in ("psi", "phi"))


def _of_bounce(
    key: str, words: str, unit: str, meaning: str, read: Callable[[Bounce], Number]
) -> ErrorQuantity:
    def found(e: Evaluation) -> Number:
        return _finite(read(e.bounces[0])) if e.bounces else None

    def true(e: Evaluation) -> Number:
        return _finite(read(e.true_bounces[0])) if e.true_bounces else None

    return ErrorQuantity(key=key, words=words, unit=unit, meaning=meaning, found=found, true=true)


_OF_THE_BOUNCE = (
    _of_bounce(
        "turn_deg",
        "angle of turn",
        "degrees",
        "Change of psi between the maxima of phi around the first bounce, if it can be counted.",
        lambda bounce: math.degrees(bounce.angle_of_turn) if bounce.resolved else None,
    ),
    _of_bounce(
        "bounce_time_s",
        "time of the bounce",
        "s",
        "Time of the first minimum of phi.",
        lambda bounce: bounce.time,
    ),
    _of_bounce(
        "phi_min_rad",
        "smallest phi",
        "rad",
        "Smallest phi of the first bounce.",
        lambda bounce: bounce.phi_min,
    ),
    _of_bounce(
        "peak_friction_ratio",
        "peak friction ratio",
        "",
        "Largest |F|/N in the first bounce.",
        lambda bounce: bounce.peak_friction_ratio,
    ),
)


def _at_end(name: str, end: float) -> ErrorQuantity:
    """Return an angle at the horizon, deg, carried there from the last sample at its rate."""

    def read(motion: Motion | None) -> Number:
        if motion is None or abs(end - motion.time[-1]) > motion.time[-1] - motion.time[-2]:
            return None  # the run ended early
        angle, rate = getattr(motion.angles, name), getattr(motion.angles, f"{name}_dot")
        late = end - motion.time[-1]
        return _finite(float(np.degrees(angle[-1] + rate[-1] * late)))

    return ErrorQuantity(
        key=f"{name}_end_deg",
        words=f"{name} at the end",
        unit="degrees",
        meaning=f"{name} at the horizon.",
        found=lambda e: read(e.motion),
        true=lambda e: read(e.truth),
    )


def _finite(value: Number) -> Number:
    """Return a number, or None for what is none."""
    return value if value is not None and math.isfinite(value) else None
