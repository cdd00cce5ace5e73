"""Section 6: the sign of the turn, the contact locus, and the friction that rolling asks for."""

import mpmath as mp
import numpy as np
import sympy as sp

from harness.studies.audit import flat_motion, paper_can, release
from harness.studies.audit.evidence import Both, Fact, Identity
from harness.studies.audit.registry import claim
from harness.studies.audit.symbols import (
    I,
    Psi,
    T,
    Theta,
    c_p,
    eps,
    k,
    psi,
)
from reference.exact import exact_bounces

q = sp.Symbol("a_p", positive=True)
t = sp.Symbol("t", positive=True)
CLOSE = 0.02
"""What a plot shows as the same: the paper says 'excellent agreement', to leading order."""


@claim("eq01:boundary", "6.1", "the turn changes sign on Theta = (2/(c_p k) - 1) Psi")
def boundary() -> Both:
    """Where B_-2 vanishes to leading order; and the exact slope at phi = pi/100."""
    kc = k * c_p
    with mp.workdps(30):
        columns = [flat_motion.constants(paper_can.PHI, *pair)[1] for pair in ((1, 0), (0, 1))]
    exact = float(-columns[0] / columns[1])
    line = float(2 / (paper_can.c_p * paper_can.k) - 1)
    rates = np.array([0.99, 1.01]) * exact * 0.01
    sides = exact_bounces(
        a=0.727, c=0.615, h=1.473, phi=float(paper_can.PHI), psi_dot=0.01, theta_dot=rates
    )
    signs = np.sign(sides.angle_of_turn)
    return Both(
        parts=(
            Identity(
                printed=2 / kc - 1,
                derived=sp.solve(-kc / 2 * Theta + Psi * (1 - kc / 2), Theta)[0] / Psi,
                source="eq01:b_sol_later",
            ),
            Fact(
                true=bool(signs[0] * signs[1] < 0) and abs(line / exact - 1) < CLOSE,
                how=f"slope {line:.4f}; exact at phi = pi/100 {exact:.4f}, where the turn does "
                "change its sign",
            ),
        )
    )


@claim("caption:fig01:left_or_right", "6.1", "the computed map agrees with eq01:boundary")
def sign_map() -> Fact:
    """Share of 60 x 60 releases whose turn has the sign that eq01:boundary says."""
    axis = np.linspace(-1, 1, 60) * float(paper_can.SECOND)
    x, y = (v.ravel() for v in np.meshgrid(axis, 4 * axis))
    cycles = exact_bounces(
        a=0.727, c=0.615, h=1.473, phi=float(paper_can.PHI), psi_dot=x, theta_dot=y
    )
    line = float(2 / (paper_can.c_p * paper_can.k) - 1)
    there = cycles.bounced
    same = np.sign(cycles.angle_of_turn) == np.sign(line * x - y)
    share = float(same[there].mean())
    return Fact(
        true=share > 1 - CLOSE, how=f"{share:.2%} of {int(there.sum())} bouncing releases agree"
    )


@claim("text:locus in T", "6.2", "dx_l/dT = -dpsi/dT (-sin psi, cos psi)")
def inner_locus_velocity() -> Identity:
    """eq01:contact_point_velocity with Theta = -Psi."""
    rate = sp.Matrix([-sp.sin(psi), sp.cos(psi)])
    return Identity(
        printed=-Psi * rate, derived=(Theta * rate).subs(Theta, -Psi), source="Theta = -Psi"
    )


ARC = sp.sqrt((q + 1) / q) * sp.atan(I * T / sp.sqrt(q))
ARC_PRINTED = sp.sqrt(q + 1) / q * sp.atan(I * T / sp.sqrt(q))


def _place(angle: sp.Expr, sign: int) -> sp.Matrix:
    return sp.Matrix([-sp.cos(angle), sign * sp.sin(angle)])


def _locus(printed: sp.Expr, right: sp.Expr, variable: sp.Symbol, correct: str) -> Identity:
    velocity = -right.diff(variable) * sp.Matrix([-sp.sin(right), sp.cos(right)])
    return Identity(
        printed=_place(printed, 1).diff(variable),
        corrected=_place(right, -1).diff(variable),
        derived=velocity,
        source="eq01:contact_point_velocity",
        correct=correct,
    )


