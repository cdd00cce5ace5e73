"""One error in three parts that sum to it, and the band in which nothing is decidable.

At a timestep h, with the value Q(h) of the engine as it is set, Q*(h) with its solver converged,
L = Q*(0) and T the truth:

    Q(h) - T  =  [L - T]  +  [Q*(h) - L]  +  [Q(h) - Q*(h)]
               model form   discretisation      solver

The band is how far the members of an ensemble spread about the run that is not perturbed.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import Enum

from harness.core.case import Case
from harness.evaluation.evaluation import Evaluation
from harness.metrics.quantities import QUANTITIES, Number, Quantity, less
from harness.studies.errors.extrapolation import ExtrapolatedLimit
from harness.studies.errors.plan import ErrorsPlan
from harness.studies.shared.perturbation import SIZES


class ErrorStatus(Enum):
    """What a split error comes to; the value is what tables say."""

    UNKNOWN = "unknown"
    UNDECIDABLE = "undecidable"
    NO_MODEL_ERROR = "no model error seen"
    MODEL_ERROR = "model error"


@dataclass(frozen=True, slots=True, kw_only=True)
class Split:
    """The three errors of one quantity; None where it is not known.

    Parameters
    ----------
    case : Case
        At h, the solver as it is set.
    way, quantity : str
        How the timestep is shrunk, and which number.
    true, value, converged : float or None
        T, Q(h) and Q*(h).
    ladder : tuple of float or None
        Q* at each timestep of the ladder, from coarse to fine.
    limit : ExtrapolatedLimit or None
        L, with its uncertainty, which is also that of model form and discretisation.
    band : float or None
        Half-width within which a difference from the truth is not decidable: how far slightly
        perturbed releases spread.
    """

    case: Case
    way: str
    quantity: str
    true: Number
    value: Number
    converged: Number
    limit: ExtrapolatedLimit | None
    band: Number
    ladder: tuple[Number, ...] = ()

    @property
    def limit_value(self) -> Number:
        """L."""
        return None if self.limit is None else self.limit.value

    @property
    def model_form(self) -> Number:
        """L - T."""
        return less(self.limit_value, self.true)

    @property
    def discretisation(self) -> Number:
        """Q*(h) - L."""
        return less(self.converged, self.limit_value)

    @property
    def solver(self) -> Number:
        """Q(h) - Q*(h)."""
        return less(self.value, self.converged)

    @property
    def total(self) -> Number:
        """Q(h) - T."""
        return less(self.value, self.true)

    @property
    def verdict(self) -> ErrorStatus:
        """Whether the discrepancy, and its model form, stand out from band and uncertainty."""
        if self.total is None or self.model_form is None or self.limit is None:
            return ErrorStatus.UNKNOWN
        band = self.band or 0.0
        if abs(self.total) <= band:
            return ErrorStatus.UNDECIDABLE
        if abs(self.model_form) <= band + self.limit.uncertainty:
            return ErrorStatus.NO_MODEL_ERROR
        return ErrorStatus.MODEL_ERROR


Pair = tuple[Number, Number]
"""A value of the engine and the same of the exact motion."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Spread:
    """Largest departures; None where no member is known, or the run in the middle is not.

    Parameters
    ----------
    of_engine, of_truth : float or None
        Of the value itself.
    of_error : float or None
        Of engine minus truth: what is left when both follow the perturbation alike.
    members : int
        That are known.
    """

    of_engine: Number
    of_truth: Number
    of_error: Number
    members: int

    @property
    def band(self) -> Number:
        """The larger of engine's and truth's: a difference within it is not decidable."""
        return max((v for v in (self.of_engine, self.of_truth) if v is not None), default=None)


def spread(middle: Pair, members: Sequence[Pair]) -> Spread:
    """Return how far members spread about the one in the middle."""
    return Spread(
        of_engine=_largest(middle[0], [run for run, _ in members]),
        of_truth=_largest(middle[1], [true for _, true in members]),
        of_error=_largest(less(*middle), [less(*member) for member in members]),
        members=sum(run is not None for run, _ in members),
    )


def _largest(middle: Number, values: Sequence[Number]) -> Number:
    """Return the largest departure of the values that are known."""
    if middle is None:
        return None
    return max((abs(value - middle) for value in values if value is not None), default=None)


