"""Section 3: the path of the centre in steady motion, a circle, a straight line or a point."""

import sympy as sp

from harness.paper.audit.evidence import Both, Fact, IdentityEvidence, check
from harness.paper.audit.newton_euler import (
    EQUATIONS,
    at_balance,
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
    h,
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
        source="rolling",
    )


@check("text:r on S_bal")
def balanced_radius() -> IdentityEvidence:
    """At phi* cos phi = h sin phi; squared."""
    return IdentityEvidence(
        printed=(Theta / Psi) ** 2, derived=at_balance(RADIUS) ** 2, source="the radius at phi*"
    )


@check("text:no friction at rest")
def friction_at_rest() -> IdentityEvidence:
    """Find the force on a centre that rests: it is vertical."""
    force = contact_force().subs(STEADY).subs(Theta, -Psi * (Co - h * S))
    return IdentityEvidence(printed=sp.zeros(2, 1), derived=force[:2, :], source="Newton")


@check("text:circle for all")
def circles() -> Fact:
    """Bend of the path of the centre, over its speed squared, for several rates of precession."""
    velocity = centre_velocity()
    bend = (velocity[0] * rate(velocity)[1] - velocity[1] * rate(velocity)[0]).subs(STEADY)
    per_speed = sp.simplify(bend / velocity[:2, :].dot(velocity[:2, :]).subs(STEADY))
    return Fact(
        printed=(sp.Integer(0), Psi),
        corrected=(Psi,),
        holds=lambda said: all(per_speed.subs(Psi, precession) != 0 for precession in said),
        how=f"sympy: the path of the centre turns at the rate {per_speed}, which is 0 in straight "
        "rolling",
    )


@check("text:straight rolling")
def straight_rolling() -> Both:
    """Speed of the centre, how fast its direction turns, and that the motion is steady."""
    rates = papers_accelerations()
    velocity = centre_velocity().subs({Phi: 0, Psi: 0})

    def left(precession: Expr) -> Expr:
        moving = centre_velocity()
        turning = moving[0] * rate(moving)[1] - moving[1] * rate(moving)[0]
        parts = [rates[psi_dd], rates[theta_dd], turning.subs(STEADY)]
        still = [x.subs({Phi: 0, Psi: precession}) for x in parts]
        return sp.Matrix([at_balance(rates[phi_dd]).subs({Phi: 0, Psi: precession}), *still])

    return Both(
        IdentityEvidence(
            printed=Theta**2, derived=sp.simplify(velocity.dot(velocity)), source="rolling"
        ),
        IdentityEvidence(
            printed=sp.Integer(0),  # Psi
            compared=left,
            derived=sp.zeros(4, 1),
            source=f"{EQUATIONS} and the turning of the velocity",
        ),
    )
