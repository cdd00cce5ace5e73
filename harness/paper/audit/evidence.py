"""Which check decides which claim, the kinds of evidence, and the verdict each comes to.

Every kind holds the claim as data in `printed`, so that the same check can be run on another
claim: the tests run each on wrong claims, which it must refuse, and on the right one.
"""

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, Protocol, TypeVar

import mpmath as mp

from harness.paper.audit.claims import CLAIMS, WRONG, AuditRow, Claim, ClaimStatus, Ruling
from harness.paper.audit.symbols import ZERO, Expr, disagreement, vanishes


class Evidence(Protocol):
    """What a check computes; from it, and from nothing else, comes the verdict."""

    def ruling(self) -> Ruling:
        """Return what the evidence comes to."""
        ...


AnyCheck = TypeVar("AnyCheck", bound=Callable[..., Evidence])
CHECKS: dict[str, partial[Evidence]] = {}
"""The check of each claim by its label, once `harness.paper.audit.checks` is imported."""


def check(*labels: str) -> Callable[[AnyCheck], AnyCheck]:
    """Register a function as the check of claims."""
    return check_each(dict.fromkeys(labels, ()))


def check_each(arguments: Mapping[str, tuple[Any, ...]]) -> Callable[[AnyCheck], AnyCheck]:
    """Register a function as the check of claims, by label what it is called with.

    Raises
    ------
    ValueError
        If a label has a check already.
    """

    def register(function: AnyCheck) -> AnyCheck:
        for label, values in arguments.items():
            if label in CHECKS:
                raise ValueError(f"'{label}' has two checks")
            CHECKS[label] = partial(function, *values)
        return function

    return register


def name_of(label: str) -> str:
    """Return module and function of a claim's check."""
    function = CHECKS[label].func
    return f"{function.__module__.rpartition('.')[2]}.{function.__name__}"


RATE_SLACK = 0.15
"""What a logarithm in a remainder takes off an observed rate at the parameters used here."""


NEAR = mp.mpf("0.01")
"""Relative error at which an approximation is left: the power of eps does not depend on it."""


def digits(value: object, count: int = 4) -> str:
    """Return a number as the table shows it."""
    return str(mp.nstr(mp.mpmathify(value), count))


@dataclass(frozen=True, slots=True, kw_only=True)
class IdentityEvidence:
    """Two forms that should be the same, one printed, one derived independently.

    Parameters
    ----------
    printed, derived : Expr
    source : str
        What the derived form comes from.
    compared : callable or None
        What of the printed form is compared with the derived one, such as its derivative; the
        form itself if left out.
    corrected : Expr or None
        The printed form put right.
    correct : str
        What to say of the right form.
    """

    printed: Expr
    derived: Expr
    source: str
    compared: Callable[[Expr], Expr] | None = None
    corrected: Expr | None = None
    correct: str = ""

    def ruling(self) -> Ruling:
        """Decide at random points and, where those agree, symbolically."""
        same, gap = self._compare(self.printed)
        if same:
            return Ruling(
                status=ClaimStatus.HOLDS,
                correct="",
                how=f"sympy: residual against {self.source} is 0; 40 digits: {digits(gap, 2)}",
            )
        how = f"40 digits: relative residual against {self.source} {digits(gap, 2)}"
        status = ClaimStatus.INCONSISTENT
        if self.corrected is not None:
            right, left = self._compare(self.corrected)
            if right:
                status = ClaimStatus.FALSE
                how += f"; with the correct form {digits(left, 2)}, and sympy: 0"
        return Ruling(status=status, correct=self.correct, how=how)

    def _compare(self, claim: Expr) -> tuple[bool, mp.mpf]:
        form = claim if self.compared is None else self.compared(claim)
        gap = disagreement(form, self.derived)
        # a difference at one point to forty digits decides; only its absence needs a proof
        if gap >= ZERO:
            return False, gap
        if not vanishes(form - self.derived):
            raise ArithmeticError(f"sympy and mpmath disagree on {form} = {self.derived}")
        return True, gap


@dataclass(frozen=True, slots=True, kw_only=True)
class Rate:
    """A remainder that should fall with a power of a small parameter.

    Parameters
    ----------
    printed : object
        The claim whose remainder it is: mostly an expression.
    remainder : callable
        Returns the size of what a claim neglects at a small parameter.
    stated : float
        The power.
    at : pair of float
        Two small values between which the power is observed.
    source : str
        What the printed form is compared with.
    corrected, correct
        As of `IdentityEvidence`.
    corrected_to : float or None
        The power that should be stated, where that is another.
    """

    printed: Any
    remainder: Callable[[Any, mp.mpf], mp.mpf]
    stated: float
    at: tuple[float, float]
    source: str
    corrected: Any = None
    corrected_to: float | None = None
    correct: str = ""

    def ruling(self) -> Ruling:
        """Decide by the observed power."""
        rate = self._observed()
        how = f"against {self.source}: observed rate {digits(rate, 3)}, stated {self.stated:g}"
        if rate > self.stated - RATE_SLACK:
            return Ruling(status=ClaimStatus.TO_ORDER, how=how)
        status = ClaimStatus.INCONSISTENT
        right = replace(
            self,
            printed=self.printed if self.corrected is None else self.corrected,
            stated=self.stated if self.corrected_to is None else self.corrected_to,
        )
        mended = right._observed()  # noqa: SLF001 - of the same class
        if mended > right.stated - RATE_SLACK:
            status = ClaimStatus.FALSE
            how += f"; with the correct form {digits(mended, 3)}"
        return Ruling(status=status, correct=self.correct, how=how)

    def _observed(self) -> mp.mpf:
        with mp.workdps(60):  # cancellation of neighbouring terms, then eighteen digits to spare
            big, small = (mp.mpf(repr(x)) for x in self.at)
            left = [abs(self.remainder(self.printed, x)) for x in (big, small)]
            return mp.log(left[0] / left[1]) / mp.log(big / small)


