"""Section 4.3 and appendix D: the reduced equation, its coefficients and its errors."""

import math
from functools import cache

import mpmath as mp
import numpy as np
import sympy as sp

from harness.paper import release
from harness.paper.audit import flat_motion, paper_can
from harness.paper.audit import flat_series as series
from harness.paper.audit.evidence import Both, Fact, IdentityEvidence, Rate, check, check_each
from harness.paper.audit.flat_motion import CONSTANTS
from harness.paper.audit.flat_series import A_P, COS, COS_2, NUMBERS, SIN, c_p, h, in_inertias, k
from harness.paper.audit.reduced_form import POWERS, bracket
from harness.paper.audit.symbols import B0, B2, Expr, log_phi, phi
from reference import Solution
from reference.asymptotic.small_nutation import reduced_of

SMALL = (1e-9, 1e-12)


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
    "3": B2**2 * A_P,
    "2": -2
    * h
    * ((_f(-1, 3) + (-_f(3, 4) * h**2 + A_P * c_p) * k**2 + (-c_p / 2 + _f(1, 4)) * k) * B2 + B0)
    * B2
    / (k * c_p),
    "1": 2
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
    "0": _A0,
    "l2": h * B2**2 * _L / c_p,
    "l1": -_L * B2**2 * (A_P * k - 1),
    "l0": 2
    * h
    * _L
    * B2
    / c_p
    * (
        (_f(-5, 12) + (-_f(3, 4) * h**2 + A_P * c_p / 3) * k**2 + (-c_p / 2 + _f(1, 4)) * k) * B2
        + B0
    ),
    "ll": -h * k * _L**2 * B2**2 / (2 * c_p),
}


@cache
def derived(name: str) -> Expr:
    """Return a coefficient from the series of the rates."""
    power, logs = POWERS[name]
    return series.drive_terms()[-power, logs]


def remainder(coefficients: dict[str, Expr], x: mp.mpf) -> mp.mpf:
    """Return the error of all terms, of which the coefficients not given are as derived."""
    every = {name: coefficients.get(name, derived(name)) for name in POWERS}
    value = series.valued(bracket(phi, log_phi, every), B0, B2)
    return value(x, *CONSTANTS) - flat_motion.drive(x, *CONSTANTS)


@check_each({f"app:a_{name}": (name,) for name in POWERS})
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
        remainder=lambda form, x: remainder({name: form}, x),
        corrected=derived(name),
        stated=1,
        at=SMALL,
        source=f"the exact rates, all other terms right (phi^{-power} log^{logs})",
    )
    return Both(identity, rate)


@check("eq01:Phi_reduced_intermediate")
def reduced_with_remainder() -> Both:
    """Look for the terms that there are, the logarithms in the remainder, and the coefficients."""
    listed, terms = frozenset((-i, j) for i, j in POWERS.values()), series.drive_terms()
    there = frozenset(powers for powers in terms if powers[0] <= 0)
    most = max(logs for power, logs in terms if power == 1)
    with mp.workdps(60):
        places = mp.mpf("1e-7"), mp.mpf("1e-12")
        ratios = [abs(remainder({}, x) / (x * mp.log(x))) for x in places]
    return Both(
        Fact(
            printed=listed,
            holds=lambda said: said == there,
            how="sympy: these terms up to phi^0 and no other",
        ),
        Fact(
            printed=(1, 1),
            holds=lambda order: order[0] < 1 or (order[0] == 1 and order[1] >= most),
            corrected=(1, 2),
            how=f"the remainder over phi log phi goes from {mp.nstr(ratios[0], 4)} at 1e-7 to "
            f"{mp.nstr(ratios[1], 4)} at 1e-12; coefficient of phi log^2 phi: "
            f"{terms[1, 2]}",
        ),
        reduced_equation(),
    )


@check("text:quadratic coefficients")
def quadratic_coefficients() -> Fact:
    """Collect the powers of B_0 and of B_-2 in all eight."""
    met = {powers for name in POWERS for powers in sp.Poly(derived(name), B0, B2).monoms()}
    printed = frozenset({(2, 0), (1, 1), (0, 2)})
    return Fact(
        printed=printed,
        holds=lambda powers: met == powers,
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
        stated=1,
        at=SMALL,
        source="the exact rates, with the coefficients of appendix D",
    )


KEPT = {"those of (4.14)": (0, 1), "up to phi": (1, 1), "up to phi^2": (2, 2)}
"""Largest power of phi kept without and with a logarithm."""


def _cut(form: Expr, plain: int, logs: int) -> Expr:
    kept = [
        term
        for term in sp.Add.make_args(sp.expand(form))
        if term.as_coeff_exponent(phi)[1] <= (logs if term.has(log_phi) else plain)
    ]
    return sp.Add(*kept)


