"""What the paper states, as data: claims with their printed text, and the errors behind wrong ones.

`claims.toml` has both, errors gravest first and claims in the order of the paper. The checks that
decide the claims are in `checks`, each under the labels of its claims.
"""

import re
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from importlib.resources import files

from pydantic import TypeAdapter


class ClaimStatus(Enum):
    """How a claim stands, from good to grave; the value is what the table says."""

    HOLDS = "holds"
    TO_ORDER = "holds to stated order"
    MISPRINT = "misprint"
    INCONSISTENT = "inconsistent"
    FALSE = "false as printed"
    NOT_CHECKABLE = "not checkable"


WRONG = frozenset({ClaimStatus.MISPRINT, ClaimStatus.INCONSISTENT, ClaimStatus.FALSE})

MEANINGS = {
    ClaimStatus.HOLDS: "true as printed: a residual is zero identically, or a number rounds to it",
    ClaimStatus.TO_ORDER: "true up to the remainder that the paper states, which falls at its rate",
    ClaimStatus.MISPRINT: "exactly one symbol, digit, sign, parenthesis or reference away from the "
    "form given beside it, which passes the same check",
    ClaimStatus.INCONSISTENT: "a number that the paper's own equations and parameters do not give; "
    "the one given beside it they do",
    ClaimStatus.FALSE: "further than one symbol from what is given beside it, which passes the "
    "same check",
    ClaimStatus.NOT_CHECKABLE: "depends on what the paper does not give: experiments, other works",
}


class Weight(Enum):
    """What an error does to the rest of the paper, gravest first."""

    SUBSTANTIAL = "substantial"
    FORMULA = "formula"
    TYPOGRAPHICAL = "typographical"

    @property
    def heading(self) -> str:
        """Return what the report calls errors of this weight."""
        return {
            Weight.SUBSTANTIAL: "errors that change numbers or conclusions",
            Weight.FORMULA: "false numbers, formulas and statements that leave the results as they "
            "are",
            Weight.TYPOGRAPHICAL: "slips of one symbol, word or reference",
        }[self]


@dataclass(frozen=True, slots=True, kw_only=True)
class PaperError:
    """One error of the paper: several claims may be wrong for it.

    Parameters
    ----------
    name : str
        A few words, unique.
    weight : Weight
    printed, right : str
        What the paper says and what it should say.
    changes : str
        What follows for numbers, figures and conclusions.
    """

    name: str
    weight: Weight
    printed: str
    right: str
    changes: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Claim:
    """One claim of the paper.

    Parameters
    ----------
    label : str
        The paper's label of an equation; for other claims "text:", "caption:" or "app:" and a name.
    section : str
        Section of the paper, as it numbers them.
    place : str
        Number of the equation in print, or where the statement stands.
    says : str
        What is claimed, in a few words.
    printed : str
        The claim word for word in LaTeX, without comments and labels, white space as one blank.
    right : str
        `printed` put right, where a formula can be.
    remark : str
        What is right in words, where `right` does not say it.
    errors : sequence of str
        Names of the errors for which it is wrong; none where it stands.
    """

    label: str
    section: str
    place: str
    says: str
    printed: str
    right: str = ""
    remark: str = ""
    errors: Sequence[str] = ()

    @property
    def correct(self) -> str:
        """What should be printed: in LaTeX, in words, or both."""
        return "; ".join(part for part in (self.right and f"`{self.right}`", self.remark) if part)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Content:
    errors: tuple[PaperError, ...]
    claims: tuple[Claim, ...]


_CONTENT = TypeAdapter(_Content).validate_python(
    tomllib.loads(files("harness.paper.audit").joinpath("claims.toml").read_text(encoding="utf-8"))
)
ERRORS, CLAIMS = _CONTENT.errors, _CONTENT.claims


# a reference is one symbol; braces, dollars and what sets indices, exponents and columns are none
_SYMBOL = re.compile(r"\\c?ref\{[^}]*\}|\(\d\.\d+\)|\\[A-Za-z]+|[^\s{}^_&$]")


def symbols_apart(one: str, other: str) -> int:
    """Return how many symbols have to be put in, left out or exchanged (Levenshtein's distance).

    Parameters
    ----------
    one, other : str
        In LaTeX. A command, a reference and any other single character are a symbol each.
    """
    left, right = _SYMBOL.findall(one), _SYMBOL.findall(other)
    row = list(range(len(right) + 1))
    for i, symbol in enumerate(left, start=1):
        above, row = row, [i]
        for j, beside in enumerate(right):
            row.append(min(row[-1] + 1, above[j + 1] + 1, above[j] + (symbol != beside)))
    return row[-1]


@dataclass(frozen=True, slots=True, kw_only=True)
class Ruling:
    """What evidence comes to.

    Parameters
    ----------
    status : ClaimStatus
    correct : str
        The right number or form, as far as it was computed.
    how : str
        How it was checked, with the numbers that decided.
    """

    status: ClaimStatus
    correct: str = ""
    how: str


@dataclass(frozen=True, slots=True, kw_only=True)
class AuditRow:
    """A claim, the ruling on it, and the module and function that computed the ruling."""

    claim: Claim
    ruling: Ruling
    check: str
    seconds: float

    @property
    def status(self) -> ClaimStatus:
        """How the claim stands: what is false but one symbol away from the truth is a misprint."""
        claim = self.claim
        wrong = self.ruling.status in {ClaimStatus.FALSE, ClaimStatus.INCONSISTENT}
        if wrong and claim.right and symbols_apart(claim.printed, claim.right) == 1:
            return ClaimStatus.MISPRINT
        return self.ruling.status

    @property
    def correct(self) -> str:
        """What should be printed; nothing where the claim stands."""
        if self.ruling.status not in WRONG:
            return ""
        return "; ".join(part for part in (self.claim.correct, self.ruling.correct) if part)
