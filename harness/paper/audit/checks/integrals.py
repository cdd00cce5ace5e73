"""Appendix G: the double integrals of the outer solution in closed form."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import partial
from typing import Self

import mpmath as mp
import sympy as sp

from harness.paper.audit.finding import ClaimStatus, Ruling
from harness.paper.audit.mutations import mutated
from harness.paper.audit.registry import claim
from harness.paper.audit.symbols import Expr

time = sp.Symbol("tau", positive=True)
SMALL = mp.mpf("1e-20")
"""Thirty digits, of which the numerical derivative takes some."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DoubleIntegral:
    """A closed form of appendix G against its integrand and phi_1(0) = phi_1'(0) = 0.

    Parameters
    ----------
    printed, integrand : Expr
        In `time`.
    corrected, correct, wrong
        As of `evidence.Identity`.
    """

    printed: Expr
    integrand: Expr
    corrected: Expr | None = None
    correct: str = ""
    wrong: ClaimStatus = ClaimStatus.FALSE

    def ruling(self) -> Ruling:
        """Decide by the second derivative and by the values at 0."""
        gap, start = self._gaps()
        how = f"30 digits: J'' - integrand at most {mp.nstr(gap, 2)}, "
        how += f"J(0) and J'(0) at most {mp.nstr(start, 6)}"
        if gap < SMALL and start < SMALL:
            return Ruling(verdict=ClaimStatus.HOLDS, correct="", how=how)
        verdict = ClaimStatus.INCONSISTENT
        if self.corrected is not None:
            right = self.as_corrected()
            gap, start = right._gaps()  # noqa: SLF001 - of the same class
            how += f"; with the correct form {mp.nstr(gap, 2)} and {mp.nstr(start, 2)}"
            if gap < SMALL and start < SMALL:
                verdict = self.wrong
        return Ruling(verdict=verdict, correct=self.correct, how=how)

    def mutations(self) -> Iterator[Self]:
        """Return evidence about wrong forms."""
        for other in mutated(self.printed):
            yield replace(self, printed=other)

    def as_corrected(self) -> Self:
        """Return evidence about the right form."""
        return self if self.corrected is None else replace(self, printed=self.corrected)

    def _gaps(self) -> tuple[mp.mpf, mp.mpf]:
        form, integrand = (sp.lambdify(time, x, "mpmath") for x in (self.printed, self.integrand))
        with mp.workdps(30):
            points = (mp.mpf("0.25"), mp.mpf("0.5"), mp.mpf("0.8"))
            gap = max(abs(mp.diff(form, x, 2) - integrand(x)) for x in points)
            return gap, max(abs(form(mp.mpf(0))), abs(mp.diff(form, 0)))


def _li(z: Expr) -> Expr:
    return sp.polylog(2, z)


def _j3(t: Expr, sign: int = 1) -> Expr:
    """Return J_3; the paper prints sign 1, and -1 is right."""
    return sign * t**2 / (8 * t**2 - 8) + 3 * t / 8 * sp.atanh(t)


def _jl2(t: Expr) -> Expr:
    log = sp.log
    less, more = log(1 - t), log(1 + t)
    return (
        2 * (t + 1) * _li((1 - t) / 2)
        - 2 * (t - 1) * _li((t + 1) / 2)
        - t * less**2
        + t * more**2
        - 4 * (log(8) * less + more + log(8 - 8 * t) - 3 + 2 * log(2) ** 2)
        + 4 * log(4) * less
        + 2 * more * less
        + (t * (log(16) - 4) - 2 * log(4)) * sp.atanh(t)
    ) / 8


def _jl1(t: Expr) -> Expr:
    log = sp.log
    less, more = log(1 - t), log(1 + t)
    return (
        2 * (t - 1) * _li((1 - t) / 2)
        - 2 * (t + 1) * _li((t + 1) / 2)
        - 2 * (t - 1) * less**2
        + less**2
        + (t + 1) * more**2
        + (2 * (t - 1) * less + log(4)) * less
        - t * less * log(4 * (1 - t))
        + (t + 1) * log(4) * more
        + 8
        - 2 * log(4)
    ) / 4


def _jl0(t: Expr) -> Expr:
    return (-3 * t**2 + (t**2 + 1) * sp.log(1 - t**2) + 4 * t * sp.atanh(t)) / 2


def _jll(t: Expr) -> Expr:
    log = sp.log
    less, more = log(1 - t), log(1 + t)
    return (
        4 * (t - 1) * _li((1 - t) / 2)
        - 4 * (t + 1) * _li((t + 1) / 2)
        + 14 * t**2
        + less * (-6 * t**2 + 2 * (t**2 - 1) * more + 4 * (t - 1) * less - 2 + log(16))
        + (t - 3) * (t - 1) * less**2
        - 2 * (t - 1) * less**2
        + (t + 1) ** 2 * more**2
        - 4 * t * (log(2) - 2) * less
        - 2 * (t + 1) * (3 * t + 1 - log(4)) * more
        + 16
        - 8 * log(2)
    ) / 2


_W = 1 - time**2
INTEGRANDS = {
    "J_3": _W**-3,
    "J_2": _W**-2,
    "J_1": 1 / _W,
    "J_l2": sp.log(_W) / _W**2,
    "J_l1": sp.log(_W) / _W,
    "J_l0": sp.log(_W),
    "J_ll": sp.log(_W) ** 2,
}
CLOSED_FORMS: dict[str, Expr] = {
    "J_3": _j3(time),
    "J_2": time / 2 * sp.atanh(time),
    "J_1": time * sp.atanh(time) + sp.log(_W) / 2,
    "J_l2": _jl2(time),
    "J_l1": _jl1(time),
    "J_l0": _jl0(time),
    "J_ll": _jll(time),
    "J_0": time**2 / 2,
}
"""As printed, and J_0, which the paper does not print."""
CONSTANTS = {
    "J_l2": "subtract J_l2(0) = Li_2(1/2)/2 + 3/2 - (3/2) log 2 - log^2 2 = 0.27095",
    "J_l1": "subtract J_l1(0) = 2 - log 2 - Li_2(1/2) = 0.72461",
    "J_ll": "subtract J_ll(0) = 8 - 4 log 2 - 4 Li_2(1/2) = 2.89845",
}
RIGHT_FORMS = (
    CLOSED_FORMS
    | {"J_3": _j3(time, -1)}
    | {name: CLOSED_FORMS[name] - CLOSED_FORMS[name].subs(time, 0) for name in CONSTANTS}
)


def _integral(name: str) -> DoubleIntegral:
    right, told, wrong = RIGHT_FORMS[name], "", ClaimStatus.FALSE
    if name == "J_3":
        told, wrong = "T^2/(8 - 8 T^2) + (3 T/8) arctanh T", ClaimStatus.MISPRINT
    if name in CONSTANTS:
        told = f"{CONSTANTS[name]}: a double integral, but phi_1(0) = 0 asks for J(0) = 0"
    return DoubleIntegral(
        printed=CLOSED_FORMS[name],
        integrand=INTEGRANDS[name],
        corrected=right,
        correct=told,
        wrong=wrong,
    )


for _name in INTEGRANDS:
    claim(f"app:{_name}", "G", f"closed form of {_name}", name="double_integral")(
        partial(_integral, _name)
    )