_OF_THE_BOUNCE = ("turn_deg", "bounce_time_s", "phi_min_rad", "peak_friction_ratio")
_OF_THE_END = ("psi_end_deg", "phi_end_deg")


def quantities(plan: ErrorsPlan) -> tuple[Quantity, ...]:
    """Return the numbers of a run that have a limit: of its first bounce, or of its end."""
    keys = _OF_THE_BOUNCE if plan.scene.horizon.seconds is None else _OF_THE_END
    return tuple(QUANTITIES[key] for key in keys)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ThreeErrors:
    """A plan with its evaluations and what they say.

    Parameters
    ----------
    plan : ErrorsPlan
    evaluations : mapping of Case to Evaluation
    spreads : mapping of (str, float) to Spread
        By quantity and relative size of the perturbations.
    splits : mapping of (str, str) to Split
        By way and quantity.
    """

    plan: ErrorsPlan
    evaluations: Mapping[Case, Evaluation]
    spreads: Mapping[tuple[str, float], Spread]
    splits: Mapping[tuple[str, str], Split]

    @property
    def sentences(self) -> tuple[str, ...]:
        """A sentence or two a way, and one on what is not decidable."""
        plan = self.plan
        for quantity in quantities(plan):
            splits = {way.name: self.splits[way.name, quantity.key] for way in plan.ways}
            if all(split.total is not None for split in splits.values()):
                told = [_way(plan, name, quantity, split) for name, split in splits.items()]
                return (*(one for pair in told for one in pair), self._undecidable(quantity))
        nothing = (
            f"{plan.engine} completes no motion of {plan.scene.name} at {plan.probe:.2g} s that "
            "could be compared, so that its errors cannot be told apart."
        )
        return (nothing,)

    def _undecidable(self, quantity: Quantity) -> str:
        """Return how far releases spread that no one can tell apart."""
        small, large = (self.spreads[quantity.key, size] for size in (SIZES[0], SIZES[-1]))
        return (
            f"Releases that differ by {SIZES[-1]:.0e} spread the {quantity.label} by "
            f"{_amount(quantity, large.of_truth, sign=False)} in the exact motion and by "
            f"{_amount(quantity, large.of_engine, sign=False)} in the engine (by "
            f"{_amount(quantity, small.of_truth, sign=False)} and "
            f"{_amount(quantity, small.of_engine, sign=False)} for {SIZES[0]:.0e}): a discrepancy "
            "smaller than that is not decidable."
        )


_VERDICTS = {
    ErrorStatus.MODEL_ERROR: "However small the timestep, this is another can: {}.",
    ErrorStatus.NO_MODEL_ERROR: "For a timestep of zero no model error is seen; {}.",
    ErrorStatus.UNDECIDABLE: "That is less than releases spread that differ by 1e-6; {}.",
    ErrorStatus.UNKNOWN: "Its limit is not known.",
}


def _way(plan: ErrorsPlan, name: str, quantity: Quantity, found: Split) -> tuple[str, str]:
    """Return the three errors on one way, and what they come to."""
    known, approach = "", "no order is seen on the way to its limit"
    if found.limit is not None:
        known = f" (known to {_amount(quantity, found.limit.uncertainty, sign=False)})"
        if found.limit.order is not None:
            approach = f"it approaches its limit with order {found.limit.order:.2f}"
            if found.limit.spread is not None:
                approach += f", give or take {found.limit.spread:.2f}"
    opening = (
        f"{plan.engine}, {name}, at a timestep of {plan.probe:.2g} s: the {quantity.label} of "
        f"{plan.scene.name} is off by {_amount(quantity, found.total)}, of which "
        f"model form {_amount(quantity, found.model_form)}{known}, "
        f"discretisation {_amount(quantity, found.discretisation)}, "
        f"solver {_amount(quantity, found.solver)}."
    )
    return opening, _VERDICTS[found.verdict].format(approach)


def _amount(quantity: Quantity, value: Number, *, sign: bool = True) -> str:
    if value is None:
        return "an unknown amount"
    number = f"{value:+.2g}" if sign else f"{value:.2g}"
    return f"{number} {quantity.unit}".rstrip()
