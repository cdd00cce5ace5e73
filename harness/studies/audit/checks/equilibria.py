"""Section 3: what stands still, and what rolls balanced."""

from functools import cache

import mpmath as mp
import sympy as sp

from harness.studies.audit import paper_can
from harness.studies.audit.evidence import Both, Fact, Identity, Number
from harness.studies.audit.newton_euler import papers_accelerations
from harness.studies.audit.registry import claim
from harness.studies.audit.symbols import (
    Expr,
    Phi,
    Psi,
    Theta,
    a,
    a_p,
    c,
    c_p,
    h,
    k,
    phi,
    phi_dd,
    psi_dd,
    theta_dd,
)

EQUATIONS = "the equations of motion"
REACH = sp.sqrt(1 + h**2)
BALANCED = {sp.sin(phi): 1 / REACH, sp.cos(phi): h / REACH}
STIFFNESS = k * c_p * (c_p + h**2)
"""What Theta^2 is multiplied with in the eigenvalue; the paper prints c_p h k (h + c_p)."""


def at_balance(expression: Expr) -> Expr:
    """Insert phi = phi*, where tan phi* = 1/h."""
    return sp.expand_trig(expression).subs(BALANCED)


@claim("eq01:static_eqm", "3", "(0, 0, 0, phi*) is an equilibrium, the only static one")
def standing_on_the_rim() -> Both:
    """Set every rate to zero: the slope h sin phi - cos phi vanishes once in (0, pi/2)."""
    fall = papers_accelerations()[phi_dd].subs({Psi: 0, Theta: 0, Phi: 0})
    rising = sp.simplify((fall * (a_p + 1)).diff(phi) - (h * sp.cos(phi) + sp.sin(phi))) == 0
    return Both(
        parts=(
            Identity(printed=at_balance(fall), derived=sp.Integer(0), source=EQUATIONS),
            Fact(true=rising, how="the slope h cos phi + sin phi > 0, so there is one zero"),
        )
    )


@claim("eq:phistar", "3", "phi* = arctan(1/h)")
def balancing_angle() -> Identity:
    """Put the centre above the contact: R cos phi = H sin phi."""
    angle = sp.atan(1 / h)
    return Identity(
        printed=sp.cos(angle), derived=h * sp.sin(angle), source="the centre above the contact"
    )


@claim("text:phi* in degrees", "3", "phi* is about 34 degrees")
def balancing_angle_in_degrees() -> Number:
    """arctan(1/1.473)."""
    return Number(
        printed="34", value=mp.degrees(mp.atan(1 / paper_can.h)), source="arctan(1/h) in degrees"
    )


def _sideways(form: Expr) -> Expr:
    return Psi * form / REACH


@claim(
    "eq01:bal_eqm", "3", "Psi sin phi* ((a - c) cos phi* Psi - c Theta) = 0 for balanced rolling"
)
def balanced_rolling() -> Identity:
    """Insert phi* into the equation of Phi."""
    lean = (a - c) * h / REACH * Psi
    return Identity(
        printed=_sideways(lean - c * Theta),
        corrected=_sideways(lean - (c + 1 + h**2) * Theta),
        derived=at_balance(papers_accelerations()[phi_dd] * (a_p + 1)),
        correct="Psi sin phi* ((a - c) cos phi* Psi - (c_p + h^2) Theta) = 0",
        source=EQUATIONS,
    )


@claim("text:balanced Theta", "3", "Theta_e = (a - c) cos phi* Psi_e/c on S_bal")
def balanced_rotation() -> Identity:
    """Solve the equation of Phi at phi* for Theta."""
    drive = at_balance(papers_accelerations()[phi_dd])
    return Identity(
        printed=(a - c) * h / REACH * Psi / c,
        corrected=(a - c) * h / REACH * Psi / (c_p + h**2),
        derived=sp.solve(sp.cancel(drive / Psi), Theta)[0],
        correct="Theta_e = (a - c) cos phi* Psi_e/(c_p + h^2)",
        source=EQUATIONS,
    )


@cache
def _characteristic() -> tuple[Expr, Expr]:
    """Characteristic polynomial of straight rolling, and its variable."""
    x = sp.Symbol("lambda")
    rates = papers_accelerations()
    flow = sp.Matrix([rates[psi_dd], rates[theta_dd], rates[phi_dd], Phi])
    jacobian = flow.jacobian([Psi, Theta, Phi, phi]).subs({Psi: 0, Phi: 0})
    return at_balance(jacobian).applyfunc(sp.simplify).charpoly(x).as_expr(), x