@cache
def lost_coefficients(kept: str) -> tuple[str, ...]:
    """Return which coefficients of (4.19) come out wrong from series with these terms."""
    # some can and some motion, in rational numbers: an error for one is an error
    letters = {
        series.k: sp.Rational(1, 4),
        series.h: sp.Rational(3, 2),
        series.c_p: sp.Rational(8, 5),
    }
    values = letters | {B0: sp.Rational(2, 5), B2: 1}
    whole = [form.subs(values) for form in (series.precession(), series.rotation_rate())]

    def drive(psi: Expr, theta: Expr) -> Expr:
        square = ((A_P - series.c_p) * SIN * COS - series.h * COS_2).subs(letters)
        side = (series.c_p * SIN + series.h * COS).subs(letters)
        return sp.expand(square * psi**2 - side * theta * psi)

    left = sp.expand(drive(*(_cut(form, *KEPT[kept]) for form in whole)) - drive(*whole))
    return tuple(
        f"a_{name}"
        for name, (power, logs) in POWERS.items()
        if left.coeff(phi, -power).coeff(log_phi, logs) != 0
    )


@check("text:series suffice")
def series_that_suffice() -> Fact:
    """Substitute series cut at several powers, and compare the eight coefficients."""
    lost = lost_coefficients("those of (4.14)")
    return Fact(
        printed="those of (4.14)",
        corrected="up to phi^2",
        holds=lambda kept: not lost_coefficients(kept),
        how=f"sympy: with the terms of (4.14) {', '.join(lost)} come out wrong, since "
        "-h Psi (Psi + Theta) multiplies what is dropped with phi^-2",
    )


def _period(solution: Solution) -> float:
    return float(solution.maxima[-1] - solution.maxima[0])


@check("text:errors of no account")
def errors_of_the_reduced_equation() -> Fact:
    """Compare what the reduced equation says of the bounce with the exact motion."""
    exact, reduced = release.bounce(), release.reduced_bounce()
    turns = [abs(solution.bounces[0].angle_of_turn) for solution in (reduced, exact)]
    period, true_period = _period(reduced), _period(exact)
    errors = {"turn": abs(turns[0] / turns[1] - 1), "period": abs(period / true_period - 1)}
    return Fact(
        printed="turn",
        # half of the last digit of 209 degrees
        holds=lambda quantity: errors[quantity] < 0.5 / 209,
        how=f"relative errors: turn {errors['turn']:.1e}, period {errors['period']:.1e}; the paper "
        "gives the turn in whole degrees",
    )


@check("text:no balance")
def no_balance() -> Fact:
    """Follow the reduced force to where the exact one changes its sign."""
    equation = reduced_of(release.bounce().problem)
    letters = {B0: equation.B_0, B2: equation.B_minus_two, **NUMBERS, A_P: paper_can.a_p}
    slip = float(PRINTED["0"].subs(letters)) - equation.a_0
    beyond = np.linspace(0.01, math.pi / 2, 2000)
    force = equation.force(beyond)
    zeros = {int(np.count_nonzero(np.diff(np.sign(force + x)))) for x in (0.0, slip)}
    return Fact(
        printed=0,
        holds=lambda count: zeros == {count},
        how=f"reduced phi'' from 0.01 to pi/2 is at most {force.max():.3f} and never 0; the "
        f"printed a_0 changes it by {slip:.1e}",
    )


@check("text:eps as mediator")
def sharper_bounces() -> Fact:
    """Peak rates and smallest nutations of the paper's three values, zeta = 1."""
    printed = (4e-6, 6.4e-7, 1e-8)
    found = {
        e: release.solved(release.of_constants(e, 1.0, bounces=1), "reduced").bounces[0]
        for e in printed
    }

    def sharpens(order: tuple[float, ...]) -> bool:
        low, peak = [found[e].phi_min for e in order], [found[e].peak_psi_dot for e in order]
        return low == sorted(low, reverse=True) and peak == sorted(peak)

    told = ", ".join(f"{b.phi_min:.2e} rad and {b.peak_psi_dot:.1f}" for b in found.values())
    return Fact(
        printed=printed,
        holds=sharpens,
        how=f"phi_min and peak psi' for eps = 4e-6, 6.4e-7, 1e-8: {told}",
    )


DRIFT = 1e-3
"""A drift that a plot of ten periods shows: a hundredth of a period."""


@check("text:period")
def drift_of_the_period() -> Fact:
    """Period of the solution of the reduced equation against the exact one."""
    exact, reduced = _period(release.bounce()), _period(release.reduced_bounce())
    seen = "drifts" if abs(reduced / exact - 1) > DRIFT else "keeps"
    return Fact(
        printed="drifts",
        holds=lambda word: word == seen,
        how=f"exact period {exact:.6f}, that of the reduced equation {reduced:.6f} sqrt(R/g)",
    )
