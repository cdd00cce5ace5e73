"""Appendix B: the can on a plane without friction."""

from functools import cache

import sympy as sp

from harness.paper.audit.evidence import Both, Fact, IdentityEvidence, check, check_each
from harness.paper.audit.newton_euler import angular_momentum, body_rates, rate
from harness.paper.audit.symbols import (
    Co,
    Expr,
    Phi,
    Psi,
    S,
    Theta,
    a,
    c,
    eps,
    h,
    phi,
    phi_dd,
    psi_dd,
    theta_dd,
    zeta,
)

LIFT = Phi * (Co - h * S)
LAGRANGIAN = (
    a * (Psi**2 * S**2 + Phi**2) / 2 + c * (Psi * Co + Theta) ** 2 / 2 + LIFT**2 / 2 - S - h * Co
)


@check("app:Lagrangian")
def lagrangian() -> IdentityEvidence:
    """I Omega Omega/2 and the height of the centre, S + h C."""
    height = S + h * Co
    turning = body_rates()[1].dot(angular_momentum()) / 2
    return IdentityEvidence(
        printed=LAGRANGIAN,
        derived=turning + (height.diff(phi) * Phi) ** 2 / 2 - height,
        source="kinetic and potential energy",
    )


_SPIN = c * (Psi * Co + Theta)


@check_each(
    {
        "app:momentum about the axis": (_SPIN, Theta),
        "app:momentum about the vertical": (a * Psi * S**2 + Co * _SPIN, Psi),
    }
)
def conserved_momentum(printed: Expr, rate_: Expr) -> IdentityEvidence:
    """Differentiate the Lagrangian by psi' or theta'; psi and theta are not in it."""
    return IdentityEvidence(
        printed=printed, derived=LAGRANGIAN.diff(rate_), source="the Lagrangian"
    )


@check("app:Euler-Lagrange")
def euler_lagrange() -> IdentityEvidence:
    """Energy is constant along what it gives."""
    moved, pushed = sp.symbols("d_dt_p dL_dq")
    others = sp.solve(
        list(rate(sp.Matrix([LAGRANGIAN.diff(Theta), LAGRANGIAN.diff(Psi)]))),
        [psi_dd, theta_dd],
        dict=True,
    )[0]
    energy = LAGRANGIAN + 2 * (S + h * Co)

    def change(law: Expr) -> Expr:
        motion = law.subs({moved: rate(LAGRANGIAN.diff(Phi)), pushed: LAGRANGIAN.diff(phi)})
        inertia = motion.diff(phi_dd)
        change = rate(energy).subs(others)
        # phi'' = -rest/inertia, times the inertia
        rest = motion.subs(phi_dd, 0)
        return change.diff(phi_dd) * -rest + change.subs(phi_dd, 0) * inertia

    return IdentityEvidence(
        printed=moved - pushed,
        compared=change,
        derived=sp.Integer(0),
        source="the rate of the energy along its solutions, times the inertia",
    )


def _force(power: int) -> sp.Expr:
    return (
        Phi**2 * (S + h * Co) * (Co - h * S)
        + Psi**power * (a - c) * S * Co
        - c * Theta * Psi * S
        - (Co - h * S)
    )


@check("app:phi equation")
def equation_of_nutation() -> IdentityEvidence:
    """Lagrange's equation for phi."""
    motion = rate(LAGRANGIAN.diff(Phi)) - LAGRANGIAN.diff(phi)
    inertia = a + (Co - h * S) ** 2
    return IdentityEvidence(
        printed=inertia * phi_dd - _force(1),
        corrected=inertia * phi_dd - _force(2),
        derived=motion,
        source="the Lagrangian",
    )


def _reduced() -> sp.Expr:
    """Phi'' with the rates eliminated, for momenta 1 and zeta times eps^(1/2), eps = 1."""
    psi_dot = (zeta - Co) / (a * S**2)
    theta_dot = 1 / c - psi_dot * Co
    force = _force(2).subs({Psi: psi_dot, Theta: theta_dot})
    return force / (a + (Co - h * S) ** 2)


@check("app01:Phi_reduced_slip")
def reduced_without_friction() -> Both:
    """Expand: only powers of phi, and the part without eps at phi = 0."""
    plain = (h * Phi**2 - 1) / (a + 1)
    at_zero = ((Phi**2 * (S + h * Co) - 1) * (Co - h * S) / (a + (Co - h * S) ** 2)).subs(phi, 0)
    return Both(
        IdentityEvidence(printed=plain, derived=at_zero, source="the equation at phi -> 0"),
        strength_of_the_repulsion(),
    )


@check("app:alpha_3")
@cache
def strength_of_the_repulsion() -> IdentityEvidence:
    """Limit of phi^3 times what the momenta add."""
    leading = sp.limit(sp.simplify(_reduced().subs(Phi, 0) * S**3), phi, 0)
    return IdentityEvidence(
        printed=(zeta - 1) ** 2 / (a * (a + 1)), derived=sp.simplify(leading), source="phi -> 0"
    )


@check("text:expanding in eps")
def expansion_without_friction() -> Fact:
    """Expand what the momenta add in either letter: (B.7) has powers of phi."""
    values = {a: 1, c: sp.Rational(1, 2), h: 1, zeta: 2, Phi: 0}
    side = sp.cos(phi) - h * sp.sin(phi)
    added = (eps * (_reduced() + side / (a + side**2))).subs(values)
    expanded = {
        "eps": sp.series(added, eps, 0, 2).removeO(),
        "phi": sp.series(added, phi, 0, 1).removeO(),
    }
    return Fact(
        printed="eps",
        corrected="phi",
        holds=lambda letter: sp.expand(expanded[letter] * phi**3).is_polynomial(phi),
        how="sympy: eps multiplies a function of sin phi and cos phi, once and exactly; the powers "
        "of phi in (B.7) come from expanding in phi",
    )
