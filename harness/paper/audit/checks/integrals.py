"""Appendix G: the double integrals of the outer solution in closed form."""

from functools import cache

import mpmath as mp
import sympy as sp

from harness.paper.audit.evidence import Fact, check_each, mutated
from harness.paper.audit.symbols import Expr

time = sp.Symbol("tau", positive=True)
SMALL = mp.mpf("1e-20")
"""Thirty digits, of which the numerical derivative takes some."""


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
WITH_CONSTANTS = ("J_l2", "J_l1", "J_ll")
"""Those that are not 0 at 0: double integrals all the same, of which phi_1(0) = 0 asks more."""
RIGHT_FORMS = (
    CLOSED_FORMS
    | {"J_3": _j3(time, -1)}
    | {name: CLOSED_FORMS[name] - CLOSED_FORMS[name].subs(time, 0) for name in WITH_CONSTANTS}
)


@cache
def _bend_missed(form: Expr, integrand: Expr) -> mp.mpf:
    """Return the largest relative difference of the second derivative and the integrand."""
    functions = (sp.lambdify(time, x, "mpmath") for x in (form, integrand))
    with mp.workdps(30):
        of_form, wanted = functions
        points = (mp.mpf("0.25"), mp.mpf("0.5"), mp.mpf("0.8"))
        return max(abs(mp.diff(of_form, x, 2) / wanted(x) - 1) for x in points)


@check_each({f"app:{name}": (name,) for name in INTEGRANDS})
def double_integral(name: str) -> Fact:
    """Differentiate twice: any double integral will do, whatever its constants."""
    printed, integrand = CLOSED_FORMS[name], INTEGRANDS[name]
    corrected = RIGHT_FORMS[name] if name == "J_3" else None
    right = printed if corrected is None else corrected
    gap = mp.nstr(_bend_missed(printed, integrand), 2)
    how = f"30 digits: J'' differs from the integrand by {gap} of it"
    if name in WITH_CONSTANTS:
        how += f"; J(0) = {sp.N(printed.subs(time, 0), 6)}, see (5.6)"
    return Fact(
        printed=printed,
        corrected=corrected,
        holds=lambda form: bool(_bend_missed(form, integrand) < SMALL),
        # another constant of integration is as good
        others=[x for x in mutated(right) if sp.expand(x - right).diff(time, 2) != 0],
        how=how,
    )
