"""Appendix G: the double integrals of the outer solution in closed form."""

from collections.abc import Callable
from functools import partial

import mpmath as mp

from harness.studies.audit.finding import Ruling, Verdict
from harness.studies.audit.registry import claim
from harness.studies.audit.symbols import Expr


class DoubleIntegral:
    """A closed form of appendix G against its integrand and phi_1(0) = phi_1'(0) = 0."""

    def __init__(
        self,
        form: Callable[[Expr], Expr],
        integrand: Callable[[Expr], Expr],
        mended: Callable[[Expr], Expr] | None = None,
        correct: str = "",
    ) -> None:
        self.form, self.integrand, self.mended, self.correct = form, integrand, mended, correct

    def ruling(self) -> Ruling:
        """Decide by the second derivative and by the values at 0."""
        gap, start = self._gaps(self.form)
        small = mp.mpf("1e-20")
        how = f"30 digits: J'' - integrand at most {mp.nstr(gap, 2)}, "
        how += f"J(0) and J'(0) at most {mp.nstr(start, 6)}"
        if gap < small and start < small:
            return Ruling(verdict=Verdict.HOLDS, correct="", how=how)
        verdict, as_printed = Verdict.INCONSISTENT, gap
        if self.mended is not None:
            gap, start = self._gaps(self.mended)
            how += f"; mended {mp.nstr(gap, 2)} and {mp.nstr(start, 2)}; also by quadrature"
            # a right second derivative is a double integral, though not the one that is asked for
            if as_printed > small and gap < small and start < small and self._by_quadrature():
                verdict = Verdict.MISPRINT
        return Ruling(verdict=verdict, correct=self.correct, how=how)

    def _gaps(self, form: Callable[[Expr], Expr]) -> tuple[mp.mpf, mp.mpf]:
        with mp.workdps(30):
            points = (mp.mpf("0.25"), mp.mpf("0.5"), mp.mpf("0.8"))
            gap = max(abs(mp.diff(form, x, 2) - self.integrand(x)) for x in points)
            return gap, max(abs(form(mp.mpf(0))), abs(mp.diff(form, 0)))

    def _by_quadrature(self) -> bool:
        """Compare with the double integral as a single one, of (T - s) times the integrand."""
        mended = self.mended
        if mended is None:
            return False
        with mp.workdps(30):
            end = mp.mpf("0.7")
            value = mp.quad(lambda s: (end - s) * self.integrand(s), [0, end])
            return bool(abs(value - mended(end)) < mp.mpf("1e-20"))


def _li(z: Expr) -> Expr:
    return mp.polylog(2, z)


def third_power(sign: int, t: Expr) -> Expr:
    """Return J_3; the paper prints sign 1, and -1 is right."""
    return sign * t**2 / (8 * t**2 - 8) + 3 * t / 8 * mp.atanh(t)


def _jl2(t: Expr) -> Expr:
    log = mp.log
    less, more = log(1 - t), log(1 + t)
    return (
        2 * (t + 1) * _li((1 - t) / 2)
        - 2 * (t - 1) * _li((t + 1) / 2)
        - t * less**2
        + t * more**2
        - 4 * (log(8) * less + more + log(8 - 8 * t) - 3 + 2 * log(2) ** 2)
        + 4 * log(4) * less
        + 2 * more * less
        + (t * (log(16) - 4) - 2 * log(4)) * mp.atanh(t)
    ) / 8


def _jl1(t: Expr) -> Expr:
    log = mp.log
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
    return (-3 * t**2 + (t**2 + 1) * mp.log(1 - t**2) + 4 * t * mp.atanh(t)) / 2


def _jll(t: Expr) -> Expr:
    log = mp.log
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


INTEGRALS: dict[str, tuple[Callable[[Expr], Expr], Callable[[Expr], Expr]]] = {
    "J_3": (partial(third_power, 1), lambda t: (1 - t**2) ** -3),
    "J_2": (lambda t: t / 2 * mp.atanh(t), lambda t: (1 - t**2) ** -2),
    "J_1": (lambda t: t * mp.atanh(t) + mp.log(1 - t**2) / 2, lambda t: 1 / (1 - t**2)),
    "J_l2": (_jl2, lambda t: mp.log(1 - t**2) / (1 - t**2) ** 2),
    "J_l1": (_jl1, lambda t: mp.log(1 - t**2) / (1 - t**2)),
    "J_l0": (_jl0, lambda t: mp.log(1 - t**2)),
    "J_ll": (_jll, lambda t: mp.log(1 - t**2) ** 2),
}
CONSTANTS = {
    "J_l2": "subtract J_l2(0) = Li_2(1/2)/2 + 3/2 - (3/2) log 2 - log^2 2 = 0.27095",
    "J_l1": "subtract J_l1(0) = 2 - log 2 - Li_2(1/2) = 0.72461",
    "J_ll": "subtract J_ll(0) = 8 - 4 log 2 - 4 Li_2(1/2) = 2.89845",
}


def _integral(name: str) -> DoubleIntegral:
    form, integrand = INTEGRALS[name]
    if name == "J_3":
        right = "T^2/(8 - 8 T^2) + (3 T/8) arctanh T"
        return DoubleIntegral(form, integrand, partial(third_power, -1), right)
    if name in CONSTANTS:
        told = f"{CONSTANTS[name]}: a double integral, but phi_1(0) = 0 asks for J(0) = 0"
        return DoubleIntegral(form, integrand, lambda t: form(t) - form(mp.mpf(0)), told)
    return DoubleIntegral(form, integrand)


for _name in INTEGRALS:
    claim(f"app:{_name}", "G", f"closed form of {_name}", name="double_integral")(
        partial(_integral, _name)
    )
