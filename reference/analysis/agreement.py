"""Agreement of two methods that solve one motion, and the sentence that reports it."""

import math
from dataclasses import dataclass

from reference.analysis.conditioning import PROMISED

# A motion of which not three digits are known is no answer.
USEFUL = 1e-3
ENDING = "ending"
"""The quantity of two motions that do not bounce alike, or not at all."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Agreement:
    """Comparison of two methods over the first bounces of a motion.

    Attributes
    ----------
    quantity : str
        That parts most; of those that part by more than round-off allows, over what it allows.
    discrepancy : float
        By how much, relative, an angle below 1 rad in rad; infinite where one method finds bounces
        and the other another ending.
    allowed : float
        By how much it may, for round-off; of what allows the discrepancy, no more is added up.
    refused : bool
        Whether the closed motion is lost in round-off, and the integration stands alone.
    ulp : float
        By how much one ulp of each number of the problem moves it, added up to `USEFUL`, infinite
        if that decides how the motion ends; looked at where fewer digits agree than are promised.
        Of a motion that stands alone, of the quantity that it moves most.
    evaluations : int
        That the comparison took.
    """

    quantity: str
    discrepancy: float
    allowed: float
    refused: bool = False
    ulp: float = 0.0
    evaluations: int

    @property
    def holds(self) -> bool:
        """Return whether the methods differ by no more than round-off allows."""
        return self.discrepancy <= self.allowed

    @property
    def resolved(self) -> bool:
        """Return whether there is an answer: no ulp changes its first three digits.

        Where the methods differ by no more than round-off allows, three digits must agree as well.
        """
        if self.ulp > USEFUL:
            return False
        return not self.holds or self.discrepancy <= USEFUL

    @property
    def sentence(self) -> str:
        """Return the report of a difference; empty where all promised digits agree."""
        if not self.resolved or (self.holds and self.discrepancy <= PROMISED):
            return ""
        if self.refused:
            return (
                "The closed motion is lost in round-off. This is the integration's, of which one "
                f"ulp of each number moves a quantity by {self.ulp:.1e}."
            )
        if self.holds:
            return (
                f"The closed motion and the integration part by {self.discrepancy:.1e} in the "
                f"{self.quantity}, and round-off allows {self.allowed:.1e}: the motion is known to "
                "no more than that."
            )
        apart = (
            "end otherwise"
            if math.isinf(self.discrepancy)
            else f"part by {self.discrepancy:.1e} in the {self.quantity}"
        )
        return (
            f"The closed motion and the integration {apart}, where round-off allows "
            f"{self.allowed:.1e}: one of them is wrong. This is the integration's."
        )
