"""What happens where the can touches the plane: force, friction ratio, contact locus.

From eq01:com_velocity and eq01:n2l_lin with the scalings of eq01:scalings. In the intermediate
frame I, whose x axis points along (cos psi, sin psi),

    F_x = -(S + h C) Phi' - (C - h S) Phi^2 - Psi (Psi (C - h S) + Theta)
    F_y = -k Phi (a Psi S + c h (Psi C + Theta))                     (eq01:friction_tangential)
    N   = 1 + (C - h S) Phi' - (S + h C) Phi^2                       (eq01:normal)

in units of m g, and the contact point moves with Theta (-sin psi, cos psi)
(eq01:contact_point_velocity).

The paper is in error in the sign of eq01:friction_tangential, which it prints without the minus,
and in eq01:lin_eom and eq01:fx: the x component is L cos psi - M sin psi, not
L cos psi + M sin psi (checked with sympy in tests/reference/test_derivation.py).
"""

import numpy as np

from reference.parameters import Parameters
from reference.rolling import nutation_acceleration
from reference.states import Floats, States


def contact_force(states: States, parameters: Parameters) -> tuple[Floats, Floats, Floats]:
    """Force of the plane on the can, in the intermediate frame I.

    Parameters
    ----------
    states : States
        Fields of shape (n,).
    parameters : Parameters

    Returns
    -------
    F_x, F_y, N : ndarray, shape (n,)
        Along (cos psi, sin psi, 0), (-sin psi, cos psi, 0) and the vertical, in m g.
    """
    p = parameters
    S, C = np.sin(states.phi), np.cos(states.phi)
    one_minus_C = 2 * np.sin(states.phi / 2) ** 2
    Phi, Psi, s = states.phi_dot, states.psi_dot, states.spin
    phi_ddot = nutation_acceleration(states.phi, Psi, s, p)
    lateral = s - Psi * (one_minus_C + p.h * S)
    F_x = -(S + p.h * C) * phi_ddot - (C - p.h * S) * Phi**2 - Psi * lateral
    F_y = -p.k * Phi * (p.a * Psi * S + p.c * p.h * (s - Psi * one_minus_C))
    N = 1 + (C - p.h * S) * phi_ddot - (S + p.h * C) * Phi**2
    return F_x, F_y, N


def contact_force_in_world(states: States, parameters: Parameters) -> Floats:
    """Force of the plane on the can in the global frame, shape (n, 3), in m g.

    That of rolling, unless the states bring their own.
    """
    if states.force is not None:
        return states.force
    F_x, F_y, N = contact_force(states, parameters)
    cos, sin = np.cos(states.psi), np.sin(states.psi)
    return np.stack([F_x * cos - F_y * sin, F_x * sin + F_y * cos, N], axis=-1)


def friction_ratio(states: States, parameters: Parameters) -> Floats:
    """|F|/N, of a rolling can the friction coefficient it needs (eq01:friction_short), shape (n,).

    Infinite where N is not positive: there the plane would have to pull.
    """
    if states.force is None:
        F_x, F_y, N = contact_force(states, parameters)
    else:
        F_x, F_y, N = states.force.T
    friction = np.hypot(F_x, F_y)
    return np.divide(friction, N, out=np.full_like(friction, np.inf), where=N > 0)


def contact_from_centre(states: States, parameters: Parameters) -> Floats:
    """Contact point relative to the centre of mass, global frame, shape (n, 3), in R."""
    p = parameters
    S, C = np.sin(states.phi), np.cos(states.phi)
    reach = C - p.h * S
    return np.stack(
        [-reach * np.cos(states.psi), -reach * np.sin(states.psi), -(S + p.h * C)], axis=-1
    )


def locus_velocity(states: States) -> Floats:
    """Velocity of the contact locus (eq01:contact_point_velocity), shape (n, 2), in sqrt(g R)."""
    return np.stack(
        [-states.theta_dot * np.sin(states.psi), states.theta_dot * np.cos(states.psi)], axis=-1
    )


def centre_velocity(states: States, parameters: Parameters) -> Floats:
    """Velocity of the centre of mass (eq01:com_velocity), shape (n, 3), in sqrt(g R)."""
    p = parameters
    S, C = np.sin(states.phi), np.cos(states.phi)
    ahead = -states.phi_dot * (S + p.h * C)
    aside = states.spin - states.psi_dot * (2 * np.sin(states.phi / 2) ** 2 + p.h * S)
    cos, sin = np.cos(states.psi), np.sin(states.psi)
    return np.stack(
        [ahead * cos - aside * sin, ahead * sin + aside * cos, states.phi_dot * (C - p.h * S)],
        axis=-1,
    )


def centre_position(states: States, parameters: Parameters) -> Floats:
    """Position of the centre of mass, shape (n, 3), in R.

    Raises
    ------
    ValueError
        If the contact locus was not asked for.
    """
    if states.x is None or states.y is None:
        raise ValueError('the states have no contact point: ask for outputs={"contact_locus"}')
    contact = np.stack([states.x, states.y, np.zeros_like(states.x)], axis=-1)
    return contact - contact_from_centre(states, parameters)
