"""Where a contact point begins to creep on the rim of a can that falls on its face, and its end."""

import numpy as np

from reference.equations.contact_laws import Equations, Mode
from reference.equations.creeping import NORMAL_FORCE
from reference.equations.newton_euler import GeneralEquations
from reference.equations.state_vector import DISSIPATED, LEAN, PSI, TURN, W1, W2, Angles, X, Y
from reference.nonsmooth.events import EventKind
from reference.problem.states import Floats

# sin(phi) over w1^2 below which the centrifugal part of the normal force is far beyond the others,
# and g/w1^2 below which three digits of that part have cancelled: on the manifold, to which dry
# friction along the rim draws the can, and not in a bounce, however close to the flat state.
CENTRIFUGAL = 1e-3


def creeps(equations: Equations, y: Floats, mode: Mode) -> bool:
    """Return whether the normal force of a state, shape (13,), is better taken for a state.

    Infinite friction has to hold the rim on a rigid plane, and the can to be mirrored in the plane
    of its lean.
    """
    if not equations.contour or not mode.runs or mode.slips or np.isfinite(equations.mu):
        return False
    if type(equations) is not GeneralEquations or equations.fluid or y[W2] <= 0.0:
        return False
    mass = equations.effects.mass
    mirrored = mass is None or (mass.x == 0.0 and mass.y == 0.0)
    least = CENTRIFUGAL * float(y[W1]) ** 2
    if not mirrored or float(Angles.of(y[LEAN]).S) >= least:
        return False
    return abs(float(equations.contact(y[:, None], mode).force[2, 0])) < least


def creeping(equations: Equations, y: Floats, mode: Mode) -> Floats:
    """Return a state, shape (13,), with the normal force among its rows."""
    out = y.copy()
    force = equations.contact(y[:, None], mode).force[2, 0]
    out[NORMAL_FORCE] = force / Angles.of(y[LEAN]).S
    return out


def crept(equations: Equations, y: Floats, mode: Mode, what: EventKind | None) -> Floats:
    """Return a state, shape (13,), without the normal force, where its creeping ends by an event.

    Without an event phi falls no more.
    """
    out = y.copy()
    out[NORMAL_FORCE] = 0.0
    if what is not EventKind.FLAT or not isinstance(equations, GeneralEquations):
        return out
    # phi is below all round-off, and what is left a closed form (`reference.equations.creeping`):
    # w1/(p w2) of precession, round a centre that rests
    slowing = float(equations.rates(y[:, None], mode)[W1, 0])
    out[PSI] -= y[W1] ** 2 / slowing
    out[TURN] = 0.0, y[W2], 0.0
    radius = 1 - equations.effects.rim
    out[X] += radius * (np.cos(y[PSI]) - np.cos(out[PSI]))
    out[Y] += radius * (np.sin(y[PSI]) - np.sin(out[PSI]))
    before, after = (equations.energy(one[:, None], mode)[0] for one in (y, out))
    out[DISSIPATED] += before - after
    return out
