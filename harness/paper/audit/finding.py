"""What the audit says about one claim of the paper."""

from dataclasses import dataclass
from enum import Enum


class ClaimStatus(Enum):
    """How a claim stands, from good to grave; the value is what the table says."""

    HOLDS = "holds"
    TO_ORDER = "holds to stated order"
    MISPRINT = "misprint"
    INCONSISTENT = "inconsistent"
    FALSE = "false as printed"
    NOT_CHECKABLE = "not checkable"


STANDS = frozenset({ClaimStatus.HOLDS, ClaimStatus.TO_ORDER})
WRONG = frozenset({ClaimStatus.MISPRINT, ClaimStatus.INCONSISTENT, ClaimStatus.FALSE})

MEANINGS = {
    ClaimStatus.HOLDS: "true as printed: a residual is zero identically, or a number rounds to it",
    ClaimStatus.TO_ORDER: (
        "true up to the remainder that the paper states, which falls at that rate"
    ),
    ClaimStatus.MISPRINT: "one symbol, digit, sign or parenthesis away from the form given beside "
    "it, which passes the same check",
    ClaimStatus.INCONSISTENT: "a number that the paper's own equations and parameters do not give; "
    "the one given beside it they do",
    ClaimStatus.FALSE: "further than one symbol from the form given beside it, which passes the "
    "same check",
    ClaimStatus.NOT_CHECKABLE: "depends on what the paper does not give: experiments, other works",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Ruling:
    """What evidence comes to.

    Parameters
    ----------
    verdict : Verdict
    correct : str
        The right form or number, where the printed one is not; or a remark.
    how : str
        How it was checked, with the numbers that decided.
    """

    verdict: ClaimStatus
    correct: str
    how: str


@dataclass(frozen=True, slots=True, kw_only=True)
class AuditRow:
    """One row of the audit.

    Parameters
    ----------
    label : str
        The paper's label of an equation; for other claims "text:", "caption:" or "app:" and a name.
    section : str
        Section of the paper, as it numbers them.
    says : str
        The claim.
    ruling : Ruling
    check : str
        Module and function that computed the ruling.
    seconds : float
    place : str
        Number of the equation in print, or where the statement stands.
    causes : tuple of str
        Names of the errors for which it is wrong, as in `causes.CAUSES`; none where it stands.
    """

    label: str
    section: str
    says: str
    ruling: Ruling
    check: str
    seconds: float
    place: str = ""
    causes: tuple[str, ...] = ()
