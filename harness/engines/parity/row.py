"""One line of the parity table before it is judged."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class ParityFinding:
    """A quantity as the scene declares it and as it was found in the compiled engine.

    Parameters
    ----------
    quantity, unit : str
    declared, found : float
    tolerance : float
        In the unit: what reading it back or probing it may cost.
    how : str
        Where it was found.
    """

    quantity: str
    unit: str
    declared: float
    found: float
    tolerance: float
    how: str
