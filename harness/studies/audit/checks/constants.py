"""Section 4.2 and appendix C: B_0 and B_-2 from the release, and what they mean."""

import mpmath as mp
import sympy as sp

from harness.studies.audit import flat_motion, paper_can
from harness.studies.audit import flat_series as series
from harness.studies.audit.checks.frobenius import PRINTED_PSI, SMALL, error_of_psi
from harness.studies.audit.evidence import Both, Fact, Identity, Rate
from harness.studies.audit.newton_euler import (
    ARM,
    VERTICAL,
    contact_force,
    papers_accelerations,
    rotation,
    turn_z,
)
from harness.studies.audit.registry import claim
from harness.studies.audit.symbols import (
    Co,
    Expr,
    Phi,
    Psi,
    S,
    Theta,
    a,
    c,
    h,
    k,
    phi,
    psi,
)

EXACT = "the exact constants by the Wronskian, at fixed Psi and Theta"
PSI, THETA = mp.mpf(1), mp.mpf("0.3125")  # exact as binary numbers
TINY = (1e-5, 1e-8)


@claim("eq01:psi_diff_phi_small_phi", "4.2", "Psi' at release for small phi, up to O(phi^3)")
def slope_at_release() -> Rate:
    """Compare with the slope itself."""
    p = paper_can
    kc = p.k * p.c_p

    def left(x: mp.mpf) -> mp.mpf:
        slope = (kc * THETA + ((kc - 2) * mp.cos(x) - p.h * p.k * mp.sin(x)) * PSI) / mp.sin(x)
        printed = (kc * (PSI + THETA) - 2 * PSI) / x - p.h * p.k * PSI
        return printed + (kc * (THETA - 2 * PSI) + 4 * PSI) / 6 * x - slope

    return Rate(remainder=left, stated=3, at=TINY, source="eq01:psi_diff_phi")


@claim("eq01:simultaneous", "4.2", "Psi and Psi' at release are linear in B_0 and B_-2")
def two_equations() -> Rate:
    """Compare the series with the exact solution; that the equations are linear needs no more."""
    return Rate(remainder=error_of_psi(PRINTED_PSI), stated=2, at=SMALL, source=EXACT)


def printed_zero(x: mp.mpf) -> mp.mpf:
    """B_0 from eq01:A_sol as printed."""
    k_, c_p, h_ = paper_can.k, paper_can.c_p, paper_can.h
    kc = k_ * c_p
    return (
        kc / 2 * (THETA + PSI)
        - h_ * k_ * kc / 2 * (THETA + PSI) * x
        - (h_**2 * k_**2 - k_) / 4 * (kc * (THETA + PSI) - 2 * PSI) * x**2 * mp.log(x)
        + (-kc * (5 * PSI + 2 * THETA) + (4 - 3 * k_ + 9 * h_**2 * k_**2) * PSI) * x**2 / 12
    )


def derived_square() -> Expr:
    """Return the phi^2 coefficient of B_0 at fixed Psi and Theta, without the logarithm."""
    singular = series.singular_solution()
    kc = series.k * series.c_p
    slope = (kc * Theta + ((kc - 2) * series.COS - series.h * series.k * series.SIN) * Psi) * (
        1 / phi + phi / 6 + 7 * phi**3 / 360
    )
    # the Wronskian of eq01:frob_ode is -2/sin^3 phi
    top = sp.expand(Psi * series.slope(singular) - slope * singular) * (series.SIN**3 / -2)
    return series.coefficient(series.up_to(top, 2), 2)


@claim("eq01:A_sol", "4.2", "B_0 from the release, up to O(phi^3 log phi)")
def regular_constant() -> Rate:
    """Compare with the exact constant."""
    k_, c_p, h_ = sp.symbols("k c_p h", positive=True)
    square = derived_square()
    plain = sp.lambdify((k_, c_p, h_, Psi, Theta), square, "mpmath")

    def mended(x: mp.mpf) -> mp.mpf:
        p = paper_can
        kc = p.k * p.c_p
        return (
            kc / 2 * (THETA + PSI)
            - p.h * p.k * kc / 2 * (THETA + PSI) * x
            - (p.h**2 * p.k**2 - p.k) / 4 * (kc * (THETA + PSI) - 2 * PSI) * x**2 * mp.log(x)
            + plain(p.k, p.c_p, p.h, PSI, THETA) * x**2
        )

    def gap(form: "sp.Lambda") -> "sp.Lambda":
        return lambda x: form(x) - flat_motion.constants(x, PSI, THETA)[0]

    return Rate(
        remainder=gap(printed_zero),
        corrected=gap(mended),
        stated=3,
        at=TINY,
        source=EXACT,
    )


def _two(x: mp.mpf) -> mp.mpf:
    kc = paper_can.k * paper_can.c_p
    return (-kc / 2 * (THETA + PSI) + PSI) * x**2 - flat_motion.constants(x, PSI, THETA)[1]


@claim("eq01:B_sol", "4.2", "B_-2 from the release, up to O(phi^3 log phi)")
def singular_constant() -> Rate:
    """Compare with the exact constant; there is no logarithm in the remainder."""
    return Rate(remainder=_two, stated=3, at=TINY, source=EXACT)


@claim("eq01:b_sol_later", "6.1", "B_-2 from the release, up to O(phi^3)")
def singular_constant_again() -> Both:
    """Take Psi and Theta apart."""
    kc = k * (c + 1)
    return Both(
        parts=(
            Identity(
                printed=-kc / 2 * Theta + Psi * (1 - kc / 2),
                derived=-kc / 2 * (Theta + Psi) + Psi,
                source="eq01:B_sol",
            ),
            Rate(remainder=_two, stated=3, at=TINY, source=EXACT),
        )
    )