@dataclass(frozen=True, slots=True, kw_only=True)
class Number:
    """A printed number and the value it should round to.

    Parameters
    ----------
    printed : str
        As printed, which says how many digits count.
    value : float or mpf
    low, high : float or mpf or None
        Where the value may lie when the inputs printed beside it are rounded themselves.
    source : str
        How the value was computed.
    also : str
        What to say beside the right number.
    wrong : ClaimStatus
        Which verdict it is that the value is another.
    """

    printed: str
    value: object
    source: str
    low: object = None
    high: object = None
    also: str = ""
    wrong: ClaimStatus = ClaimStatus.INCONSISTENT

    def ruling(self) -> Ruling:
        """Decide by half a unit in the last printed place."""
        value, near = mp.mpmathify(self.value), self.near()
        mantissa = self.printed.lower().partition("e")[0]
        shown = digits(value, max(4, sum(x.isdigit() for x in mantissa) + 2))
        return Ruling(
            status=ClaimStatus.HOLDS if near else self.wrong,
            correct=""
            if near
            else f"{shown} ({self.source}){'; ' if self.also else ''}{self.also}",
            how=f"{self.source}: {shown}, printed {self.printed}",
        )

    def near(self) -> bool:
        """Whether the value rounds to what is printed."""
        low, high = (
            mp.mpmathify(self.value if end is None else end) for end in (self.low, self.high)
        )
        mantissa, _, exponent = self.printed.lower().partition("e")
        half = mp.mpf(10) ** (int(exponent or 0) - len(mantissa.partition(".")[2])) / 2
        return bool(low - half <= mp.mpf(self.printed) <= high + half)


@dataclass(frozen=True, slots=True, kw_only=True)
class Fact:
    """A statement that a computation finds true or false.

    Parameters
    ----------
    printed : object
        What the statement says: a number, a word, a set, an expression.
    holds : callable
        Whether the computation finds a statement with other words in its place true.
    how : str
        What was computed.
    corrected, correct
        As of `IdentityEvidence`.
    """

    printed: Any
    holds: Callable[[Any], bool]
    how: str
    corrected: Any = None
    correct: str = ""

    def ruling(self) -> Ruling:
        """Decide by the computation."""
        if self.holds(self.printed):
            return Ruling(status=ClaimStatus.HOLDS, how=self.how)
        right = self.corrected is not None and self.holds(self.corrected)
        status = ClaimStatus.FALSE if right else ClaimStatus.INCONSISTENT
        return Ruling(status=status, correct=self.correct, how=self.how)


class Both:
    """Several pieces of evidence about one claim: the gravest decides, all are shown."""

    def __init__(self, *parts: Evidence) -> None:
        self.parts = parts

    def ruling(self) -> Ruling:
        """Decide by the gravest of the parts."""
        order = list(ClaimStatus)
        rulings = [part.ruling() for part in self.parts]
        worst = max(rulings, key=lambda ruling: order.index(ruling.status))
        wrong = [ruling for ruling in rulings if ruling.status in WRONG]
        told = [ruling.correct for ruling in (wrong or rulings) if ruling.correct]
        return Ruling(
            status=worst.status,
            correct="; ".join(dict.fromkeys(told)),
            how="; ".join(ruling.how for ruling in rulings),
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class OutOfReach:
    """What a claim depends on that the paper does not give."""

    reason: str

    def ruling(self) -> Ruling:
        """Say that it cannot be checked."""
        return Ruling(status=ClaimStatus.NOT_CHECKABLE, how=self.reason)


def audit(
    claims: Sequence[Claim] = CLAIMS, on_start: Callable[[Claim], None] | None = None
) -> Iterator[AuditRow]:
    """Check claims one by one.

    Parameters
    ----------
    claims : sequence of Claim
    on_start : callable, optional
        Called with each claim before it is checked, to show progress.

    Yields
    ------
    AuditRow
    """
    for claim in claims:
        if on_start is not None:
            on_start(claim)
        start = time.perf_counter()
        ruling = CHECKS[claim.label]().ruling()
        yield AuditRow(
            claim=claim,
            ruling=ruling,
            check=name_of(claim.label),
            seconds=time.perf_counter() - start,
        )
