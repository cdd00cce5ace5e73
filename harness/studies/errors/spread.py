"""How far the members of an ensemble spread about the run that is not perturbed."""

from collections.abc import Sequence
from dataclasses import dataclass

from harness.studies.errors.quantities import Number

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
