"""Section 4.3 and appendix D: the reduced equation and its coefficients."""

from functools import cache

import mpmath as mp
import sympy as sp

from harness.paper.audit import flat_motion
from harness.paper.audit import flat_series as series
from harness.paper.audit.checks.frobenius import TWO_, ZERO_, numeric
from harness.paper.audit.evidence import Both, Fact, IdentityEvidence, Rate, check, check_each
from harness.paper.audit.flat_series import A_P, c_p, h, in_inertias, k
from harness.paper.audit.symbols import B0, B2, Expr, log_phi, phi

SMALL = (1e-9, 1e-12)
POWERS = {
    "a_3": (-3, 0),
    "a_l2": (-2, 1),
    "a_2": (-2, 0),
    "a_l1": (-1, 1),
    "a_1": (-1, 0),
    "a_ll": (0, 2),
    "a_l0": (0, 1),
    "a_0": (0, 0),
}
"""Power of phi and of log phi beside each coefficient."""


def _f(numerator: int, denominator: int) -> Expr:
    return sp.Rational(numerator, denominator)


_L = h**2 * k - 1
_A0 = (
    (-125 * c_p * k**5 + 1440 * k**4) * B2**2 * h**5
    - 120
    * k**2
    * B2
    * (
        (34 - _f(32, 3) * c_p * k**2 * (A_P + _f(11, 128)) + (_f(293, 12) * c_p + 36) * k) * B2
        + B0 * (k * c_p - 84)
    )
    * h**3
    + (
        (
            -960
            + (135 - 3200 * A_P) * c_p * k**3
            + (5850 + 1280 * A_P) * c_p * k**2
            + (720 - 1032 * c_p) * k
        )
        * B2**2
        - 3840
        * (_f(-5, 4) + c_p * (A_P + _f(3, 32)) * k**2 + (-_f(27, 16) * c_p + _f(3, 8)) * k)
        * B0
        * B2
        - 5760 * B0**2
    )
    * h
) / (2880 * k * c_p)
PRINTED = {
    "a_3": B2**2 * A_P,
    "a_2": -2
    * h
    * ((_f(-1, 3) + (-_f(3, 4) * h**2 + A_P * c_p) * k**2 + (-c_p / 2 + _f(1, 4)) * k) * B2 + B0)
    * B2
    / (k * c_p),
    "a_1": 2
    / (k * c_p)
    * (
        (
            (_f(1, 3) + h**2 * k**3 * A_P / 2 - k**2 * h**2 / 4 + (-A_P / 3 - _f(1, 4)) * k) * B2
            + B0 * (A_P * k - 1)
        )
        * c_p
        - B2 * h**2 * k**2 * _L
    )
    * B2,
    "a_0": _A0,
    "a_l2": h * B2**2 * _L / c_p,
    "a_l1": -_L * B2**2 * (A_P * k - 1),
    "a_l0": 2
    * h
    * _L
    * B2
    / c_p
    * (
        (_f(-5, 12) + (-_f(3, 4) * h**2 + A_P * c_p / 3) * k**2 + (-c_p / 2 + _f(1, 4)) * k) * B2
        + B0
    ),
    "a_ll": -h * k * _L**2 * B2**2 / (2 * c_p),
}


@cache
def derived(name: str) -> Expr:
    """Return a coefficient from the series of the rates."""
    return series.coefficient(series.drive(), *POWERS[name])


def reduced(coefficients: dict[str, Expr]) -> Expr:
    """Return the sum of all terms, the coefficients that are not given as derived."""
    return sum(
        coefficients.get(name, derived(name)) * phi**power * log_phi**logs
        for name, (power, logs) in POWERS.items()
    )


def remainder(coefficients: dict[str, Expr]) -> "sp.Lambda":
    """Return the error of the sum as a function of phi."""
    value = numeric(reduced(coefficients))
    return lambda x: value(x) - flat_motion.drive(x, ZERO_, TWO_)


@check_each({f"app:{name}": (name,) for name in POWERS})
def coefficient_of_reduced(name: str) -> Both:
    """Compare with the series of the rates, and what is left with the exact ones."""
    printed = PRINTED[name]
    identity = IdentityEvidence(
        printed=printed,
        corrected=derived(name),
        compared=in_inertias,
        derived=in_inertias(derived(name)),
        source="the series of eq01:Phi",
        correct=f"${series.in_latex(derived(name))}$",
    )
    power, logs = POWERS[name]
    # at a rate of one the terms left out are phi (log phi)^2, whose logarithms take off 2/log
    rate = Rate(
        printed=printed,
        remainder=lambda form: remainder({name: form}),
        corrected=derived(name),
        others=(2 * derived(name), -derived(name)),
        stated=1,
        at=SMALL,
        source=f"the exact rates, all other terms right (phi^{power} log^{logs})",
    )
    return Both(parts=(identity, rate))


@check("eq01:Phi_reduced_intermediate")
def reduced_with_remainder() -> Both:
    """Look for the terms that there are, and for the logarithms in the remainder."""
    listed = frozenset(POWERS.values())
    there = frozenset(
        (power, logs)
        for power in range(-6, 1)
        for logs in range(5)
        if series.coefficient(series.drive(), power, logs) != 0
    )
    most = max(n for n in range(5) if series.coefficient(series.drive(), 1, n) != 0)
    with mp.workdps(60):
        gap, places = remainder({}), (mp.mpf("1e-7"), mp.mpf("1e-12"))
        ratios = [abs(gap(x) / (x * mp.log(x))) for x in places]
    return Both(
        parts=(
            Fact(
                printed=listed,
                holds=lambda terms: terms == there,
                others=(listed - {(-3, 0)}, listed - {(0, 1)}, listed | {(-1, 2)}),
                how="sympy: these terms up to phi^0 and no other",
            ),
            Fact(
                printed=(1, 1),
                holds=lambda order: order[0] < 1 or (order[0] == 1 and order[1] >= most),
                corrected=(1, 2),
                others=((1, 1), (1, 0), (2, 2)),
                how=f"the remainder over phi log phi goes from {mp.nstr(ratios[0], 4)} at 1e-7 to "
                f"{mp.nstr(ratios[1], 4)} at 1e-12; coefficient of phi log^2 phi: "
                f"{series.coefficient(series.drive(), 1, 2)}",
            ),
        )
    )


@check("text:quadratic coefficients")
def quadratic_coefficients() -> Fact:
    """Collect the powers of B_0 and of B_-2 in all eight."""
    met = {powers for name in POWERS for powers in sp.Poly(derived(name), B0, B2).monoms()}
    printed = frozenset({(2, 0), (1, 1), (0, 2)})
    return Fact(
        printed=printed,
        holds=lambda powers: met == powers,
        others=(printed - {(1, 1)}, printed | {(1, 0)}, printed - {(2, 0)}),
        how=f"sympy: the powers of B_0 and B_-2 in the eight are {sorted(met)}",
    )


@check("eq01:Phi_reduced")
def reduced_equation() -> Rate:
    """With the coefficients of appendix D the remainder should fall with phi."""
    right = {name: derived(name) for name in POWERS}
    return Rate(
        printed=PRINTED,
        remainder=remainder,
        corrected=right,
        others=(PRINTED, *({**right, name: -right[name]} for name in POWERS)),
        stated=1,
        at=SMALL,
        source="the exact rates, with the coefficients of appendix D",
    )
