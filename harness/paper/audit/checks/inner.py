"""Sections 5.2 and 5.4: the inner solution, and the angles in the bounce."""

import mpmath as mp
import numpy as np
import sympy as sp

from harness.paper import release
from harness.paper.audit import paper_can
from harness.paper.audit.checks.reduced import derived
from harness.paper.audit.evidence import NEAR, Both, Fact, IdentityEvidence, Rate, check
from harness.paper.audit.flat_motion import CONSTANTS, rates
from harness.paper.audit.flat_series import in_inertias
from harness.paper.audit.reduced_form import a_, bracket
from harness.paper.audit.symbols import B2, A, Expr, H, I, R, T, a_p, eps, m

q = sp.Symbol("a_p", positive=True)
"""The paper's a_p as a letter of its own: only that it is positive matters here."""
x = sp.Symbol("varphi", positive=True)
root = sp.sqrt(eps)
t = sp.Symbol("t", real=True)
INNER = sp.sqrt(q / I + I * T**2)
P, Q = sp.symbols("P Q", positive=True)
log = sp.Symbol("log_full")
FORCE = root * (eps * bracket(root * x, log) - 1)
"""The right side of eq01:Phi_reduced times eps^(1/2), in inner variables."""


@check("eq01:inner_scalings")
def inner_scalings() -> Fact:
    """Only this power balances phi'' with a_3/phi^3 and keeps the outer slope."""
    n, s = sp.symbols("n s")  # phi ~ eps^n, t ~ eps^s
    found = sp.solve([n - 2 * s - (1 - 3 * n), n - s], [n, s])
    half = sp.Rational(1, 2)
    return Fact(
        printed=(half, half),
        holds=lambda powers: found == dict(zip((n, s), powers, strict=True)),
        how=f"sympy: phi'' ~ eps/phi^3 and slope of order 1 give {found}",
    )


@check("eq01:inner_full")
def inner_equation() -> IdentityEvidence:
    """Substitute."""
    printed = (
        a_["3"] / x**3
        + root * (a_["l2"] * log + a_["2"]) / x**2
        + eps * (a_["l1"] * log + a_["1"]) / x
        + root**3 * (a_["ll"] * log**2 + a_["l0"] * log + a_["0"])
        - root
    )
    return IdentityEvidence(printed=printed, derived=sp.expand(FORCE), source="eq01:Phi_reduced")


@check("eq01:inner_problem")
def inner_problem() -> IdentityEvidence:
    """Leading order of eq01:Phi_reduced in inner variables, with a_3 from eq01:Phi itself."""
    leading = sp.expand(FORCE).subs(eps, 0)
    strongest = in_inertias(derived("3") / B2**2)
    return IdentityEvidence(
        printed=a_p / x**3,
        derived=leading.subs(a_["3"], strongest),
        source="eq01:Phi_reduced at eps -> 0 and fixed varphi",
    )


def largest_addition(order: Expr) -> bool:
    """Whether what (5.8) adds to its leading order is of an order, and of no smaller one."""
    added = root * (a_["l2"] * (sp.log(eps) / 2 + sp.log(x)) + a_["2"]) / x**2 - root
    ratio = sp.limit(sp.expand(added / order), eps, 0)
    return bool(ratio.is_finite) and ratio != 0


@check("text:phi_min")
def smallest_nutation() -> IdentityEvidence:
    """Take the inner solution at T = 0."""
    return IdentityEvidence(
        printed=sp.sqrt(eps * q / I), derived=root * INNER.subs(T, 0), source="eq01:phi_inner"
    )


RATE = sp.sqrt(q + 1) / INNER**2


@check("text:inner precession")
def inner_precession() -> Both:
    """Measure the remainder at fixed varphi = 1: the exact rate minus the two terms."""
    slope = sp.Symbol("kh")
    form = 1 / x**2 - root * slope / x

    def remainder(kept: Expr, small: mp.mpf) -> mp.mpf:
        value = sp.lambdify((eps, x, slope), kept, "mpmath")
        scale = mp.sqrt(small)
        psi, _ = rates(scale, mp.mpf(0), scale)
        return scale * psi - value(small, mp.mpf(1), paper_can.k * paper_can.h)

    with mp.workdps(60):
        pair = mp.mpf("1e-12"), mp.mpf("1e-18")
        sizes = [abs(remainder(form, small)) for small in pair]

    def bounds(order: tuple[float, int]) -> bool:
        # a larger order is a bound too, but an empty one: it would exceed the terms that are kept
        power, logs = order
        per = [
            size / (small**power * abs(mp.log(small)) ** logs)
            for size, small in zip(sizes, pair, strict=True)
        ]
        return bool(abs(per[0] / per[1] - 1) < mp.mpf("0.2"))

    return Both(
        Rate(
            printed=form,
            remainder=remainder,
            stated=1,
            at=(1e-12, 1e-18),
            source="the exact rate, which leaves eps log eps",
        ),
        Fact(
            printed=(0, 1),
            holds=bounds,
            corrected=(1, 1),
            how=f"at varphi = 1 the remainder is {mp.nstr(sizes[0], 3)} for eps = 1e-12 and "
            f"{mp.nstr(sizes[1], 3)} for 1e-18, as eps log eps; the printed bound would exceed "
            "the terms kept",
        ),
    )


