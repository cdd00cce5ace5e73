"""Sections 2, 3 and 6.2: what the text says of frames, contact and balance."""

import sympy as sp

from harness.paper.audit.checks.kinematics import I_TO_BODY
from harness.paper.audit.evidence import Fact, IdentityEvidence, check
from harness.paper.audit.newton_euler import rotation, turn_y
from harness.paper.audit.symbols import Expr, S, h, phi


@check("text:sense of the nutation")
def sense_of_the_nutation() -> IdentityEvidence:
    """Compare R_IB of (2.1) with the transposed turn by an angle about y."""
    return IdentityEvidence(
        printed=phi,
        corrected=-phi,
        compared=lambda angle: turn_y(angle).T,
        derived=I_TO_BODY,
        others=(phi, -2 * phi, sp.pi - phi),
        source="R_IB of (2.1)",
    )


@check("text:simultaneous impact")
def simultaneous_impact() -> Fact:
    """Height of the points of the lower rim over the contact point."""
    angle = sp.Symbol("alpha", real=True)
    rim = rotation() * sp.Matrix([sp.cos(angle) + 1, sp.sin(angle), 0])
    return Fact(
        printed=0,
        others=(sp.pi / 6, sp.atan(1 / h)),
        holds=lambda tilt: sp.simplify(rim[2].subs(phi, tilt)) == 0,
        how=f"sympy: the rim is {sp.factor(rim[2])} R above the contact point",
    )


@check("text:range of phi")
def one_point_of_contact() -> Fact:
    """Heights of the opposite point of the rim and of the point over the contact, on the top."""
    across, above = 2 * S, 2 * h * sp.cos(phi)

    def clear(ends: tuple[Expr, Expr]) -> bool:
        """Whether both heights are positive inside, and one of them vanishes at either end."""
        middle = (ends[0] + ends[1]) / 2
        inside = all((height.subs(phi, middle) / 1).is_positive for height in (across, above))
        return inside and across.subs(phi, ends[0]) == 0 and above.subs(phi, ends[1]) == 0

    return Fact(
        printed=(sp.Integer(0), sp.pi / 2),
        others=((sp.Integer(0), sp.pi), (sp.Integer(0), sp.pi / 4), (-sp.pi / 2, sp.pi / 2)),
        holds=clear,
        how="sympy: the far side of the rim is 2 R sin phi, the top rim 2 H cos phi above the "
        "plane; the steady motion at phi_0 = pi/2 in section 3 is outside: there the can lies on "
        "its side",
    )
