"""Kinds of evidence, and the verdict each comes to."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import mpmath as mp

from harness.studies.audit.finding import Ruling, Verdict
from harness.studies.audit.registry import Evidence
from harness.studies.audit.symbols import ZERO, Expr, disagreement, vanishes

RATE_SLACK = 0.15
"""What a logarithm in a remainder takes off an observed rate at the parameters used here."""


def digits(value: object, count: int = 4) -> str:
    """Return a number as the table shows it."""
    return str(mp.nstr(mp.mpmathify(value), count))


@dataclass(frozen=True, slots=True, kw_only=True)
class Identity:
    """Two forms that should be the same, one printed, one derived independently.

    Parameters
    ----------
    printed, derived : Expr
    corrected : Expr or None
        The printed form with its misprint mended.
    correct : str
        That form in words for the table.
    source : str
        What the derived form comes from.
    """

    printed: Expr
    derived: Expr
    source: str
    corrected: Expr | None = None
    correct: str = ""

    def ruling(self) -> Ruling:
        """Decide symbolically and at random points; the two must agree."""
        same, gap = self._compare(self.printed)
        if same:
            return Ruling(
                verdict=Verdict.HOLDS,
                correct="",
                how=f"sympy: residual against {self.source} is 0; 40 digits: {digits(gap, 2)}",
            )
        how = f"sympy: residual against {self.source} is not 0; relative {digits(gap, 2)}"
        if self.corrected is not None:
            mended, left = self._compare(self.corrected)
            if mended:
                how += f"; with the correct form 0 and {digits(left, 2)}"
                return Ruling(verdict=Verdict.MISPRINT, correct=self.correct, how=how)
        return Ruling(verdict=Verdict.INCONSISTENT, correct=self.correct, how=how)

    def _compare(self, form: Expr) -> tuple[bool, mp.mpf]:
        symbolic = vanishes(form - self.derived)
        gap = disagreement(form, self.derived)
        if symbolic != bool(gap < ZERO):
            raise ArithmeticError(f"sympy and mpmath disagree on {form} = {self.derived}")
        return symbolic, gap


@dataclass(frozen=True, slots=True, kw_only=True)
class Rate:
    """A remainder that should fall with a power of a small parameter.

    Parameters
    ----------
    remainder : callable
        From the small parameter to the size of what the paper neglects.
    stated : float
        The power.
    at : pair of float
        Two small values between which the power is observed.
    corrected : callable or None
        The remainder of the mended form.
    """

    remainder: Callable[[mp.mpf], mp.mpf]
    stated: float
    at: tuple[float, float]
    source: str
    corrected: Callable[[mp.mpf], mp.mpf] | None = None
    correct: str = ""

    def ruling(self) -> Ruling:
        """Decide by the observed power."""
        rate = self._observed(self.remainder)
        how = f"against {self.source}: observed rate {digits(rate, 3)}, stated {self.stated:g}"
        if rate > self.stated - RATE_SLACK:
            return Ruling(verdict=Verdict.TO_ORDER, correct=self.correct, how=how)
        if self.corrected is not None:
            mended = self._observed(self.corrected)
            if mended > self.stated - RATE_SLACK:
                how += f"; with the correct form {digits(mended, 3)}"
                return Ruling(verdict=Verdict.MISPRINT, correct=self.correct, how=how)
        return Ruling(verdict=Verdict.INCONSISTENT, correct=self.correct, how=how)

    def _observed(self, remainder: Callable[[mp.mpf], mp.mpf]) -> mp.mpf:
        with mp.workdps(60):  # cancellation of neighbouring terms, then eighteen digits to spare
            big, small = (mp.mpf(repr(x)) for x in self.at)
            return mp.log(abs(remainder(big)) / abs(remainder(small))) / mp.log(big / small)


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
    """

    printed: str
    value: object
    source: str
    low: object = None
    high: object = None
    also: str = ""

    def ruling(self) -> Ruling:
        """Decide by half a unit in the last printed place."""
        value = mp.mpmathify(self.value)
        low = value if self.low is None else mp.mpmathify(self.low)
        high = value if self.high is None else mp.mpmathify(self.high)
        mantissa, _, exponent = self.printed.lower().partition("e")
        places = len(mantissa.partition(".")[2])
        half = mp.mpf(10) ** (int(exponent or 0) - places) / 2
        near = low - half <= mp.mpf(self.printed) <= high + half
        shown = digits(value, max(4, sum(x.isdigit() for x in mantissa) + 2))
        return Ruling(
            verdict=Verdict.HOLDS if near else Verdict.INCONSISTENT,
            correct=""
            if near
            else f"{shown} ({self.source}){'; ' if self.also else ''}{self.also}",
            how=f"{self.source}: {shown}, printed {self.printed}",
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Fact:
    """A statement that a computation finds true or false.

    Parameters
    ----------
    true : bool
    how, correct : str
    mended : bool
        Whether the same computation found the form in `correct` true.
    """

    true: bool
    how: str
    correct: str = ""
    mended: bool = False

    def ruling(self) -> Ruling:
        """Decide by the computation."""
        verdict = Verdict.MISPRINT if self.mended else Verdict.INCONSISTENT
        if self.true:
            verdict = Verdict.HOLDS
        return Ruling(verdict=verdict, correct="" if self.true else self.correct, how=self.how)


@dataclass(frozen=True, slots=True, kw_only=True)
class Both:
    """Several pieces of evidence about one claim: the worst decides, all are told."""

    parts: Sequence[Evidence]

    def ruling(self) -> Ruling:
        """Decide by the gravest of the parts."""
        order = (Verdict.HOLDS, Verdict.TO_ORDER, Verdict.MISPRINT, Verdict.INCONSISTENT)
        rulings = [part.ruling() for part in self.parts]
        worst = max(rulings, key=lambda ruling: order.index(ruling.verdict))
        verdict = worst.verdict
        if verdict is Verdict.INCONSISTENT and any(r.verdict is Verdict.MISPRINT for r in rulings):
            verdict = Verdict.MISPRINT
        told = [ruling.correct for ruling in rulings if ruling.correct]
        return Ruling(
            verdict=verdict,
            correct="; ".join(dict.fromkeys(told)),
            how="; ".join(ruling.how for ruling in rulings),
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class OutOfReach:
    """What a claim depends on that the paper does not give."""

    reason: str

    def ruling(self) -> Ruling:
        """Say that it cannot be checked."""
        return Ruling(verdict=Verdict.NOT_CHECKABLE, correct="", how=self.reason)
