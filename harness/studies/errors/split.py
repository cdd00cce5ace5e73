"""One error in three parts that sum to it, and the band in which nothing is decidable.

At a timestep h, with the value Q(h) of the engine as it is set, Q*(h) with its solver converged,
L = Q*(0) and T the truth:

    Q(h) - T  =  [L - T]  +  [Q*(h) - L]  +  [Q(h) - Q*(h)]
               model form   discretisation      solver

Where the scene declares a contact that gives way T is the exact motion on that contact. T_rigid, on
a rigid one, is apart from it by the softness T - T_rigid, which is then no error of an engine whose
contact has the declared law:

    Q(h) - T_rigid  =  [T - T_rigid]  +  [Q(h) - T]
                         softness         the three

The band is how far the members of an ensemble spread about the run that is not perturbed.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum

from harness.core.case import Case
from harness.metrics.quantities import Number, less
from harness.studies.errors.extrapolation import ExtrapolatedLimit


class ErrorStatus(Enum):
    """Verdict on a split error; tables show the value."""

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
    rigid : float or None
        T_rigid, where the scene declares a contact that gives way.
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
    rigid: Number = None
    ladder: tuple[Number, ...] = ()

    @property
    def limit_value(self) -> Number:
        """L."""
        return None if self.limit is None else self.limit.value

    @property
    def softness(self) -> Number:
        """T - T_rigid: what the declared contact gives way by."""
        return less(self.true, self.rigid)

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
