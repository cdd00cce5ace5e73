"""What an effect may change: a few numbers of a motion, each with the change that counts.

What including an effect costs: counts of work, and processor time measured alone.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from harness.core.case import Case
from harness.evaluation.evaluation import Evaluation
from harness.studies.effects.plan import EffectsPlan, Subset, case


@dataclass(frozen=True, slots=True, kw_only=True)
class EffectQuantity:
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
    EffectQuantity(
        key="turn_deg",
        words="angle of turn",
        counts=1.0,
        meaning="First angle of turn.",
        read=_turn,
    ),
    EffectQuantity(
        key="bounce_time_s",
        words="time of the bounce",
        counts=1e-3,
        meaning="Time of the first minimum of phi.",
        read=lambda e: e.bounces[0].time if e.bounces else None,
    ),
    EffectQuantity(
        key="peak_friction_ratio",
        words="peak friction ratio",
        counts=0.1,
        meaning="Largest |F|/N of the first bounce.",
        read=_friction,
    ),
    EffectQuantity(
        key="phi_end_rad",
        words="nutation at the end",
        counts=0.01,
        meaning="phi at the end of a run of given time.",
        read=_last,
    ),
    EffectQuantity(
        key="x_end_m",
        words="place at the end (x)",
        counts=1e-3,
        meaning="x of the can's centre at the end.",
        read=_place(0),
    ),
    EffectQuantity(
        key="y_end_m",
        words="place at the end (y)",
        counts=1e-3,
        meaning="y of the can's centre at the end.",
        read=_place(1),
    ),
)
"""In the order in which words and figures take them; `counts` is for a tolerance of one degree."""


Times = Mapping[Case, Mapping[str, object]]
"""By case, what `harness.evaluation.timing.time_alone` measured."""


@dataclass(frozen=True, slots=True, kw_only=True)
class EffectCost:
    """What a run costs with an effect, over what it costs without: a ratio each, None if unknown.

    Parameters
    ----------
    steps, constraint_rows, cpu : float or None
        Per simulated second, since an effect may end a run early.
    cpu_spread : float or None
        Largest over smallest processor time of the repeats, the noisier of the two runs.
    """

    steps: float | None = None
    constraint_rows: float | None = None
    cpu: float | None = None
    cpu_spread: float | None = None


def price(
    made: EffectsPlan,
    found: Mapping[Case, Evaluation],
    times: Times,
    mover: str,
    sets: tuple[Subset, Subset],
) -> EffectCost:
    """Return what the effects cost by which the first set has more than the second."""
    one, other = (case(made, mover, subset) for subset in sets)
    if one is None or other is None:
        return EffectCost()
    mine, theirs = found[one], found[other]
    spreads = [s for s in (_spread(times, one), _spread(times, other)) if s is not None]
    return EffectCost(
        steps=_ratio(_rate(mine, mine.simulation.steps), _rate(theirs, theirs.simulation.steps)),
        constraint_rows=_ratio(
            _rate(mine, mine.simulation.constraint_rows),
            _rate(theirs, theirs.simulation.constraint_rows),
        ),
        cpu=_ratio(_rate(mine, _cpu(times, one)), _rate(theirs, _cpu(times, other))),
        cpu_spread=max(spreads, default=None),
    )


def _rate(e: Evaluation, amount: float | None) -> float | None:
    """Return an amount of work per simulated second."""
    if e.motion is None or amount is None or e.motion.time[-1] == 0.0:
        return None
    return amount / float(e.motion.time[-1])


def _ratio(above: float | None, below: float | None) -> float | None:
    return above / below if above is not None and below else None


def _repeats(times: Times, one: Case) -> list[float]:
    taken = times.get(one, {}).get("cpu_s", [])
    return [value for value in taken if value > 0.0] if isinstance(taken, list) else []


def _cpu(times: Times, one: Case) -> float | None:
    return min(_repeats(times, one), default=None)


def _spread(times: Times, one: Case) -> float | None:
    taken = _repeats(times, one)
    return max(taken) / min(taken) if taken else None
