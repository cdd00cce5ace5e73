"""Section 6: the sign of the turn, the contact locus, and the friction that rolling asks for."""

import mpmath as mp
import numpy as np
import sympy as sp

from harness.studies.audit import flat_motion, paper_can, release
from harness.studies.audit.evidence import Both, Fact, Identity, Number
from harness.studies.audit.registry import claim
from harness.studies.audit.symbols import (
    A,
    H,
    I,
    Psi,
    R,
    T,
    Theta,
    a_p,
    c_p,
    eps,
    h,
    k,
    m,
    psi,
)
from reference.exact import exact_bounces

q = sp.Symbol("a_p", positive=True)
t = sp.Symbol("t", positive=True)


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
                true=bool(signs[0] * signs[1] < 0) and abs(line / exact - 1) < 0.05,
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
    return Fact(true=share > 0.97, how=f"{share:.2%} of {int(there.sum())} bouncing releases agree")


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
                f"{'anticlockwise' if release.turning() > 0 else 'clockwise'}, as the mended form does",
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
        true=abs(radius - 1) < 0.01, how=f"exact locus, phi < 3 phi_min: radius {radius:.5f} R"
    )


@claim("text:sense of the locus", "6.2", "the locus rotates clockwise if B_-2 > 0")
def sense_of_the_locus() -> Fact:
    """Velocity Theta (-sin psi, cos psi) with Theta = -Psi < 0 turns with psi; exact motion."""
    heading = sp.Matrix([sp.sin(psi), -sp.cos(psi)])
    bend = heading[0] * heading.diff(psi)[1] - heading[1] * heading.diff(psi)[0]
    clockwise = sp.simplify(bend) < 0 and release.turning() < 0
    return Fact(
        true=bool(clockwise),
        how=f"sympy: heading turns by {sp.simplify(bend)} per unit of psi, which grows for B_-2 > 0; "
        f"the exact locus turns {'anticlockwise' if release.turning() > 0 else 'clockwise'}",
        correct="anticlockwise, seen from above, if B_-2 > 0 and clockwise if B_-2 < 0",
    )


@claim("eq01:friction_short", "6.3", "|F|/N = sqrt(F_x^2 + F_y^2)/N")
def friction_ratio() -> Fact:
    """It does not depend on the frame: the two components in G and in I."""
    x, y = sp.symbols("F_x F_y", real=True)
    turned = sp.Matrix([[sp.cos(psi), sp.sin(psi)], [-sp.sin(psi), sp.cos(psi)]]) * sp.Matrix(
        [x, y]
    )
    same = sp.simplify(turned.dot(turned) - x**2 - y**2) == 0
    return Fact(true=same, how="definition; the same in G and in I")


@claim("eq01:required_friction", "6.3", "|F|/N = h/a_p = m R H/(A + m H^2) in the bounce")
def required_friction() -> Both:
    """Leading terms for Psi = B/phi^2; and with letters."""
    y, b = sp.symbols("y b", positive=True)
    # eq01:Phi, L and N for small phi: the terms in B_-2^2/phi^3 and B_-2^2/phi^3 alone
    bend = a_p * b**2 / ((a_p + 1) * y**3)
    forward = -h * bend + h * y * (b / y**2) ** 2
    return Both(
        parts=(
            Identity(printed=h / a_p, derived=sp.simplify(forward / bend), source="eq01:Phi and L"),
            Identity(printed=m * R * H / (A + m * H**2), derived=h / a_p, source="eq01:scalings"),
        )
    )


@claim("text:peak friction", "6.3", "the largest |F|/N is 0.508")
def peak_friction() -> Number:
    """The exact motion of the paper's release."""
    return Number(
        printed="0.508",
        value=release.bounce().bounces[0].peak_friction_ratio,
        source="exact motion",
    )


@claim("text:predicted friction", "6.3", "eq01:required_friction gives 0.508")
def predicted_friction() -> Number:
    """h/a_p from the printed groups, which are rounded."""
    low, high = paper_can.reach(lambda h_, a_: h_ / a_, "1.473", "2.897")
    return Number(
        printed="0.508",
        value=mp.mpf("1.473") / mp.mpf("2.897"),
        low=low,
        high=high,
        source="h/a_p with the printed a_p = 2.897",
    )


@claim("text:friction in short", "7", "mu of about 0.51 avoids slipping")
def friction_in_short() -> Number:
    """Two digits."""
    return Number(
        printed="0.51",
        value=release.bounce().bounces[0].peak_friction_ratio,
        source="exact motion",
    )


@claim("text:uniform cylinder", "6.3", "for a uniform cylinder |F|/N = 12 h/(3 + 13 h^2)")
def uniform_cylinder() -> Both:
    """Integrate the moment of inertia of a cylinder of height 2 H."""
    r, angle, z = sp.symbols("r alpha z", positive=True)
    volume = 2 * sp.pi * h
    lever = ((r * sp.sin(angle)) ** 2 + z**2) * r
    moment = sp.integrate(lever, (r, 0, 1), (angle, 0, 2 * sp.pi), (z, -h, h)) / volume
    ratio = sp.simplify(h / (moment + h**2))
    numeric = mp.quad(lambda s: mp.mpf(1) / 4 + s**2, [-2, 2]) / 4  # h = 2, slice by slice
    return Both(
        parts=(
            Identity(
                printed=12 * h / (3 + 13 * h**2),
                corrected=12 * h / (3 + 16 * h**2),
                derived=ratio,
                source="the moment of inertia of a cylinder of height 2 H, integrated",
                correct="12 h/(3 + 16 h^2), since A = m (3 R^2 + (2H)^2)/12",
            ),
            Fact(
                true=abs(numeric - (mp.mpf(3) + 16) / 12) < mp.mpf("1e-12"),
                how=f"quadrature at h = 2: A/(m R^2) = {mp.nstr(numeric, 8)}, "
                "printed (3 + h^2)/12 = 0.58333",
            ),
        )
    )


@claim("text:largest friction", "6.3", "its maximum is mu = 0.96")
def largest_friction() -> Both:
    """The maximum of the mended form; of the printed form it is 0.96."""
    right, printed = (sp.sqrt(3) / 4, 16), (sp.sqrt(sp.Rational(3, 13)), 13)
    values = [sp.simplify(12 * at / (3 + n * at**2)) for at, n in (right, printed)]
    slope = sp.simplify((12 * h / (3 + 16 * h**2)).diff(h).subs(h, right[0]))
    return Both(
        parts=(
            Fact(true=slope == 0, how="sympy: slope 0 there"),
            Number(
                printed="0.96",
                value=mp.mpmathify(sp.N(values[0], 30)),
                source="maximum of 12 h/(3 + 16 h^2)",
                also=f"that is sqrt(3)/2; the printed form has {sp.N(values[1], 4)}",
            ),
        )
    )


@claim("text:height of largest friction", "6.3", "at h = sqrt(39)/13, about 0.48")
def height_of_largest_friction() -> Number:
    """Where the mended form is largest."""
    found = sp.solve((12 * h / (3 + 16 * h**2)).diff(h), h)
    return Number(
        printed="0.48",
        value=mp.mpmathify(sp.N(found[0], 30)),
        source="maximum of 12 h/(3 + 16 h^2)",
        also="that is sqrt(3)/4",
    )