def _eigenvalue(stiffness: Expr) -> Expr:
    return (REACH - Theta**2 * stiffness) / (a_p + 1)


@claim(
    "eq01:eigenvalues",
    "3",
    "lambda^2 = (sqrt(h^2+1) - Theta^2 c_p h k (h + c_p))/(a_p + 1), and two eigenvalues are zero",
)
def eigenvalues() -> Identity:
    """Linearise the equations of motion about straight rolling."""
    polynomial, x = _characteristic()
    return Identity(
        printed=x**2 * (x**2 - _eigenvalue(c_p * h * k * (h + c_p))),
        corrected=x**2 * (x**2 - _eigenvalue(STIFFNESS)),
        derived=polynomial,
        correct="lambda^2 = (sqrt(h^2+1) - Theta^2 k c_p (c_p + h^2))/(a_p + 1)",
        source="the characteristic polynomial of the linearised equations",
    )


@claim("text:critical rate", "3", "Theta_crit^2 = sqrt(h^2+1)/(h k c_p (h + c_p))")
def critical_rolling() -> Both:
    """Where the eigenvalues of straight rolling vanish."""
    polynomial, x = _characteristic()
    square = sp.Symbol("square")
    quartic = sp.cancel(polynomial / x**2).subs(x, 0).subs(Theta, sp.sqrt(square))
    identity = Identity(
        printed=REACH / (h * k * c_p * (h + c_p)),
        corrected=REACH / STIFFNESS,
        derived=sp.solve(quartic, square)[0],
        correct="Theta_crit^2 = sqrt(h^2+1)/(k c_p (c_p + h^2))",
        source="where both eigenvalues vanish",
    )
    can = {a: paper_can.a, c: paper_can.c, h: paper_can.h}
    rate = [
        mp.sqrt(mp.mpmathify(form.subs(can)))
        for form in (REACH / (h * k * c_p * (h + c_p)), REACH / STIFFNESS)
    ]
    told = f"for the paper's can {mp.nstr(rate[1], 5)}, as printed {mp.nstr(rate[0], 5)} sqrt(g/R)"
    left = _eigenvalue(STIFFNESS).subs(can | {Theta: rate[1]})
    return Both(parts=(identity, Fact(true=bool(abs(left) < mp.mpf("1e-12")), how=told)))


@claim("text:centre-like", "3", "rolling faster than Theta_crit is centre-like, slower saddle-like")
def stability_of_rolling() -> Fact:
    """Signs of lambda^2 on either side of the critical rate."""
    value = _eigenvalue(STIFFNESS)
    fast = value.subs(Theta, sp.sqrt(2 * REACH / STIFFNESS))
    slow = value.subs(Theta, 0)
    return Fact(
        true=sp.simplify(fast + REACH / (a_p + 1)) == 0 and slow.is_positive is True,
        how="sympy: lambda^2 = -sqrt(h^2+1)/(a_p+1) at twice the critical square, positive at rest",
    )


@claim("eq01:equilibrium", "3", "steady rolling: the right side of the equation of Phi vanishes")
def steady_rolling() -> Identity:
    """With Phi = 0 the other two equations hold by themselves."""
    rates = papers_accelerations()
    still = {Phi: 0}
    printed = (
        ((a_p - c_p) * sp.sin(phi) * sp.cos(phi) - h * sp.cos(2 * phi)) * Psi**2
        - (c_p * sp.sin(phi) + h * sp.cos(phi)) * Theta * Psi
        + (h * sp.sin(phi) - sp.cos(phi))
    )
    return Identity(
        printed=sp.Matrix([printed, 0, 0]),
        derived=sp.Matrix(
            [
                (rates[phi_dd] * (a_p + 1)).subs(still),
                rates[psi_dd].subs(still),
                rates[theta_dd].subs(still),
            ]
        ),
        source=EQUATIONS,
    )


@claim("text:lying and rolling", "3", "phi = pi/2, Psi = Theta = +-sqrt(h/(c_p - h)) is steady")
def rolling_on_its_side() -> Identity:
    """Insert it."""
    there = {phi: sp.pi / 2, Phi: 0, Psi: sp.sqrt(h / (c_p - h)), Theta: sp.sqrt(h / (c_p - h))}
    return Identity(
        printed=sp.simplify(papers_accelerations()[phi_dd].subs(there)),
        derived=sp.Integer(0),
        source=EQUATIONS,
    )
