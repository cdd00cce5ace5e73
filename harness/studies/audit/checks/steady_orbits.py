"""Section 3: the circles that steady motions describe, and those with the centre at rest."""

import mpmath as mp
import sympy as sp

from harness.studies.audit import paper_can
from harness.studies.audit.checks.equilibria import EQUATIONS, at_balance
from harness.studies.audit.evidence import Both, Fact, Identity
from harness.studies.audit.newton_euler import (
    centre_velocity,
    contact_force,
    papers_accelerations,
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
    phi,
    phi_dd,
    psi,
    psi_dd,
    theta_dd,
)

SIDE = Psi * (Co - h * S) + Theta
FORTH = Phi * (S + h * Co)
RADIUS = SIDE / Psi
STEADY = {Phi: 0, phi_dd: 0, psi_dd: 0, theta_dd: 0}


@claim("eq01:non_dimensionalised_com", "3", "the velocity of the centre without dimensions")
def scaled_velocity() -> Identity:
    """As printed, the parenthesis after the first minus closes only at the end."""
    y = SIDE * sp.cos(psi) - FORTH * sp.sin(psi)
    return Identity(
        printed=sp.Matrix([-(FORTH * sp.cos(psi) - SIDE * sp.sin(psi)), y]),
        corrected=sp.Matrix([-FORTH * sp.cos(psi) - SIDE * sp.sin(psi), y]),
        derived=centre_velocity()[:2, :],
        correct="a parenthesis is missing: x' = -Phi (sin phi + h cos phi) cos psi "
        "- (Psi (cos phi - h sin phi) + Theta) sin psi",
        source="rolling",
    )


@claim("eq01:comcoords", "3", "in steady motion x = r cos(Psi t), y = r sin(Psi t)")
def circle_of_the_centre() -> Identity:
    """Differentiate and compare with the velocity of the centre."""
    place = sp.Matrix([RADIUS * sp.cos(psi), RADIUS * sp.sin(psi)])
    return Identity(
        printed=place.diff(psi) * Psi,
        derived=centre_velocity()[:2, :].subs(STEADY),
        source="rolling",
    )


@claim("text:r_circ", "3", "the radius of that circle")
def radius_of_the_circle() -> Identity:
    """Speed over the rate of turning, squared."""
    velocity = centre_velocity()[:2, :].subs(STEADY)
    return Identity(
        printed=RADIUS**2, derived=velocity.dot(velocity) / Psi**2, source="speed over Psi"
    )


@claim("eq01:comrest", "3", "the centre rests where Psi (cos phi - h sin phi) + Theta = 0")
def centre_at_rest() -> Identity:
    """Insert the Theta that it asks for."""
    velocity = centre_velocity().subs(STEADY).subs(Theta, -Psi * (Co - h * S))
    return Identity(printed=velocity, derived=sp.zeros(3, 1), source="rolling")


@claim("text:r on S_bal", "3", "on S_bal the radius is |Theta/Psi|")
def balanced_radius() -> Identity:
    """At phi* cos phi = h sin phi."""
    return Identity(
        printed=Theta / Psi, derived=sp.simplify(at_balance(RADIUS)), source="the radius at phi*"
    )


@claim("text:balanced at rest", "3", "on S_bal with Theta = 0, Psi != 0 the centre is at rest")
def balanced_and_at_rest() -> Both:
    """Find the radius, which is zero; that the motion is an equilibrium asks for a = c."""
    drive = sp.simplify(at_balance(papers_accelerations()[phi_dd]).subs(Theta, 0))
    needed = sp.solve(sp.numer(sp.together(drive)), a)
    return Both(
        parts=(
            Identity(
                printed=sp.simplify(at_balance(RADIUS)).subs(Theta, 0),
                derived=sp.Integer(0),
                source="the radius at phi*",
            ),
            Fact(true=needed == [c], how="though it is an equilibrium only for a = c"),
        )
    )


@claim("text:no friction at rest", "3", "with the centre at rest there is no friction")
def friction_at_rest() -> Identity:
    """Find the force on a centre that rests: it is vertical."""
    force = contact_force().subs(STEADY).subs(Theta, -Psi * (Co - h * S))
    return Identity(printed=sp.Matrix([0, 0, 1]), derived=force, source="Newton")


def _rest_square(sign: int) -> Expr:
    return (Co - h * S) / (a * S * Co + sign * c * h * S**2)


@claim(
    "text:S_rest",
    "3",
    "Psi^2 = (cos phi - h sin phi)/(a sin phi cos phi + c h sin^2 phi) with the centre at rest",
)
def rates_at_rest() -> Identity:
    """Solve the equation of Phi with Theta = -Psi (cos phi - h sin phi)."""
    square = sp.Symbol("square")
    drive = papers_accelerations()[phi_dd].subs(Theta, -Psi * (Co - h * S))
    linear = sp.expand(drive).subs(Psi, sp.sqrt(square))
    slope = linear.diff(square)
    return Identity(
        printed=_rest_square(1),
        corrected=_rest_square(-1),
        derived=-linear.subs(square, 0) / slope,
        correct="Psi^2 = (cos phi - h sin phi)/(a sin phi cos phi - c h sin^2 phi)",
        source=EQUATIONS,
    )


@claim("text:range of S_rest", "3", "S_rest only exists for phi < phi*")
def range_of_rest() -> Both:
    """With the right sign Psi^2 is positive again beyond arctan(a/(c h)), for a > c."""
    p = paper_can
    edge = mp.atan(p.a / (p.c * p.h))
    angle = mp.radians(60)
    values = {a: p.a, c: p.c, h: p.h, phi: angle}
    square = mp.mpmathify(_rest_square(-1).subs(values))
    motion = {Psi: sp.sqrt(square), Theta: -sp.sqrt(square) * (Co - h * S), Phi: 0}
    left = papers_accelerations()[phi_dd].subs(motion).subs(values)
    steady = bool(abs(mp.mpmathify(sp.N(left, 30))) < mp.mpf("1e-14"))
    return Both(
        parts=(
            Fact(
                true=not (steady and square > 0),
                how=f"at phi = 60 degrees Psi^2 = {mp.nstr(square, 5)} > 0 and phi'' = 0: steady",
                correct="for a > c it exists for phi < phi* and again for phi > arctan(a/(c h)), "
                f"{mp.nstr(mp.degrees(edge), 4)} degrees for the paper's can",
            ),
        )
    )


@claim("text:steady beyond phi*", "3", "there are equilibria for phi_0 > phi*")
def steady_beyond_balance() -> Fact:
    """For any phi_0 and Psi the condition is linear in Theta."""
    p = paper_can
    values = {a: p.a, c: p.c, h: p.h, phi: mp.radians(60), Psi: 1}
    drive = papers_accelerations()[phi_dd].subs({Phi: 0})
    found = sp.solve(drive.subs(values), Theta)[0]
    return Fact(
        true=found.is_real is True,
        how=f"phi = 60 degrees, Psi = 1 is steady with Theta = {mp.nstr(mp.mpmathify(found), 5)}",
    )
