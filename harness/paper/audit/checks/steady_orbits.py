"""Section 3: the circles that steady motions describe, and those with the centre at rest."""

import mpmath as mp
import sympy as sp

from harness.paper.audit import paper_can
from harness.paper.audit.checks.equilibria import EQUATIONS, at_balance
from harness.paper.audit.evidence import Fact, IdentityEvidence, check
from harness.paper.audit.newton_euler import (
    centre_velocity,
    contact_force,
    papers_accelerations,
    rate,
)
from harness.paper.audit.symbols import (
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


@check("eq01:non_dimensionalised_com")
def scaled_velocity() -> IdentityEvidence:
    """As printed, the parenthesis after the first minus closes only at the end."""
    y = SIDE * sp.cos(psi) - FORTH * sp.sin(psi)
    return IdentityEvidence(
        printed=sp.Matrix([-(FORTH * sp.cos(psi) - SIDE * sp.sin(psi)), y]),
        corrected=sp.Matrix([-FORTH * sp.cos(psi) - SIDE * sp.sin(psi), y]),
        derived=centre_velocity()[:2, :],
        source="rolling",
    )


@check("eq01:comcoords")
def circle_of_the_centre() -> IdentityEvidence:
    """Differentiate and compare with the velocity of the centre."""
    return IdentityEvidence(
        printed=sp.Matrix([RADIUS * sp.cos(psi), RADIUS * sp.sin(psi)]),
        compared=lambda place: place.diff(psi) * Psi,
        derived=centre_velocity()[:2, :].subs(STEADY),
        source="rolling",
    )


@check("text:r_circ")
def radius_of_the_circle() -> IdentityEvidence:
    """Speed over the rate of turning, squared."""
    velocity = centre_velocity()[:2, :].subs(STEADY)
    return IdentityEvidence(
        printed=RADIUS**2, derived=velocity.dot(velocity) / Psi**2, source="speed over Psi"
    )


@check("eq01:comrest")
def centre_at_rest() -> IdentityEvidence:
    """Insert the Theta that it asks for."""
    velocity = centre_velocity().subs(STEADY)
    return IdentityEvidence(
        printed=SIDE,
        compared=lambda condition: velocity.subs(Theta, sp.solve(condition, Theta)[0]),
        derived=sp.zeros(3, 1),
        others=(SIDE - 2 * Theta, SIDE + Theta, Psi * (Co + h * S) + Theta),
        source="rolling",
    )


@check("text:r on S_bal")
def balanced_radius() -> IdentityEvidence:
    """At phi* cos phi = h sin phi; squared."""
    return IdentityEvidence(
        printed=(Theta / Psi) ** 2, derived=at_balance(RADIUS) ** 2, source="the radius at phi*"
    )


@check("text:balanced at rest")
def balanced_and_at_rest() -> IdentityEvidence:
    """Insert Theta = 0 into the radius; that it is steady asks for a = c, which the if allows."""
    return IdentityEvidence(
        printed=sp.Integer(0),
        compared=lambda rotation: at_balance(RADIUS).subs(Theta, rotation),
        derived=sp.Integer(0),
        source="the radius at phi*",
    )


@check("text:no friction at rest")
def friction_at_rest() -> IdentityEvidence:
    """Find the force on a centre that rests: it is vertical."""
    force = contact_force().subs(STEADY).subs(Theta, -Psi * (Co - h * S))
    return IdentityEvidence(printed=sp.zeros(2, 1), derived=force[:2, :], source="Newton")


def _rest_square(sign: int) -> Expr:
    return (Co - h * S) / (a * S * Co + sign * c * h * S**2)


@check("text:S_rest")
def rates_at_rest() -> IdentityEvidence:
    """Solve the equation of Phi with Theta = -Psi (cos phi - h sin phi)."""
    square = sp.Symbol("square")
    drive = papers_accelerations()[phi_dd].subs(Theta, -Psi * (Co - h * S))
    linear = sp.expand(drive).subs(Psi, sp.sqrt(square))
    slope = linear.diff(square)
    return IdentityEvidence(
        printed=_rest_square(1),
        corrected=_rest_square(-1),
        derived=-linear.subs(square, 0) / slope,
        source=EQUATIONS,
    )


@check("text:range of S_rest")
def range_of_rest() -> Fact:
    """With the right sign Psi^2 is positive again beyond arctan(a/(c h)), for a > c."""
    p = paper_can
    edge = mp.atan(p.a / (p.c * p.h))
    star, end = mp.atan(1 / p.h), mp.pi / 2
    letters = sp.Symbol("square", positive=True)
    drive = papers_accelerations()[phi_dd].subs(Theta, -Psi * (Co - h * S)).subs(Phi, 0)
    condition = sp.expand(drive.subs({a: p.a, c: p.c, h: p.h})).subs(Psi, sp.sqrt(letters))
    rest, slope = condition.subs(letters, 0), sp.expand(condition).coeff(letters)
    square = sp.lambdify(phi, -rest / slope, "mpmath")  # Psi^2 from phi'' = 0
    places = [end * n / 400 for n in range(1, 400)]
    found = [bool(square(place) > 0) for place in places]

    def right(ranges: tuple[tuple[mp.mpf, mp.mpf], ...]) -> bool:
        return found == [any(low < place < high for low, high in ranges) for place in places]

    return Fact(
        printed=((0, star),),
        holds=right,
        corrected=((0, star), (edge, end)),
        others=(((0, star),), ((0, edge),), ((0, end),), ((star, end),)),
        how=f"phi'' = 0 asks for Psi^2 = {mp.nstr(square(mp.radians(60)), 5)} > 0 at phi = 60 "
        "degrees too",
        correct="for a > c it exists for phi < phi* and again for phi > arctan(a/(c h)), "
        f"{mp.nstr(mp.degrees(edge), 4)} degrees for the paper's can",
    )


@check("text:steady beyond phi*")
def steady_beyond_balance() -> Fact:
    """For any phi_0 and Psi the condition is linear in Theta."""
    p = paper_can
    rates = papers_accelerations()
    values = {a: p.a, c: p.c, h: p.h, phi: mp.radians(60), Psi: 1, Phi: 0}
    found = sp.solve(rates[phi_dd].subs(values), Theta)[0]
    left = [abs(x.subs(values).subs(Theta, found)) for x in rates.values()]
    # solved in double precision
    steady = found.is_real is True and max(left) < 1e-12  # noqa: PLR2004
    return Fact(
        printed="exist",
        holds=lambda word: (word == "exist") == steady,
        others=("do not exist",),
        how=f"phi = 60 degrees, Psi = 1 is steady with Theta = {mp.nstr(mp.mpmathify(found), 5)}",
    )


@check("text:circle for all")
def circles() -> Fact:
    """Bend of the path of the centre, over its speed squared, for several rates of precession."""
    velocity = centre_velocity()
    bend = (velocity[0] * rate(velocity)[1] - velocity[1] * rate(velocity)[0]).subs(STEADY)
    per_speed = sp.simplify(bend / velocity[:2, :].dot(velocity[:2, :]).subs(STEADY))
    return Fact(
        printed=(sp.Integer(0), Psi),
        corrected=(Psi,),
        others=((sp.Integer(0), Psi), (sp.Integer(0),)),
        holds=lambda said: all(per_speed.subs(Psi, precession) != 0 for precession in said),
        how=f"sympy: the path of the centre turns at the rate {per_speed}, which is 0 in straight "
        "rolling",
    )
