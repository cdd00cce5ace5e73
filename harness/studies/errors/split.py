"""One error in three parts that sum to it.

At a timestep h, with the value Q(h) of the engine as it is set, Q*(h) with its solver converged,
L = Q*(0) and T the truth:

    Q(h) - T  =  [L - T]  +  [Q*(h) - L]  +  [Q(h) - Q*(h)]
               model form   discretisation      solver
"""

from dataclasses import dataclass

from harness.studies.errors.extrapolation import Limit
from harness.studies.errors.quantities import Number


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
    limit: Limit | None
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
    *, true: Number, value: Number, converged: Number, limit: Limit | None, band: Number
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
