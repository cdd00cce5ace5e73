"""Section 2: frames, rolling, the motion of the centre and of the contact point."""

import sympy as sp

from harness.paper.audit.evidence import Fact, IdentityEvidence, check, check_each
from harness.paper.audit.newton_euler import (
    ARM,
    VERTICAL,
    body_rates,
    centre_velocity,
    contact_force,
    contact_velocity,
    rate,
    rotation,
    turn_y,
    turn_z,
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
    theta,
    theta_dd,
    tidy,
)

ROLLING = "the rotation itself and rolling"
cos_psi, sin_psi = sp.cos(psi), sp.sin(psi)
FORTH = S + h * Co
ASIDE = Psi * (Co - h * S) + Theta
L = -FORTH * phi_dd - (Co - h * S) * Psi**2 - Theta * Psi - (Co - h * S) * Phi**2
M = (Co - h * S) * psi_dd + theta_dd - 2 * FORTH * Phi * Psi
GLOBAL_TO_I = sp.Matrix([[cos_psi, sin_psi, 0], [-sin_psi, cos_psi, 0], [0, 0, 1]])
I_TO_BODY = sp.Matrix([[Co, 0, S], [0, 1, 0], [-S, 0, Co]])


@check("eq01:rotation_matrices")
def rotation_matrices() -> IdentityEvidence:
    """Compare with the transposed turns by psi about z and by -phi about y."""
    return IdentityEvidence(
        printed=sp.Matrix.vstack(GLOBAL_TO_I, I_TO_BODY),
        derived=sp.Matrix.vstack(turn_z(psi).T, turn_y(-phi).T),
        source="turns by psi about z and by -phi about y, which tip the can onto GP",
    )


@check("text:R_GB")
def order_of_the_product() -> IdentityEvidence:
    """Compare with the rotation of the frame B, transposed."""
    return IdentityEvidence(
        printed=GLOBAL_TO_I * I_TO_BODY,
        corrected=I_TO_BODY * GLOBAL_TO_I,
        derived=rotation().T,
        source="the turns by psi about z and then by -phi about y",
    )


@check("text:GP")
def contact_point() -> Fact:
    """Ask whether it is the lowest point of the lower rim."""

    def lowest(arm: Expr) -> bool:
        on_the_rim = arm[0] ** 2 + arm[1] ** 2 == 1 and arm[2] == -h
        outward, along = sp.Matrix([arm[0], arm[1], 0]), sp.Matrix([-arm[1], arm[0], 0])
        # of the height over the rim, with the angle round it
        slope, bend = (rotation() * along)[2], -(rotation() * outward)[2]
        return bool(on_the_rim and sp.simplify(slope) == 0 and sp.simplify(bend - S) == 0)

    return Fact(
        printed=sp.Matrix([-1, 0, -h]),
        holds=lowest,
        how="sympy: over the rim the height has slope 0 and bend R sin(phi) > 0 there",
    )


@check("text:Omega")
def angular_velocities() -> IdentityEvidence:
    """Compare with R^T R' of the frame and of the can."""
    frame, can = body_rates()
    return IdentityEvidence(
        printed=sp.Matrix([Psi * S, -Phi, Psi * Co, Psi * S, -Phi, Psi * Co + Theta]),
        derived=sp.Matrix([*frame, *can]),
        source="R^T dR/dt",
    )


@check("eq01:n2l_lin")
def balance_of_force() -> IdentityEvidence:
    """With the balance of moments the force that it gives conserves energy, as no-slip asks."""
    velocity, spin = centre_velocity(), rotation() * body_rates()[1]
    acceleration, seen = rate(velocity), sp.Matrix(sp.symbols("a_x a_y a_z"))

    def power(force: Expr) -> Expr:
        moment = (rotation() * ARM).cross(force.subs(dict(zip(seen, acceleration, strict=True))))
        return velocity.dot(acceleration) + velocity[2] + spin.dot(moment)

    return IdentityEvidence(
        printed=seen + VERTICAL,  # N + F = m a_G + m g z, per m g
        compared=power,
        derived=sp.Integer(0),
        source="the rate of the energy, with N + F = m a_G + m g z in the balance of moments",
    )


@check("eq01:n2l_rot")
def balance_of_moments() -> IdentityEvidence:
    """Compare with the rate of angular momentum and the moment of the force in G, seen in B."""
    frame, can = body_rates()
    inertia = sp.diag(a, a, c)
    momentum = rotation() * (inertia * can)
    force = sp.Matrix(sp.symbols("f_x f_y f_z", real=True))
    left = inertia * rate(can) + frame.cross(inertia * can)
    seen = rotation().T * sp.Matrix.hstack(rate(momentum), (rotation() * ARM).cross(force))
    return IdentityEvidence(
        printed=sp.Matrix.hstack(left, ARM.cross(rotation().T * force)),
        derived=tidy(seen),
        source="d/dt of the angular momentum and the moment of the force in G",
    )


