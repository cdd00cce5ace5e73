"""The energy, which rolling conserves, as do all effects but friction, drag and shaking.

Per m g R, with the can and its point mass (share q, at d from its middle) each by itself:

    E = (a (w_1^2 + w_2^2) + c w_3^2 + |v|^2 + q |v + w x d|^2)/2 - g.(x + q (x + d)),

w the angular velocity in frame B, x and v position and velocity of the middle of the can, which
heed a rounded rim and the slip (`reference.equations.reaction_force`). Of an ideal can that is
(a (Psi^2 S^2 + Phi^2) + c w_3^2 + |v|^2)/2 + S + h C.
"""

import numpy as np

from reference.equations.nonholonomic import angular_velocity
from reference.equations.reaction_force import (
    contact_from_middle,
    middle_position,
    middle_velocity,
    point_mass_from_middle,
    turning_in_world,
)
from reference.problem.can import Parameters
from reference.problem.effects import IDEAL, Effects
from reference.problem.states import Floats, States


def energy(states: States, parameters: Parameters, effects: Effects | None = None) -> Floats:
    """Energy over m g R, zero of height in the plane, shape (n,).

    The constant part of gravity has a potential, and counts; what shaking adds to it has none: it
    supplies energy.

    Parameters
    ----------
    states : States
        Fields of shape (n,); with the contact point where the plane is tilted.
    parameters : Parameters
    effects : Effects, optional
        Of the problem; needed of states of a model with effects.

    Raises
    ------
    ValueError
        If states of a model with effects come without them, or those of a tilted plane without the
        contact point.
    """
    p, share = parameters, 0.0
    w1, w2, w3 = angular_velocity(states).T
    velocity = middle_velocity(states, p, effects)
    kinetic = p.a * (w1 * w1 + w2 * w2) + p.c * w3 * w3 + (velocity**2).sum(axis=1)
    known = IDEAL if effects is None else effects
    place = -contact_from_middle(states, p, known)
    if known.gravity.tilted:
        place = middle_position(states, p, known)
    total = place
    if known.mass is not None:
        share, mass = known.mass.share, point_mass_from_middle(states, known)
        own = velocity + np.cross(turning_in_world(states), mass)
        kinetic += share * (own**2).sum(axis=1)
        total = place + share * (place + mass)
    return np.asarray(kinetic / 2 - total @ np.asarray(known.gravity.constant))
