"""Section 4.2 and appendix C: B_0 and B_-2 from the release, and what they mean."""

from functools import partial

import mpmath as mp
import sympy as sp

from harness.paper.audit import flat_motion, paper_can
from harness.paper.audit import flat_series as series
from harness.paper.audit.evidence import (
    Both,
    Fact,
    IdentityEvidence,
    Rate,
    check,
)
from harness.paper.audit.newton_euler import (
    ARM,
    VERTICAL,
    contact_force,
    papers_accelerations,
    rotation,
    turn_z,
)
from harness.paper.audit.symbols import Co, Expr, Phi, Psi, S, Theta, a, c, h, k, log_phi, phi, psi

EXACT = "the exact constants by the Wronskian, at fixed Psi and Theta"
PSI, THETA = mp.mpf(1), mp.mpf("0.3125")  # exact as binary numbers
TINY = (1e-5, 1e-8)
SMALL = (1e-9, 1e-12)


kc = series.k * series.c_p
beta = series.h * series.k
PRINTED_SLOPE = (
    (kc * (Psi + Theta) - 2 * Psi) / phi - beta * Psi + (kc * (Theta - 2 * Psi) + 4 * Psi) / 6 * phi
)
PRINTED_ZERO = (
    kc / 2 * (Theta + Psi)
    - beta * kc / 2 * (Theta + Psi) * phi
    - (beta**2 - series.k) / 4 * (kc * (Theta + Psi) - 2 * Psi) * phi**2 * log_phi
    + (-kc * (5 * Psi + 2 * Theta) + (4 - 3 * series.k + 9 * beta**2) * Psi) * phi**2 / 12
)
PRINTED_TWO = (-kc / 2 * (Theta + Psi) + Psi) * phi**2


def valued(form: Expr) -> "sp.Lambda":
    """Return a form in phi, its logarithm, Psi and Theta as a function of phi and the rates."""
    p = paper_can
    function = sp.lambdify(
        (phi, log_phi, Psi, Theta, series.k, series.h, series.c_p), form, "mpmath"
    )
    return lambda x, psi_, theta_: function(x, mp.log(x), psi_, theta_, p.k, p.h, p.c_p)


@check("eq01:psi_diff_phi_small_phi")
def slope_at_release() -> Rate:
    """Compare with the slope itself."""
    p = paper_can

    def remainder(form: Expr) -> "sp.Lambda":
        value, both = valued(form), p.k * p.c_p

        def left(x: mp.mpf) -> mp.mpf:
            slope = both * THETA + ((both - 2) * mp.cos(x) - p.h * p.k * mp.sin(x)) * PSI
            return value(x, PSI, THETA) - slope / mp.sin(x)

        return left

    return Rate(
        printed=PRINTED_SLOPE,
        remainder=remainder,
        stated=3,
        at=TINY,
        source="eq01:psi_diff_phi",
    )


def derived_zero() -> Expr:
    """Return B_0 at fixed Psi and Theta to phi^2, by the Wronskian -2/sin^3 phi."""
    singular = series.singular_solution()
    slope = (kc * Theta + ((kc - 2) * series.COS - beta * series.SIN) * Psi) * (
        1 / phi + phi / 6 + 7 * phi**3 / 360
    )
    # of order phi^-3, so that two more powers of either factor are enough
    top = series.up_to(Psi * series.slope(singular) - slope * singular, -1)
    return series.up_to(top * series.up_to(series.SIN**3, 5) / -2, 2)


def _coefficients_of_zero(form: Expr) -> Expr:
    """Return the coefficients to phi^2, the logarithm's last."""
    whole = sp.expand(form)
    plain = [whole.coeff(log_phi, 0).coeff(phi, n) for n in range(3)]
    return series.in_inertias(sp.Matrix([*plain, whole.coeff(log_phi, 1).coeff(phi, 2)]))


@check("eq01:A_sol")
def regular_constant() -> Both:
    """Compare with the exact constant, and every coefficient with letters."""

    def remainder(form: Expr) -> "sp.Lambda":
        value = valued(form)
        return lambda x: value(x, PSI, THETA) - flat_motion.constants(x, PSI, THETA)[0]

    return Both(
        parts=(
            Rate(
                printed=PRINTED_ZERO,
                remainder=remainder,
                others=(2 * PRINTED_ZERO, PRINTED_ZERO + phi, PRINTED_ZERO + phi**2),
                stated=3,
                at=TINY,
                source=EXACT,
            ),
            IdentityEvidence(
                printed=PRINTED_ZERO,
                compared=_coefficients_of_zero,
                derived=_coefficients_of_zero(derived_zero()),
                source="the Frobenius series and their Wronskian",
            ),
        )
    )


def _error_of_two(form: Expr) -> "sp.Lambda":
    value = valued(form)
    return lambda x: value(x, PSI, THETA) - flat_motion.constants(x, PSI, THETA)[1]


@check("eq01:B_sol")
def singular_constant() -> Rate:
    """Compare with the exact constant; there is no logarithm in the remainder."""
    return Rate(printed=PRINTED_TWO, remainder=_error_of_two, stated=3, at=TINY, source=EXACT)


@check("eq01:b_sol_later")
def singular_constant_again() -> Both:
    """Take Psi and Theta apart."""
    later = -kc / 2 * Theta + Psi * (1 - kc / 2)
    return Both(
        parts=(
            IdentityEvidence(
                printed=later, derived=sp.expand(PRINTED_TWO / phi**2), source="eq01:B_sol"
            ),
            Rate(
                printed=later * phi**2,
                remainder=_error_of_two,
                stated=3,
                at=TINY,
                source=EXACT,
            ),
        )
    )