@claim(
    "text:conserved", "4.2", "B_0 and B_-2 stay constant, apart from the truncation of the series"
)
def constants_stay() -> Fact:
    """Evaluate them at two nutations of one motion."""
    with mp.workdps(40):
        values = (mp.mpf("0.7"), mp.mpf(1))
        worst = mp.mpf(0)
        for x in (mp.mpf("1e-5"), mp.mpf("1e-3"), mp.mpf("0.01")):
            again = flat_motion.constants(x, *flat_motion.rates(x, *values))
            worst = max(worst, *(abs(p - q) for p, q in zip(values, again, strict=True)))
    return Fact(
        true=bool(worst < mp.mpf("1e-25")),
        how=f"40 digits: exact along eq01:closed_subsystem, to {mp.nstr(worst, 2)}; "
        "only their expansions vary",
    )


@claim(
    "eq01:ang_mom_B", "C", "H_z^B = c (Theta + Psi cos phi) = c (Theta + Phi) - c Psi phi^2/2 + ..."
)
def momentum_about_the_axis() -> Both:
    """Expand."""
    exact = c * (Theta + Psi * Co)
    expanded = sp.series(exact, phi, 0, 4).removeO()
    tail = -c * Psi * phi**2 / 2
    return Both(
        parts=(
            Identity(printed=exact, derived=c * Theta + c * Psi * Co, source="c Omega_z"),
            Identity(
                printed=c * (Theta + Phi) + tail,
                corrected=c * (Theta + Psi) + tail,
                derived=sp.expand(expanded),
                source="its Taylor series to phi^3",
                correct="c (Theta + Psi) - c Psi phi^2/2",
            ),
        )
    )


@claim(
    "eq01:ang_mom_G",
    "C",
    "H_z^G = a Psi sin^2 phi + c cos phi (Psi cos phi + Theta), and for small phi",
)
def momentum_about_the_vertical() -> Both:
    """Project the angular momentum, and expand."""
    momentum = sp.diag(a, a, c) * sp.Matrix([Psi * S, -Phi, Psi * Co + Theta])
    exact = a * Psi * S**2 + c * Co * (Psi * Co + Theta)
    square = -c / 2 * (Theta + 2 * Psi) + a * Psi
    return Both(
        parts=(
            Identity(printed=exact, derived=(rotation() * momentum)[2], source="I Omega along z"),
            Identity(
                printed=c * (Theta + Psi) + square * phi**2,
                derived=sp.expand(sp.series(exact, phi, 0, 4).removeO()),
                source="its Taylor series to phi^3",
            ),
        )
    )


@claim("text:B_0 and H_B", "C", "B_0 - k c_p H_z^B/(2 c) = O(phi)")
def regular_constant_is_momentum() -> Rate:
    """At fixed Psi and Theta."""
    p = paper_can

    def left(x: mp.mpf) -> mp.mpf:
        momentum = p.c * (THETA + PSI * mp.cos(x))
        return flat_motion.constants(x, PSI, THETA)[0] - p.k * p.c_p / (2 * p.c) * momentum

    return Rate(remainder=left, stated=1, at=TINY, source=EXACT)


FRICTION = k * Phi * (a * Psi * S + c * h * (Psi * Co + Theta))


@claim(
    "eq01:friction_tangential", "C", "F_y^I = m g k Phi (a Psi sin phi + c h (Psi cos phi + Theta))"
)
def tangential_friction() -> Identity:
    """Insert the accelerations into the force, seen in I."""
    seen = (turn_z(psi).T * contact_force())[1].subs(papers_accelerations())
    return Identity(
        printed=FRICTION,
        corrected=-FRICTION,
        derived=seen,
        source="the force of eq01:n2l_lin",
        correct="F_y^I = -m g k Phi (a Psi sin phi + c h (Psi cos phi + Theta))",
    )


@claim("text:lines of action", "C", "N and F_x^I cannot affect the momenta about z^B and z^G")
def lines_of_action() -> Identity:
    """Moments about the centre of unit forces along x^I and z, along both axes."""
    arm = turn_z(-psi) * rotation() * ARM
    axis = turn_z(-psi) * rotation() * VERTICAL
    moments = [
        arm.cross(f).dot(z) for f in (sp.Matrix([1, 0, 0]), VERTICAL) for z in (axis, VERTICAL)
    ]
    return Identity(
        printed=sp.Matrix(moments), derived=sp.zeros(4, 1), source="moments about the centre"
    )


@claim("text:F_y in proportion", "C", "for small phi |F_y^I| is proportional to Theta + Psi")
def friction_in_proportion() -> Fact:
    """At fixed rates it is; along a motion a Psi sin phi = a B_-2/phi outgrows the sum."""
    p = paper_can
    with mp.workdps(40):
        shares = []
        for x in (mp.mpf("1e-3"), mp.mpf("1e-5")):
            psi_, theta_ = flat_motion.rates(x, mp.mpf("0.7"), mp.mpf(1))
            rest = p.c * p.h * (psi_ * mp.cos(x) + theta_)
            shares.append(abs(p.a * psi_ * mp.sin(x) / rest))
    return Fact(
        true=bool(shares[1] < shares[0] < 1),
        how="|a Psi sin phi| over |c h (Psi cos phi + Theta)| is "
        f"{mp.nstr(shares[0], 3)} at phi = 1e-3 "
        f"and {mp.nstr(shares[1], 3)} at 1e-5 (B_0 = 0.7, B_-2 = 1)",
        correct="F_y^I = -k Phi a B_-2/phi + O(Phi log phi): along a motion the first term leads",
    )
