"""Which claim is checked by which function: each check registers itself where it is written."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Protocol, TypeVar

from harness.paper.audit.finding import Ruling


class Evidence(Protocol):
    """What a check computes; from it, and from nothing else, comes the verdict."""

    def ruling(self) -> Ruling:
        """Return what the evidence comes to."""
        ...

    def mutations(self) -> "Iterator[Evidence]":
        """Return the same evidence about wrong claims, each of which it has to refuse."""
        ...

    def as_corrected(self) -> "Evidence":
        """Return the same evidence about the right claim: itself, where the printed one is."""
        ...


Check = Callable[[], Evidence]
AnyCheck = TypeVar("AnyCheck", bound=Check)


@dataclass(frozen=True, slots=True, kw_only=True)
class Claim:
    """One claim of the paper and the function that checks it."""

    label: str
    section: str
    says: str
    check: Check
    name: str


_CLAIMS: dict[str, Claim] = {}


def claim(label: str, section: str, says: str, *, name: str = "") -> Callable[[AnyCheck], AnyCheck]:
    """Register a function as the check of a claim.

    Parameters
    ----------
    label, section, says : str
        As in `Finding`.
    name : str
        Of the check, where several claims share one function; the function's own if left out.

    Raises
    ------
    ValueError
        If the label has a check already.
    """

    def register(check: AnyCheck) -> AnyCheck:
        if label in _CLAIMS:
            raise ValueError(f"'{label}' has two checks")
        # a claim of a family is checked by a function with its arguments filled in
        function = getattr(check, "func", check)
        module = function.__module__.rpartition(".")[2]
        _CLAIMS[label] = Claim(
            label=label,
            section=section,
            says=says,
            check=check,
            name=f"{module}.{name or getattr(check, '__name__', '')}",
        )
        return check

    return register


def registered() -> tuple[Claim, ...]:
    """Return the claims registered so far, in the order of the files that were read."""
    return tuple(_CLAIMS.values())