@check("text:conserved")
def constants_stay() -> Both:
    """Follow both expansions along an exact motion: Psi grows as phi^-2 on it."""
    values = mp.mpf("0.75"), mp.mpf(1)

    def along(which: int, form: Expr) -> "sp.Lambda":
        value = valued(form)
        return lambda x: value(x, *flat_motion.rates(x, *values)) - values[which]

    return Both(
        parts=tuple(
            Rate(
                printed=form,
                remainder=partial(along, which),
                # Psi + Theta, a logarithm, shows at the lowest order only, Psi at every one
                others=(2 * form, form + Psi * phi**2, form - Psi * phi**2 * log_phi),
                stated=1,
                at=SMALL,
                source=f"{name} along an exact motion: what is cut off is phi^3 Psi",
            )
            for which, (name, form) in enumerate((("B_0", PRINTED_ZERO), ("B_-2", PRINTED_TWO)))
        )
    )


@check("eq01:ang_mom_B")
def momentum_about_the_axis() -> Both:
    """Expand."""
    exact = c * (Theta + Psi * Co)
    expanded = sp.series(exact, phi, 0, 4).removeO()
    tail = -c * Psi * phi**2 / 2
    return Both(
        parts=(
            IdentityEvidence(printed=exact, derived=c * Theta + c * Psi * Co, source="c Omega_z"),
            IdentityEvidence(
                printed=c * (Theta + Phi) + tail,
                corrected=c * (Theta + Psi) + tail,
                derived=sp.expand(expanded),
                source="its Taylor series to phi^3",
            ),
        )
    )


@check("eq01:ang_mom_G")
def momentum_about_the_vertical() -> Both:
    """Project the angular momentum, and expand."""
    momentum = sp.diag(a, a, c) * sp.Matrix([Psi * S, -Phi, Psi * Co + Theta])
    exact = a * Psi * S**2 + c * Co * (Psi * Co + Theta)
    square = -c / 2 * (Theta + 2 * Psi) + a * Psi
    return Both(
        parts=(
            IdentityEvidence(
                printed=exact, derived=(rotation() * momentum)[2], source="I Omega along z"
            ),
            IdentityEvidence(
                printed=c * (Theta + Psi) + square * phi**2,
                derived=sp.expand(sp.series(exact, phi, 0, 4).removeO()),
                source="its Taylor series to phi^3",
            ),
        )
    )


@check("text:B_0 and H_B")
def regular_constant_is_momentum() -> Rate:
    """At fixed Psi and Theta."""
    p = paper_can

    def remainder(factor: Expr) -> "sp.Lambda":
        share = sp.lambdify((a, c, h), factor, "mpmath")(p.a, p.c, p.h)

        def left(x: mp.mpf) -> mp.mpf:
            momentum = p.c * (THETA + PSI * mp.cos(x))
            return flat_motion.constants(x, PSI, THETA)[0] - share * momentum

        return left

    return Rate(printed=k * (c + 1) / (2 * c), remainder=remainder, stated=1, at=TINY, source=EXACT)


FRICTION = k * Phi * (a * Psi * S + c * h * (Psi * Co + Theta))


@check("eq01:friction_tangential")
def tangential_friction() -> IdentityEvidence:
    """Insert the accelerations into the force, seen in I."""
    seen = (turn_z(psi).T * contact_force())[1].subs(papers_accelerations())
    return IdentityEvidence(
        printed=FRICTION,
        corrected=-FRICTION,
        derived=seen,
        source="the force of eq01:n2l_lin",
    )


@check("text:lines of action")
def lines_of_action() -> IdentityEvidence:
    """Moments about the centre of unit forces along x^I and z, along both axes."""
    arm = turn_z(-psi) * rotation() * ARM
    axis = turn_z(-psi) * rotation() * VERTICAL
    along, across = sp.Matrix([1, 0, 0]), sp.Matrix([0, 1, 0])

    def moments(forces: Expr) -> Expr:
        found = [arm.cross(forces[:, i]).dot(z) for i in range(2) for z in (axis, VERTICAL)]
        return sp.Matrix(found)

    return IdentityEvidence(
        printed=sp.Matrix.hstack(along, VERTICAL),
        compared=moments,
        derived=sp.zeros(4, 1),
        others=(sp.Matrix.hstack(across, VERTICAL), sp.Matrix.hstack(along, across)),
        source="moments about the centre",
    )


@check("text:F_y in proportion")
def friction_in_proportion() -> Fact:
    """Along a motion a Psi sin phi = a B_-2/phi outgrows c h (Psi cos phi + Theta)."""
    p = paper_can

    def quotient(form: Expr, x: mp.mpf) -> mp.mpf:
        psi_, theta_ = flat_motion.rates(x, mp.mpf("0.7"), mp.mpf(1))
        force = p.a * psi_ * mp.sin(x) + p.c * p.h * (psi_ * mp.cos(x) + theta_)
        return force / valued(form)(x, psi_, theta_)

    def proportional(form: Expr) -> bool:
        with mp.workdps(40):
            far, near = (quotient(form, mp.mpf(x)) for x in ("1e-6", "1e-8"))
            # what is left out is phi log phi of it
            return bool(abs(near / far - 1) < mp.mpf("1e-3"))

    with mp.workdps(40):
        told = [mp.nstr(quotient(Theta + Psi, mp.mpf(x)), 3) for x in ("1e-6", "1e-8")]
    return Fact(
        printed=Theta + Psi,
        holds=proportional,
        corrected=Psi * phi,
        others=(Theta + Psi, Psi, Psi * phi**2),
        how="F_y^I/Phi over Theta + Psi, which should tend to a constant, goes from "
        f"{told[0]} at phi = 1e-6 to {told[1]} at 1e-8 (B_0 = 0.7, B_-2 = 1)",
    )
