"""The contact of can and plane: force, friction ratio, contact locus.

From eq01:com_velocity and eq01:n2l_lin with the scalings of eq01:scalings. In the intermediate
frame I, whose x axis points along (cos psi, sin psi),

    F_x = -(S + h C) Phi' - (C - h S) Phi^2 - Psi (Psi (C - h S) + Theta)
    F_y = -k Phi (a Psi S + c h (Psi C + Theta))                     (eq01:friction_tangential)
    N   = 1 + (C - h S) Phi' - (S + h C) Phi^2                       (eq01:normal)

in units of m g, and the contact point moves with Theta (-sin psi, cos psi)
(eq01:contact_point_velocity). That is the force of rolling; states of a model with effects bring
their own.

Where a point of a can with effects is, and how fast, takes its effects: with z the vertical, e1 and
e3 the axes of frame B (z = S e1 + C e3) and r the radius to which the rim is rounded, the contact
is at p = -(1 - r) e1 - (h - r) e3 - r z from the middle of the can, a point mass of share q at d
moves the centre of mass by q d/(1 + q), and with the slip u of the material at the contact the
middle has the velocity u - w x p. The contact point itself moves with (u_1 - r Phi, u_2 + (1 - r +
r S) Theta).

The paper is in error in the sign of eq01:friction_tangential, which it prints without the minus,
and in eq01:lin_eom and eq01:fx: the x component is L cos psi - M sin psi, not
L cos psi + M sin psi (checked with sympy in tests/reference/test_derivation.py).
"""

import numpy as np

from reference.equations.nonholonomic import angular_velocity, pulled
from reference.problem.can import Parameters
from reference.problem.effects import IDEAL, EffectError, Effects
from reference.problem.states import Floats, States
from reference.problem.validation import RefusedError

# Of the friction: a normal force no larger is a round-off.
VANISHED = 1e-12


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
    if states.force is not None:
        x, y, z = states.force.T
        return *_turned(x, y, -states.psi), z
    p = parameters
    S, C = np.sin(states.phi), np.cos(states.phi)
    one_minus_C = 2 * np.sin(states.phi / 2) ** 2
    Phi, Psi, s = states.phi_dot, states.psi_dot, states.spin
    phi_ddot = pulled((S, C, one_minus_C), Psi, s, p)
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
    return np.stack([*_turned(F_x, F_y, states.psi), N], axis=-1)


def friction_ratio(states: States, parameters: Parameters) -> Floats:
    """|F|/N, of a rolling can the friction coefficient it needs (eq01:friction_short), shape (n,).

    Infinite where N is not positive, so that the plane would have to pull, or no more than a
    round-off beside the friction. Zero where the plane exerts no force at all: there the can flies.
    """
    if states.force is not None:
        return ratio_of(states.force.T)
    F_x, F_y, N = contact_force(states, parameters)
    return ratio_of((*_turned(F_x, F_y, states.psi), N))


def ratio_of(force: Floats | tuple[Floats, Floats, Floats]) -> Floats:
    """|F|/N of the components of forces, each of shape (n,), as `friction_ratio` has it."""
    F_x, F_y, N = force
    friction = np.hypot(F_x, F_y)
    pushes = VANISHED * friction < N
    if pushes.all():
        return np.asarray(friction / N)
    ratio: Floats = np.divide(friction, N, out=np.full_like(friction, np.inf), where=pushes)
    ratio[(friction == 0) & (N == 0)] = 0.0
    return ratio


def contact_from_middle(states: States, parameters: Parameters, effects: Effects = IDEAL) -> Floats:
    """Contact point relative to the middle of the can, global frame, shape (n, 3), in R.

    The middle is the centre of mass of the can without its point mass.
    """
    along, height = _arm(states, parameters, effects)
    return np.stack([*_turned(along, 0 * along, states.psi), height], axis=-1)


def centre_from_middle(states: States, effects: Effects) -> Floats:
    """Centre of mass, point mass and all, relative to the middle of the can, shape (n, 3), in R."""
    share = 0.0 if effects.mass is None else effects.mass.share
    return np.asarray(share / (1 + share) * point_mass_from_middle(states, effects))


def point_mass_from_middle(states: States, effects: Effects) -> Floats:
    """Point mass relative to the middle of the can, global frame, shape (n, 3), in R; 0 if none."""
    if effects.mass is None:
        return np.zeros((states.phi.size, 3))
    S, C = np.sin(states.phi), np.cos(states.phi)
    across, aside = _turned(effects.mass.x + 0 * S, effects.mass.y + 0 * S, states.theta)
    level = C * across - S * effects.mass.z
    return np.stack([*_turned(level, aside, states.psi), S * across + C * effects.mass.z], axis=-1)


def contact_from_centre(
    states: States, parameters: Parameters, effects: Effects | None = None
) -> Floats:
    """Contact point relative to the centre of mass, global frame, shape (n, 3), in R.

    Parameters
    ----------
    states : States
        Fields of shape (n,).
    parameters : Parameters
    effects : Effects, optional
        Of the problem; needed of states of a model with effects, of which a rounded rim moves the
        contact and a point mass the centre.

    Raises
    ------
    ValueError
        If states of a model with effects come without them.
    """
    effects = _known(states, effects)
    return contact_from_middle(states, parameters, effects) - centre_from_middle(states, effects)