@check("eq01:constraint")
def rolling_without_slipping() -> IdentityEvidence:
    """Follow the point of the material that is at the contact."""
    point = sp.Matrix(sp.symbols("x_1 x_2 x_3"))
    moving = rate(rotation() * turn_z(theta) * point)
    here = dict(zip(point, turn_z(theta).T * ARM, strict=True))
    return IdentityEvidence(
        printed=rotation() * body_rates()[1].cross(ARM),
        derived=moving.subs(here),
        source="the velocity of the material point",
    )


@check("eq01:com_velocity")
def velocity_of_the_centre() -> IdentityEvidence:
    """As printed, the parenthesis opened after -cos psi closes only at the end."""
    rest = [ASIDE * cos_psi - sin_psi * Phi * FORTH, Phi * (Co - h * S)]
    return IdentityEvidence(
        printed=sp.Matrix([-cos_psi * (Phi * FORTH - sin_psi * ASIDE), *rest]),
        corrected=sp.Matrix([-cos_psi * (Phi * FORTH) - sin_psi * ASIDE, *rest]),
        derived=centre_velocity(),
        source=ROLLING,
    )


PRINTED_X = L * cos_psi + M * sin_psi
RIGHT_X = L * cos_psi - M * sin_psi
PRINTED_Y = M * cos_psi + L * sin_psi


@check("eq01:lin_eom")
def acceleration_of_the_centre() -> IdentityEvidence:
    """Differentiate the velocity."""
    rest = [PRINTED_Y, phi_dd * (Co - h * S) - Phi**2 * FORTH]
    return IdentityEvidence(
        printed=sp.Matrix([PRINTED_X, *rest]),
        corrected=sp.Matrix([RIGHT_X, *rest]),
        derived=rate(centre_velocity()),
        source=ROLLING,
    )


@check_each({"text:L": (L, 0), "text:M": (M, 1)})
def component_of_the_acceleration(printed: Expr, place: int) -> IdentityEvidence:
    """L and M are the components of the acceleration in the frame I."""
    seen = tidy(turn_z(psi).T * rate(centre_velocity()))
    return IdentityEvidence(printed=printed, derived=seen[place], source=ROLLING)


@check("eq01:fx")
def friction_along_x() -> IdentityEvidence:
    """Take the x component of the force."""
    return IdentityEvidence(
        printed=PRINTED_X, corrected=RIGHT_X, derived=contact_force()[0], source=ROLLING
    )


@check("eq01:fy")
def friction_along_y() -> IdentityEvidence:
    """Take the y component of the force."""
    return IdentityEvidence(printed=PRINTED_Y, derived=contact_force()[1], source=ROLLING)


@check("eq01:normal")
def normal_force() -> IdentityEvidence:
    """Take the z component of the force."""
    return IdentityEvidence(
        printed=1 + phi_dd * (Co - h * S) - Phi**2 * FORTH,
        derived=contact_force()[2],
        source=ROLLING,
    )


@check("eq01:contact_locus")
def locus_velocity() -> IdentityEvidence:
    """Differentiate the place of the contact point, which does not turn with theta."""
    turning = body_rates()[1] - Theta * VERTICAL
    return IdentityEvidence(
        printed=centre_velocity() + rotation() * turning.cross(ARM),
        derived=contact_velocity(),
        source="d/dt of the contact point",
    )


@check("text:contact point and the can")
def turning_of_the_contact_point() -> IdentityEvidence:
    """Move it with an angular velocity; compare with the rate of its place."""
    frame, can = body_rates()
    return IdentityEvidence(
        printed=can,
        corrected=frame,
        compared=lambda spin: centre_velocity() + rotation() * spin.cross(ARM),
        derived=contact_velocity(),
        source="d/dt of the contact point",
    )


@check("eq01:contact_point_velocity")
def locus_velocity_in_short() -> IdentityEvidence:
    """Differentiate the place of the contact point; it stays in the plane."""
    return IdentityEvidence(
        printed=sp.Matrix([-Theta * sin_psi, Theta * cos_psi, 0]),
        derived=contact_velocity(),
        source="d/dt of the contact point",
    )


@check("text:sense of the nutation")
def sense_of_the_nutation() -> IdentityEvidence:
    """Compare R_IB of (2.1) with the transposed turn by an angle about y."""
    return IdentityEvidence(
        printed=phi,
        corrected=-phi,
        compared=lambda angle: turn_y(angle).T,
        derived=I_TO_BODY,
        source="R_IB of (2.1)",
    )


@check("text:simultaneous impact")
def simultaneous_impact() -> Fact:
    """Height of the points of the lower rim over the contact point."""
    angle = sp.Symbol("alpha", real=True)
    rim = rotation() * sp.Matrix([sp.cos(angle) + 1, sp.sin(angle), 0])
    return Fact(
        printed=0,
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
        holds=clear,
        how="sympy: the far side of the rim is 2 R sin phi, the top rim 2 H cos phi above the "
        "plane; the steady motion at phi_0 = pi/2 in section 3 is outside: there the can lies on "
        "its side",
    )
