"""One error in three parts that sum to it.

At a timestep h, with the value Q(h) of the engine as it is set, Q*(h) with its solver converged,
L = Q*(0) and T the truth:

    Q(h) - T  =  [L - T]  +  [Q*(h) - L]  +  [Q(h) - Q*(h)]
               model form   discretisation      solver

How far the members of an ensemble spread about the run that is not perturbed.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from harness.metrics.quantities import Number
from harness.studies.errors.extrapolation import ExtrapolatedLimit


@dataclass(frozen=True, slots=True, kw_only=True)
class Split:
    """The three errors of one quantity; None where it is not known.

    Parameters
    ----------
    true : float or None
        T.
    value : float or None
        Q(h).
    limit : Limit or None
        L, with its uncertainty, which is also that of model form and discretisation.
    model_form, discretisation, solver : float or None
    band : float or None
        Half-width within which a difference from the truth is not decidable: how far slightly
        perturbed releases spread.
    """

    true: Number
    value: Number
    limit: ExtrapolatedLimit | None
    model_form: Number
    discretisation: Number
    solver: Number
    band: Number

    @property
    def total(self) -> Number:
        """Q(h) - T."""
        return _less(self.value, self.true)

    @property
    def verdict(self) -> str:
        """Whether the discrepancy, and its model form, stand out from band and uncertainty."""
        if self.total is None or self.model_form is None or self.limit is None:
            return "unknown"
        band = self.band or 0.0
        if abs(self.total) <= band:
            return "undecidable"
        if abs(self.model_form) <= band + self.limit.uncertainty:
            return "no model error seen"
        return "model error"


def split(
    *, true: Number, value: Number, converged: Number, limit: ExtrapolatedLimit | None, band: Number
) -> Split:
    """Return an error in its three parts.

    Parameters
    ----------
    true, value, converged : float or None
        T, Q(h) and Q*(h).
    limit : Limit or None
        Of Q*.
    band : float or None
    """
    own = None if limit is None else limit.value
    return Split(
        true=true,
        value=value,
        limit=limit,
        model_form=_less(own, true),
        discretisation=_less(converged, own),
        solver=_less(value, converged),
        band=band,
    )


def _less(first: Number, second: Number) -> Number:
    return None if first is None or second is None else first - second


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
        known = [value for value in (self.of_engine, self.of_truth) if value is not None]
        return max(known) if known else None


def spread(middle: Pair, members: Sequence[Pair]) -> Spread:
    """Return how far members spread about the one in the middle."""
    engine = _largest(middle[0], [found for found, _ in members])
    truth = _largest(middle[1], [true for _, true in members])
    error = _largest(_error(middle), [_error(member) for member in members])
    return Spread(
        of_engine=engine,
        of_truth=truth,
        of_error=error,
        members=sum(found is not None for found, _ in members),
    )


def _error(pair: Pair) -> Number:
    found, true = pair
    return None if found is None or true is None else found - true


def _largest(middle: Number, values: Sequence[Number]) -> Number:
    """Return the largest departure of the values that are known."""
    if middle is None:
        return None
    return max((abs(value - middle) for value in values if value is not None), default=None)