@claim("eq01:contact_pt_inner", "6.2", "x_l = -cos psi + C, y_l = sin psi + C in the bounce")
def inner_locus() -> Both:
    """Differentiate; and the sense of turning of the exact locus."""
    return Both(
        parts=(
            _locus(ARC_PRINTED, ARC, T, "y_l = -sin(...) + C, and sqrt((a_p+1)/a_p) arctan(...)"),
            Fact(
                true=release.turning() > 0,
                how="the exact locus of the paper's release (B_-2 > 0) turns "
                f"{'anticlockwise, as the mended form' if release.turning() > 0 else 'clockwise'}",
            ),
        )
    )


@claim("eq01:dpsi_outer_contact", "6.2", "dpsi/dt = 4 eps^(1/2) sqrt(a_p+1)/(I - t^2)^2")
def outer_rate() -> Identity:
    """sqrt(a_p+1) B_-2/phi^2 on the leading outer solution."""
    phi_0 = (I - t**2) / 2
    return Identity(
        printed=4 * sp.sqrt(eps) * sp.sqrt(q + 1) / (I - t**2) ** 2,
        derived=sp.sqrt(q + 1) * sp.sqrt(eps) / phi_0**2,
        source="eq01:psi_series at eq01:leading_order_outer",
    )


def _outer_angle(power: sp.Expr) -> sp.Expr:
    inner = t / (I * (I - t**2)) + I**power * sp.atanh(t / sp.sqrt(I))
    return 2 * sp.sqrt(eps * (q + 1)) * inner


OUTER = "I^(-3/2) arctanh(t/sqrt(I))"


@claim(
    "text:outer psi", "6.2", "psi = 2 eps^(1/2) sqrt(a_p+1) (t/(I(I-t^2)) + arctanh(t/sqrt(I))) + C"
)
def outer_angle() -> Both:
    """Differentiate, and integrate numerically."""
    rate = 4 * sp.sqrt(eps) * sp.sqrt(q + 1) / (I - t**2) ** 2
    end = mp.mpf("0.1")
    width = paper_can.WIDTH
    area = mp.quad(lambda s: 4 / (width - s**2) ** 2, [0, end])
    forms = [
        2 * (end / (width * (width - end**2)) + width**p * mp.atanh(end / mp.sqrt(width)))
        for p in (0, mp.mpf("-1.5"))
    ]
    return Both(
        parts=(
            Identity(
                printed=_outer_angle(sp.Integer(0)).diff(t),
                corrected=_outer_angle(sp.Rational(-3, 2)).diff(t),
                derived=rate,
                source="eq01:dpsi_outer_contact",
                correct=OUTER,
            ),
            Fact(
                true=abs(forms[1] / area - 1) < mp.mpf("1e-12"),
                how=f"quadrature to t = 0.1 for I = pi/50: {mp.nstr(area, 7)}, "
                f"printed {mp.nstr(forms[0], 7)}, mended {mp.nstr(forms[1], 7)}",
            ),
        )
    )


@claim("eq01:contact_pt_outer", "6.2", "x_l = -cos psi + C, y_l = sin psi + C before the bounce")
def outer_locus() -> Identity:
    """Differentiate."""
    return _locus(
        _outer_angle(sp.Integer(0)),
        _outer_angle(sp.Rational(-3, 2)),
        t,
        f"y_l = -sin(...) + C, and {OUTER}",
    )


@claim("text:circle", "6.2", "in the bounce the locus is an arc with the radius of the can")
def circle_of_the_bounce() -> Fact:
    """Radius of the exact locus at the bottom of the bounce."""
    radius = release.radius()
    return Fact(
        true=abs(radius - 1) < CLOSE, how=f"exact locus, phi < 3 phi_min: radius {radius:.5f} R"
    )


@claim("text:sense of the locus", "6.2", "the locus rotates clockwise if B_-2 > 0")
def sense_of_the_locus() -> Fact:
    """Velocity Theta (-sin psi, cos psi) with Theta = -Psi < 0 turns with psi; exact motion."""
    heading = sp.Matrix([sp.sin(psi), -sp.cos(psi)])
    bend = heading[0] * heading.diff(psi)[1] - heading[1] * heading.diff(psi)[0]
    clockwise = sp.simplify(bend) < 0 and release.turning() < 0
    return Fact(
        true=bool(clockwise),
        how=f"sympy: heading turns by {sp.simplify(bend)} per unit of psi, which grows for "
        "B_-2 > 0; the exact locus turns "
        f"{'anticlockwise' if release.turning() > 0 else 'clockwise'}",
        correct="anticlockwise, seen from above, if B_-2 > 0 and clockwise if B_-2 < 0",
    )
