"""Section 6: the sign of the turn, the contact locus, and the friction that rolling asks for."""

import mpmath as mp
import numpy as np
import sympy as sp

from harness.paper.audit import flat_motion, paper_can, release
from harness.paper.audit.evidence import Both, Fact, IdentityEvidence
from harness.paper.audit.mutations import mutated
from harness.paper.audit.newton_euler import ARM, centre_velocity, rate, rotation
from harness.paper.audit.registry import claim
from harness.paper.audit.symbols import I, Psi, T, Theta, a, c, c_p, eps, h, k, psi
from reference.integrable.cycle import exact_bounces

q = sp.Symbol("a_p", positive=True)
t = sp.Symbol("t", positive=True)
CLOSE = 0.02
"""What a plot shows as the same: the paper says 'excellent agreement', to leading order."""


def _of_the_can(form: sp.Expr) -> float:
    """Return a form in a, c and h as a number."""
    return float(form.subs({a: paper_can.a, c: paper_can.c, h: paper_can.h}))


@claim("eq01:boundary", "6.1", "the turn changes sign on Theta = (2/(c_p k) - 1) Psi")
def boundary() -> Both:
    """Where B_-2 vanishes to leading order; and the exact slope at phi = pi/100."""
    kc = k * c_p
    with mp.workdps(30):
        columns = [flat_motion.constants(paper_can.PHI, *pair)[1] for pair in ((1, 0), (0, 1))]
    exact = float(-columns[0] / columns[1])
    slope = 2 / kc - 1
    rates = np.array([0.99, 1.01]) * exact * 0.01
    sides = exact_bounces(
        a=0.727, c=0.615, h=1.473, phi=float(paper_can.PHI), psi_dot=0.01, theta_dot=rates
    )
    signs = np.sign(sides.angle_of_turn)
    return Both(
        parts=(
            IdentityEvidence(
                printed=slope,
                derived=sp.solve(-kc / 2 * Theta + Psi * (1 - kc / 2), Theta)[0] / Psi,
                source="eq01:b_sol_later",
            ),
            Fact(
                printed=slope,
                holds=lambda form: (
                    bool(signs[0] * signs[1] < 0) and abs(_of_the_can(form) / exact - 1) < CLOSE
                ),
                others=mutated(slope),
                how=f"slope {_of_the_can(slope):.4f}; exact at phi = pi/100 {exact:.4f}, where the "
                "turn does change its sign",
            ),
        )
    )


@claim("caption:fig01:left_or_right", "6.1", "the computed map agrees with eq01:boundary")
def sign_map() -> Fact:
    """Releases whose turn has the sign that eq01:boundary says, unless they are close to it."""
    axis = np.linspace(-1, 1, 120) * float(paper_can.SECOND)
    x, y = (v.ravel() for v in np.meshgrid(axis, 4 * axis))
    cycles = exact_bounces(
        a=0.727, c=0.615, h=1.473, phi=float(paper_can.PHI), psi_dot=x, theta_dot=y
    )
    found = np.sign(cycles.angle_of_turn)

    def wrong(slope: float) -> tuple[int, int]:
        # the line leaves out terms of order phi: three in a hundred
        far = cycles.bounced & (np.abs(y / (slope * x) - 1) > CLOSE)
        return int(np.count_nonzero((found != np.sign(slope * x - y)) & far)), int(far.sum())

    line = _of_the_can(2 / (k * c_p) - 1)
    return Fact(
        printed=line,
        holds=lambda slope: wrong(slope)[0] == 0,
        others=(1.1 * line, line / 1.1, -line, 1 / line),
        how=f"{wrong(line)[0]} of {wrong(line)[1]} bouncing releases more than {CLOSE:.0%} off the "
        "line turn the other way",
    )