def locus_velocity(states: States, effects: Effects | None = None) -> Floats:
    """Velocity of the contact locus (eq01:contact_point_velocity), shape (n, 2), in sqrt(g R).

    Raises
    ------
    ValueError
        If states of a model with effects come without them.
    """
    r = _known(states, effects).rim
    ahead = -r * states.phi_dot
    aside = (1 - r + r * np.sin(states.phi)) * states.theta_dot
    locus = np.stack(_turned(ahead, aside, states.psi), axis=-1)
    return locus if states.slip is None else locus + states.slip


def middle_velocity(
    states: States, parameters: Parameters, effects: Effects | None = None
) -> Floats:
    """Velocity of the middle of the can (eq01:com_velocity), shape (n, 3), in sqrt(g R).

    Raises
    ------
    ValueError
        If states of a model with effects come without them.
    """
    effects = _known(states, effects)
    r = effects.rim
    S = np.sin(states.phi)
    along, height = _arm(states, parameters, effects)
    lever = _lever(states, parameters, effects)
    one_minus_C = 2 * np.sin(states.phi / 2) ** 2
    # of (1 - r) the lever of the turning about the axis, of the height that of the precession
    axial = states.spin - states.psi_dot * one_minus_C
    aside = (1 - r) * axial - states.psi_dot * S * lever + r * S * states.theta_dot
    velocity = np.stack(
        [*_turned(states.phi_dot * height, aside, states.psi), -states.phi_dot * along], axis=-1
    )
    if states.slip is not None:
        velocity[:, :2] += states.slip
    if states.rise is not None:
        velocity[:, 2] += states.rise
    return velocity


def centre_velocity(
    states: States, parameters: Parameters, effects: Effects | None = None
) -> Floats:
    """Velocity of the centre of mass, point mass and all, shape (n, 3), in sqrt(g R).

    Raises
    ------
    ValueError
        If states of a model with effects come without them.
    """
    effects = _known(states, effects)
    turning = turning_in_world(states)
    lead = np.cross(turning, centre_from_middle(states, effects))
    return middle_velocity(states, parameters, effects) + lead


def turning_in_world(states: States) -> Floats:
    """Angular velocity of the can in the global frame, shape (n, 3), in sqrt(g/R)."""
    w1, w2, w3 = angular_velocity(states).T
    S, C = np.sin(states.phi), np.cos(states.phi)
    return np.stack([*_turned(C * w1 - S * w3, w2, states.psi), S * w1 + C * w3], axis=-1)


def middle_position(
    states: States, parameters: Parameters, effects: Effects | None = None
) -> Floats:
    """Position of the middle of the can, shape (n, 3), in R.

    Raises
    ------
    ValueError
        If the contact locus was not asked for, or states of a model with effects come without them.
    """
    if states.x is None or states.y is None:
        sentence = 'the states have no contact point: ask for outputs={"contact_locus"}'
        raise RefusedError("outputs", None, "contact_locus", sentence)
    height = np.zeros_like(states.x) if states.gap is None else states.gap
    contact = np.stack([states.x, states.y, height], axis=-1)
    return contact - contact_from_middle(states, parameters, _known(states, effects))


def centre_position(
    states: States, parameters: Parameters, effects: Effects | None = None
) -> Floats:
    """Return the position of the centre of mass, shape (n, 3), in R.

    The time integral of `centre_velocity` (eq01:com_velocity), by the contact locus.

    Raises
    ------
    ValueError
        If the contact locus was not asked for, or states of a model with effects come without them.
    """
    effects = _known(states, effects)
    return middle_position(states, parameters, effects) + centre_from_middle(states, effects)


def _known(states: States, effects: Effects | None) -> Effects:
    """Return the given effects, or those of the ideal can for its states."""
    if effects is None and (states.force is not None or states.slip is not None):
        sentence = (
            "the states come of a model with effects: give them as `effects`, such as "
            "`problem.effects`"
        )
        raise EffectError("effects", None, "problem.effects", sentence)
    return IDEAL if effects is None else effects


def _arm(states: States, parameters: Parameters, effects: Effects) -> tuple[Floats, Floats]:
    """Contact from the middle of the can along (cos psi, sin psi, 0) and the vertical."""
    S, C, r = np.sin(states.phi), np.cos(states.phi), effects.rim
    lever = _lever(states, parameters, effects)
    return lever * S - (1 - r) * C, -((1 - r) * S + lever * C + r)


def _lever(states: States, parameters: Parameters, effects: Effects) -> Floats | float:
    """Return the middle's height over the circle of the rim's arc; past pi/2 the other rim's."""
    lever = parameters.h - effects.rim
    # at pi/2 both rims touch, and its round-off is of no side
    past = states.phi > np.pi / 2 * (1 + 1e-12)
    return lever if states.gap is None else np.where(past, -lever, lever)


def _turned(x: Floats, y: Floats, angle: Floats) -> tuple[Floats, Floats]:
    """Turn vectors by an angle about the vertical."""
    cos, sin = np.cos(angle), np.sin(angle)
    return x * cos - y * sin, x * sin + y * cos