@check("eq01:Psi_inner")
def inner_rate() -> IdentityEvidence:
    """sqrt(a_p+1) B/phi^2 in inner variables; a_3 = a_p once eps is taken out."""
    return IdentityEvidence(
        printed=sp.sqrt(q + 1) / (q / I + I * T**2),
        derived=sp.simplify(sp.sqrt(q + 1) * root * root / (root * INNER) ** 2),
        source="B/phi^2 at eq01:phi_inner",
    )


@check("eq01:dpsi_max")
def largest_rate() -> IdentityEvidence:
    """At T = 0."""
    return IdentityEvidence(
        printed=I * sp.sqrt(q + 1) / (root * q),
        derived=RATE.subs(T, 0) / root,
        source="eq01:Psi_inner",
    )


@check("eq01:Theta_inner")
def inner_rotation() -> Rate:
    """(Theta + Psi)/Psi along a motion."""

    def remainder(factor: Expr, y: mp.mpf) -> mp.mpf:
        psi, theta = rates(y, *CONSTANTS)
        return (theta - int(factor) * psi) / psi

    return Rate(
        printed=sp.Integer(-1),
        remainder=remainder,
        stated=2,
        at=(1e-8, 1e-11),
        source="the exact rates",
    )


ARC = sp.sqrt(q + 1) / sp.sqrt(q) * sp.atan(I * T / sp.sqrt(q))
ARC_PRINTED = sp.sqrt(q + 1) / q * sp.atan(I * T / sp.sqrt(q))


def _angle(sign: int) -> IdentityEvidence:
    return IdentityEvidence(
        printed=sign * ARC_PRINTED,
        corrected=sign * ARC,
        compared=lambda angle: angle.diff(T),
        derived=sign * RATE,
        source="its derivative against eq01:Psi_inner",
    )


@check("eq01:psi_inner")
def inner_angle() -> IdentityEvidence:
    """Differentiate."""
    return _angle(1)


@check("eq01:theta_inner")
def inner_rotation_angle() -> IdentityEvidence:
    """Differentiate."""
    return _angle(-1)


@check("text:dvarphi/dT")
def inner_slope() -> IdentityEvidence:
    """Differentiate."""
    return IdentityEvidence(printed=I * T / INNER, derived=INNER.diff(T), source="eq01:phi_inner")


@check("eq01:angle_of_turn")
def angle_of_turn() -> IdentityEvidence:
    """Integrate the rate over the whole bounce."""
    whole = sp.integrate(sp.sqrt(q + 1) / (q / I + I * T**2), (T, 0, sp.oo)) * 2
    return IdentityEvidence(
        printed=sp.pi * sp.sqrt((q + 1) / q),
        derived=sp.simplify(whole),
        source="int of eq01:Psi_inner",
    )


@check("eq01:size_angle_of_turn")
def dimensional_turn() -> IdentityEvidence:
    """Undo the scaling."""
    return IdentityEvidence(
        printed=(A + m * H**2 + m * R**2) / (A + m * H**2),
        derived=(a_p + 1) / a_p,
        source="eq01:scalings, the square over pi^2",
    )


@check("text:limits of the turn")
def limits_of_the_turn() -> Fact:
    """Limits and monotony."""
    form = sp.pi * sp.sqrt((q + 1) / q)
    falls = sp.simplify(form.diff(q) / form + 1 / (2 * q * (q + 1))) == 0
    ends = sp.limit(form, q, sp.oo), sp.limit(form, q, 0)
    return Fact(
        printed=(sp.pi, sp.oo),
        holds=lambda least_and_most: falls and ends == least_and_most,
        how="sympy: it falls with a_p, from infinity to pi",
    )


@check("text:inner ansatz")
def order_of_the_inner_correction() -> Fact:
    """Largest term that (5.8) adds to its leading order."""
    return Fact(
        printed=root,
        corrected=root * sp.log(eps),
        holds=largest_addition,
        how="sympy: (5.8) adds eps^(1/2) a_l2 log(eps^(1/2) varphi)/varphi^2, which over eps^(1/2) "
        "has no limit; (5.10) itself states O(eps^(1/2) log eps)",
    )


@check("text:inner valid for T<0")
def sides_of_the_bounce() -> Fact:
    """Compare the angle past the bounce with the exact motion, on both sides."""
    solution = release.bounce()
    bounce = solution.bounces[0]
    a_p = float(paper_can.a_p)
    factor = np.sqrt((a_p + 1) / a_p)
    # arctan(I T/sqrt(a_p)) = arctan(rate t): the rate from the exact peak alone
    rate = bounce.peak_psi_dot / factor
    errors = {}
    for side, sign in (("T < 0", -1), ("T > 0", 1)):
        times = bounce.time + sign * np.geomspace(0.1, 100, 60) / rate
        angle = solution.at(times).psi - solution.at(np.array([bounce.time])).psi
        errors[side] = float(np.abs(angle - factor * np.arctan(rate * (times - bounce.time))).max())
    return Fact(
        printed=("T < 0",),
        corrected=("T < 0", "T > 0"),
        holds=lambda sides: set(sides) == {s for s, e in errors.items() if e < float(NEAR)},
        how="angle from the bottom of the bounce against the exact release, "
        "up to 100 times its "
        "width: " + ", ".join(f"{error:.1e} rad for {side}" for side, error in errors.items()),
    )