@claim("text:locus in T", "6.2", "dx_l/dT = -dpsi/dT (-sin psi, cos psi)")
def inner_locus_velocity() -> IdentityEvidence:
    """Differentiate the place of the contact point and insert Theta = -Psi."""
    moved = centre_velocity() + rate(rotation() * ARM)
    return IdentityEvidence(
        printed=-Psi * sp.Matrix([-sp.sin(psi), sp.cos(psi)]),
        derived=moved[:2, :].subs(Theta, -Psi),
        source="d/dt of the contact point with Theta = -Psi",
    )


ARC = sp.sqrt((q + 1) / q) * sp.atan(I * T / sp.sqrt(q))
ARC_PRINTED = sp.sqrt(q + 1) / q * sp.atan(I * T / sp.sqrt(q))


def _place(angle: sp.Expr, sign: int) -> sp.Matrix:
    return sp.Matrix([-sp.cos(angle), sign * sp.sin(angle)])


def _locus(printed: sp.Expr, right: sp.Expr, variable: sp.Symbol, correct: str) -> IdentityEvidence:
    velocity = -right.diff(variable) * sp.Matrix([-sp.sin(right), sp.cos(right)])
    return IdentityEvidence(
        printed=_place(printed, 1),
        corrected=_place(right, -1),
        compared=lambda place: place.diff(variable),
        derived=velocity,
        source="eq01:contact_point_velocity",
        correct=correct,
    )


@claim("eq01:contact_pt_inner", "6.2", "x_l = -cos psi + C, y_l = sin psi + C in the bounce")
def inner_locus() -> IdentityEvidence:
    """Differentiate."""
    told = "y_l = -sin(...) + C, and sqrt((a_p+1)/a_p) arctan(...)"
    return _locus(ARC_PRINTED, ARC, T, told)


@claim("eq01:dpsi_outer_contact", "6.2", "dpsi/dt = 4 eps^(1/2) sqrt(a_p+1)/(I - t^2)^2")
def outer_rate() -> IdentityEvidence:
    """sqrt(a_p+1) B_-2/phi^2 on the leading outer solution."""
    phi_0 = (I - t**2) / 2
    return IdentityEvidence(
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
def outer_angle() -> IdentityEvidence:
    """Differentiate."""
    return IdentityEvidence(
        printed=_outer_angle(sp.Integer(0)),
        corrected=_outer_angle(sp.Rational(-3, 2)),
        compared=lambda angle: angle.diff(t),
        derived=4 * sp.sqrt(eps) * sp.sqrt(q + 1) / (I - t**2) ** 2,
        source="eq01:dpsi_outer_contact",
        correct=OUTER,
    )


@claim("eq01:contact_pt_outer", "6.2", "x_l = -cos psi + C, y_l = sin psi + C before the bounce")
def outer_locus() -> IdentityEvidence:
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
        printed=1.0,
        holds=lambda said: abs(radius - said) < CLOSE,
        others=(0.95, 1.05, float(paper_can.h)),
        how=f"exact locus, phi < 3 phi_min: radius {radius:.5f} R",
    )


@claim("text:sense of the locus", "6.2", "the locus rotates clockwise if B_-2 > 0")
def sense_of_the_locus() -> Fact:
    """Velocity Theta (-sin psi, cos psi) with Theta = -Psi < 0 turns with psi; exact motion."""
    heading = sp.Matrix([sp.sin(psi), -sp.cos(psi)])
    bend = heading[0] * heading.diff(psi)[1] - heading[1] * heading.diff(psi)[0]
    senses = {
        "clockwise" if x < 0 else "anticlockwise" for x in (sp.simplify(bend), release.turning())
    }
    return Fact(
        printed="clockwise",
        holds=lambda word: senses == {word},
        corrected="anticlockwise",
        others=("clockwise",),
        how=f"sympy: heading turns by {sp.simplify(bend)} per unit of psi, which grows for "
        "B_-2 > 0; the exact locus turns "
        f"{'anticlockwise' if release.turning() > 0 else 'clockwise'}",
        correct="anticlockwise, seen from above, if B_-2 > 0 and clockwise if B_-2 < 0",
    )
