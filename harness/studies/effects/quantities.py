"""What an effect may change: a few numbers of a motion, each with the change that counts."""

import math
from collections.abc import Callable
from dataclasses import dataclass

from harness.runner import Evaluation


@dataclass(frozen=True, slots=True, kw_only=True)
class Quantity:
    """One number of a motion.

    Parameters
    ----------
    key : str
        Column name, with the unit as the suffix.
    words : str
    counts : float
        Change that counts, for each degree of turn that counts.
    meaning : str
    read : callable
        None where a motion does not have it.
    """

    key: str
    words: str
    counts: float
    meaning: str
    read: Callable[[Evaluation], float | None]


def _turn(e: Evaluation) -> float | None:
    """Return the first angle of turn, deg, where the record can count it."""
    if not e.bounces or not e.bounces[0].resolved:
        return None
    return math.degrees(e.bounces[0].angle_of_turn)


def _friction(e: Evaluation) -> float | None:
    if not e.bounces:
        return None
    ratio = e.bounces[0].peak_friction_ratio
    return ratio if math.isfinite(ratio) else None


def _last(e: Evaluation) -> float | None:
    """Return phi at the end, where the end is a time: where it is a maximum, time tells."""
    if e.motion is None or e.simulation.case.scene.horizon.seconds is None:
        return None
    return float(e.motion.angles.phi[-1])


def _place(axis: int) -> Callable[[Evaluation], float | None]:
    def read(e: Evaluation) -> float | None:
        if e.motion is None:
            return None
        value = float(e.motion.trajectory.position[-1, axis])
        return value if math.isfinite(value) else None

    return read


QUANTITIES = (
    Quantity(
        key="turn_deg",
        words="angle of turn",
        counts=1.0,
        meaning="First angle of turn.",
        read=_turn,
    ),
    Quantity(
        key="bounce_time_s",
        words="time of the bounce",
        counts=1e-3,
        meaning="Time of the first minimum of phi.",
        read=lambda e: e.bounces[0].time if e.bounces else None,
    ),
    Quantity(
        key="peak_friction_ratio",
        words="peak friction ratio",
        counts=0.1,
        meaning="Largest |F|/N of the first bounce.",
        read=_friction,
    ),
    Quantity(
        key="phi_end_rad",
        words="nutation at the end",
        counts=0.01,
        meaning="phi at the end of a run of given time.",
        read=_last,
    ),
    Quantity(
        key="x_end_m",
        words="place at the end (x)",
        counts=1e-3,
        meaning="x of the can's centre at the end.",
        read=_place(0),
    ),
    Quantity(
        key="y_end_m",
        words="place at the end (y)",
        counts=1e-3,
        meaning="y of the can's centre at the end.",
        read=_place(1),
    ),
)
"""In the order in which words and figures take them; `counts` is for a tolerance of one degree."""
