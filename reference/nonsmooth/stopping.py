"""Distance to the instant at which a slip, or a rolling against resistance, stops or jams.

Friction stops a motion in a finite time, at which its direction is lost: a step ends before that
instant, and a motion as small as its round-off is held.
"""

from dataclasses import replace

import numpy as np

from reference.equations.contact_laws import Equations, Mode
from reference.equations.frames import to_level
from reference.equations.state_vector import LEAN, SLIP, TURN, W1, W2, Angles
from reference.nonsmooth.level_spin import BESIDE, level_turning, with_level
from reference.nonsmooth.patch_onset import moving, rim_of, with_turning
from reference.nonsmooth.segments import Segment
from reference.problem.states import Floats

# A slip or a level turning slower than this and slowing is about to stop: round-off of the can's
# own velocity. So is a slip that stops within such a sigma, however fast: what would be left of a
# step no longer moves a double.
STOPPED = 1e-14
# Of a can that all but stands the time of the rim runs faster than the can moves: below this
# angular velocity first and longest steps are shares of its reciprocal. Else each of the many
# phases of stick and slip of a disk that comes to rest begins with twenty steps that double.
CREEPS, CREEPING = 1e-2, 2.0
# ln tan(phi/2) of a disk with 1e-9 rad to go: from there rolling resistance brings it to rest in a
# time that goes as the square root of phi, in ever more phases of stick and slip.
ALL_BUT_FLAT = -21.4
# Four decades of phi, at least, make a sequence. A disk that rolls steadily has w1^2 of about
# phi/a: one that has more than this multiple of tan(phi/2) is on its way up again.
DECADES, RISES = 9.2, 100.0
# ln tan(phi/2) of a can that has 1e-5 rad to fall, and how much of it a step takes from there: a
# share of exp(-3). A longer one leaves the precession, which goes with phi, no digits at its end.
LANDING, FALL = -12.2, 3.0


def left_of_fall(equations: Equations, y: Floats) -> float:
    """Return the sigma in which a can that falls flat loses digits; inf if it does not."""
    slowed = bool(equations.fluid or equations.contour or equations.patch)
    falls = slowed and y[LEAN] < LANDING and y[W2] > 0
    return float(FALL / y[W2]) if falls else np.inf


def pace(equations: Equations, y: Floats) -> float:
    """Return how much longer steps are than those of a can that moves at a rate of 1."""
    speed = float(np.abs(y[TURN]).max())
    return CREEPING / speed if slows_turning(equations) and 0 < speed < CREEPS else 1.0


def comes_to_rest(equations: Equations, y: Floats) -> bool:
    """Return whether rolling resistance has all but stopped a disk that lies all but flat.

    Such a disk does not fall as a can tips: phi goes as the square of the time that is left.
    """
    flat = equations.resistance > 0 and y[LEAN] < ALL_BUT_FLAT
    return bool(flat and y[W2] ** 2 < np.exp(y[LEAN]))


def slows_turning(equations: Equations) -> bool:
    """Return whether dry friction opposes the turning of a can, and so brings it to rest."""
    return bool(equations.resistance or equations.drilling or equations.patch)


def nearly_rests(equations: Equations, y: Floats, released: float) -> bool:
    """Return whether friction against turning has all but stopped a disk.

    It comes to rest by phases of stick and slip, or by nutations, that tend to a geometric
    sequence, whose limit is known before all of them are followed.

    Parameters
    ----------
    equations : Equations
    y : ndarray, shape (13,)
    released : float
        ln tan(phi/2) at the release: what began so low has no sequence yet.
    """
    if not slows_turning(equations):
        return False
    flat = y[LEAN] < min(ALL_BUT_FLAT, released - DECADES)
    return bool(flat and y[W1] ** 2 + y[W2] ** 2 < RISES * np.exp(y[LEAN]))


def left_of_slip(equations: Equations, y: Floats, mode: Mode) -> float:
    """Return sigma until the slip of a state, shape (13,), stops at its rate; inf if it never does.

    Parameters
    ----------
    equations : Equations
    y : ndarray, shape (13,)
    mode : Mode
    """
    if not mode.slips:
        return np.inf
    if equations.patch:
        contact = equations.contact(y[:, None], mode)
        slowing = rim_of(equations).acceleration(contact, y[:, None])[:, 0]
        return _until_none(moving(equations, y), slowing)
    rates = equations.rates(y[:, None], mode, along=False)
    return _until_none(y[SLIP], rates[SLIP, 0])


def left_to_jam(equations: Equations, piece: Segment) -> float:
    """Return sigma from the end of a piece until the rim jams; inf if it does not.

    Where the normal mobility G falls to zero N = -n/G grows without bound, and with it what lets G
    fall: G G' tends to a constant, so that G^2 falls to zero in a straight line.
    """
    contact = equations.contact(piece.at(np.array([piece.cut / 2, piece.cut])), piece.mode)
    before, after = (contact.normal_mobility**2).tolist()
    falls = before > after and contact.force[2, 1] > contact.force[2, 0] > 0
    return piece.cut * piece.length / 2 * after / (before - after) if falls else np.inf


def left_of_roll(equations: Equations, y: Floats, mode: Mode) -> float:
    """Return sigma until the horizontal turning stops; inf if it is not resisted or never stops."""
    if not equations.resistance or mode.rests:
        return np.inf
    column = y[:, None]
    turning = to_level(equations.contact(column, mode).turning, Angles.of(column[LEAN]))
    return _until_none(level_turning(column)[:, 0], turning[:2, 0])


def halted(equations: Equations, y: Floats, mode: Mode) -> tuple[Floats, Mode]:
    """Return a state without a slip or rolling that has stopped, and the mode that holds it."""
    left = left_of_slip(equations, y, mode)
    least = STOPPED
    if equations.patch:
        # the turning about the normal has the round-off of the others
        least *= equations.patch * (1 + float(np.abs(y[TURN]).max()))
    slow = np.hypot.reduce(moving(equations, y)) <= least
    if left <= STOPPED or (slow and np.isfinite(left)):
        y, mode = y.copy(), replace(mode, slips=False)
        y[SLIP] = 0.0
        if equations.patch:
            y = with_turning(y[:, None], np.zeros(1))[:, 0]
    if not equations.resistance:
        return y, mode
    # beside a turning about the vertical the little that is left has no direction
    least = STOPPED + BESIDE * float(np.abs(y[TURN]).max())
    speed = float(np.hypot(*level_turning(y[:, None])[:, 0]))
    if speed <= least and np.isfinite(left_of_roll(equations, y, mode)):
        y, mode = at_rest(y, mode)
    return y, mode


def at_rest(y: Floats, mode: Mode) -> tuple[Floats, Mode]:
    """Return a held state without horizontal turning, of which there was only round-off."""
    return with_level(y[:, None], np.zeros((2, 1)))[:, 0], replace(mode, rests=True)


def _until_none(velocity: Floats, acceleration: Floats) -> float:
    speed = np.hypot.reduce(velocity)
    slowing = -(velocity @ acceleration) / speed
    return float(speed / slowing) if slowing > 0 else np.inf
