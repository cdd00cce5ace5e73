"""What an effect may change: a few numbers of a motion, each with the change that counts.

What including an effect costs: counts of work, and processor time measured alone.
"""

from collections.abc import Mapping
from dataclasses import dataclass

from harness.core.case import Case
from harness.evaluation.evaluation import Evaluation
from harness.metrics.quantities import QUANTITIES
from harness.studies.effects.plan import EffectsPlan, Subset, case

COUNTS = {
    "turn_deg": 1.0,
    "bounce_time_s": 1e-3,
    "peak_friction_ratio": 0.1,
    "phi_end_rad": 0.01,
    "x_end_m": 1e-3,
    "y_end_m": 1e-3,
}
"""Change of each quantity that counts, for each degree of turn that counts.

In the order in which words and figures take them.
"""

CHANGED = tuple(QUANTITIES[key] for key in COUNTS)
"""What an effect may change."""

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
