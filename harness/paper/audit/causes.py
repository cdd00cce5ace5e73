"""The errors that the wrong claims come down to: several claims may be wrong for one reason.

They are listed in `causes.toml`, gravest first within each weight.
"""

import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from importlib.resources import files


class Weight(Enum):
    """What an error does to the rest of the paper, gravest first."""

    SUBSTANTIAL = "errors that change numbers or conclusions"
    FORMULA = "false formulas and statements that leave the results as they are"
    TYPOGRAPHICAL = "slips of one symbol or reference"


@dataclass(frozen=True, slots=True, kw_only=True)
class Cause:
    """One error of the paper.

    Parameters
    ----------
    name : str
        A few words, unique.
    weight : Weight
    printed, right : str
        What the paper says and what it should say.
    changes : str
        What follows for numbers, figures and conclusions.
    claims : sequence of str
        Labels of the claims that are wrong for this reason; one may have two reasons.
    """

    name: str
    weight: Weight
    printed: str
    right: str
    changes: str
    claims: Sequence[str]


def _read() -> tuple[Cause, ...]:
    text = files("harness.paper.audit").joinpath("causes.toml").read_text(encoding="utf-8")
    tables = tomllib.loads(text)
    return tuple(
        Cause(weight=weight, **fields)
        for weight in Weight
        for fields in tables[weight.name.lower()]
    )


CAUSES = _read()


def causes_of(label: str) -> tuple[str, ...]:
    """Return the names of the errors for which a claim is wrong.

    Parameters
    ----------
    label : str
        Of the claim.
    """
    return tuple(cause.name for cause in CAUSES if label in cause.claims)
