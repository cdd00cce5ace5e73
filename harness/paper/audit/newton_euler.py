"""The mechanics from which everything is derived: a rotation, a contact point, Newton and Euler.

Nothing here is taken from the paper. The body is turned by R_WB = Rz(psi) Ry(-phi) Rz(theta), the
contact is the lowest point of the rim, and the forces follow from the laws of motion.
Dimensionless: lengths in R, times in sqrt(R/g), forces in m g.
"""

from functools import cache

import sympy as sp

from harness.paper.audit.symbols import (
    Co,
    Expr,
    Phi,
    Psi,
    S,
    Theta,
    a,
    a_p,
    c,
    c_p,
    h,
    k,
    phi,
    phi_dd,
    psi,
    psi_dd,
    theta,
    theta_dd,
    tidy,
)

ARM = sp.Matrix([-1, 0, -h])
"""From the centre to the contact point, in the frame B."""
VERTICAL = sp.Matrix([0, 0, 1])


def turn_z(angle: Expr) -> Expr:
    """Rotation about z, from turned to unturned components."""
    return sp.Matrix(
        [[sp.cos(angle), -sp.sin(angle), 0], [sp.sin(angle), sp.cos(angle), 0], [0, 0, 1]]
    )


def turn_y(angle: Expr) -> Expr:
    """Rotation about y, from turned to unturned components."""
    return sp.Matrix(
        [[sp.cos(angle), 0, sp.sin(angle)], [0, 1, 0], [-sp.sin(angle), 0, sp.cos(angle)]]
    )


def rate(expression: Expr) -> Expr:
    """Time derivative along any motion."""
    pairs = ((phi, Phi), (psi, Psi), (theta, Theta))
    seconds = ((Phi, phi_dd), (Psi, psi_dd), (Theta, theta_dd))
    total = expression * 0
    for letter, speed in pairs + seconds:
        total += expression.diff(letter) * speed
    return total


def rotation() -> Expr:
    """From the frame B, which does not turn with theta, to the global frame G."""
    return turn_z(psi) * turn_y(-phi)


def vector_of(skew: Expr) -> Expr:
    """Return the vector whose cross product a skew matrix is."""
    return sp.Matrix([skew[2, 1], skew[0, 2], skew[1, 0]])


@cache
def body_rates() -> tuple[Expr, Expr]:
    """Angular velocities of the frame B and of the can, in B, from the rotations themselves."""
    frame = rotation()
    can = frame * turn_z(theta)
    of_frame = vector_of(tidy(frame.T * rate(frame)))
    in_can = vector_of(tidy(can.T * rate(can)))
    return of_frame, tidy(turn_z(theta) * in_can)


@cache
def angular_momentum() -> Expr:
    """Angular momentum about the centre, in B."""
    return sp.diag(a, a, c) * body_rates()[1]


@cache
def centre_velocity() -> Expr:
    """Velocity of the centre in G when the contact point is at rest."""
    return -rotation() * body_rates()[1].cross(ARM)


@cache
def contact_velocity() -> Expr:
    """Velocity in G of the place of contact, which does not turn with theta."""
    return centre_velocity() + rate(rotation() * ARM)


@cache
def contact_force() -> Expr:
    """Force of the plane on the can in G, per m g, as a function of the accelerations."""
    return rate(centre_velocity()) + VERTICAL


@cache
def moment_balance() -> Expr:
    """Residual of the balance of angular momentum about the centre, per m g R, seen in B."""
    turned = rotation()
    momentum = turned * angular_momentum()
    residual = rate(momentum) - (turned * ARM).cross(contact_force())
    return tidy(turned.T * residual)


def papers_accelerations() -> dict[Expr, Expr]:
    """eq01:non_dimensionalised_eom as printed; `equations_of_motion` proves them right."""
    kc = k * c_p
    return {
        psi_dd: (kc * Phi * Theta + ((kc - 2) * Co - h * k * S) * Phi * Psi) / S,
        theta_dd: (
            (-kc * Co + h * k * S) * Phi * Theta
            + (-kc * Co**2 - k * a_p * S**2 + h * k * sp.sin(2 * phi) + 2) * Phi * Psi
        )
        / S,
        phi_dd: (
            ((a_p - c_p) * S * Co - h * sp.cos(2 * phi)) * Psi**2
            - (c_p * S + h * Co) * Theta * Psi
            + (h * S - Co)
        )
        / (a_p + 1),
    }


EQUATIONS = "the equations of motion"
REACH = sp.sqrt(1 + h**2)
BALANCED = {sp.sin(phi): 1 / REACH, sp.cos(phi): h / REACH}


def at_balance(expression: Expr) -> Expr:
    """Insert phi = phi*, where tan phi* = 1/h."""
    return sp.expand_trig(expression).subs(BALANCED)
