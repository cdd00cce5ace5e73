"""Infinite sequences of impacts in a finite time (Zeno's): when they end, and what they leave.

A rim that is pressed to the plane bounces in times that form a geometric sequence, and so does a
can that rocks from side to side of its face. A sequence is followed impact by impact until what is
left of it is shorter than the square root of round-off.
"""

import numpy as np

from reference.equations.frames import to_level
from reference.equations.newton_euler import GeneralEquations
from reference.equations.state_vector import LEAN, TIME, TURN, W1, W2, Angles
from reference.nonsmooth.transitions import begin_on_rim
from reference.problem.states import Floats
from reference.unilateral.flight import Flight
from reference.unilateral.free_body import Body, launch_of
from reference.unilateral.next_contact import margin

# What is left of a sequence of impacts, in units of the fastest rate: its square is round-off.
ENDLESS = 1e-8
# The same of a can that rocks on its face without slipping, whose rocking times are a geometric
# sequence but for their third powers.
ENDLESS_ROCKING = 5e-6
# Square of the velocities, and height over R, below which a can lies on its face: its flights are
# shorter than 1e-6, and their heights near round-off.
RATTLES = 1e-13
# Of the velocities: a normal velocity below this share is round-off.
STILL = 1e-15


def acceleration(body: Body, y: Floats, rise: float) -> float:
    """Return the vertical acceleration of the gap of a rim without a force of the plane."""
    flight = Flight(body, launch_of(y, body, rise=rise))
    bend = float(margin(flight, flight.at(np.zeros(1)))[2][0])
    r, at = body.effects.rim, Angles.of(y[LEAN])
    if r == 1.0:
        return bend
    S, falling = (1 - r) * float(at.S), -(1 - r) * float(at.C * y[W2])
    return (bend - 2 * rise * (rise + 2 * falling)) / (2 * S)


def end_of_bounces(body: Body, after: Floats, rise: float, up: float) -> float | None:
    """Return when the sequence of impacts ends, if that is at once but for round-off.

    Parameters
    ----------
    body : Body
    after : ndarray, shape (13,)
        State after an impact.
    rise, up : float
        Vertical velocity of the rim before it and after.
    """
    ratio = up / -rise
    if up <= 0.0 or ratio >= 1.0:
        return None
    falls = -acceleration(body, after, up)
    if falls <= 0.0:
        return None
    left = 2 * up / falls / (1 - ratio)
    precession = abs(float(after[W1] / Angles.of(after[LEAN]).S))
    rate = 1 + float(np.abs(after[TURN]).max()) + precession
    return float(after[TIME]) + left if left * rate < ENDLESS else None


def left_of_rocking(
    equations: GeneralEquations, y: Floats, rise: float, fastest: float, falling: float
) -> float:
    """Return how long a can goes on that rocks from side to side of its face, ever less.

    Parameters
    ----------
    equations : GeneralEquations
    y : ndarray, shape (13,)
        Flat, after the impacts of its face.
    rise, fastest : float
        Vertical velocity of the contact, and the largest of the rim.
    falling : float
        The largest speed with which the rim fell before.
    """
    if fastest <= STILL * falling:
        return 0.0
    ratio = fastest / falling
    if ratio >= 1.0:
        return np.inf
    falls = 1.0
    if rise <= STILL * falling:
        y, now = begin_on_rim(equations, y)
        rates = equations.rates(now.infinitesimal(y), now.mode)[:, 0]
        falls = 2 * (1 - equations.effects.rim) * float(rates[W2] / rates[TIME])
    return 2 * fastest / falls / (1 - ratio) if falls > 0 else np.inf


def lies_flat(y: Floats, up: float) -> bool:
    """Return whether a can lies on its face but for what it rattles there by round-off."""
    at = Angles.of(y[LEAN])
    level = to_level(y[TURN, None], Angles.of(y[LEAN, None]))[:2, 0]
    return bool(float(at.S) + up * up + float(level @ level) < RATTLES)
