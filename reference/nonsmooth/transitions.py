"""Transitions between modes of the contact where a law changes.

Every motion at rest is held first. A motion that needs more than its limit is released, and begins
in the direction of its own acceleration (`reference.nonsmooth.slip_onset`). A release changes what
the other holds need, so that they are checked again until all agree: first the horizontal turning,
then the turning about the normal, then the slip; but the slip first where holding needs a pull, for
there is no friction with a pull.

A motion that has begun must have N > 0 and a positive normal mobility
(`reference.equations.contact_laws.Contact.normal_mobility`). A rim that is released slipping has
the direction of its slip, and with it

    mobility > 0:     N > 0                   it slips; otherwise it lifts
    mobility <= 0:    free, it would fall     no force keeps it on the plane: inconsistent
                      free, it would rise     it slides under a force, or lifts: indeterminate

What is held, and may be, stays held, also where a rim without force would rise: of these two
motions that is the one that a stiff plane has, on which the can stood before.
"""

from dataclasses import dataclass, replace

import numpy as np

from reference.equations.contact_laws import Contact, Equations, Mode
from reference.equations.newton_euler import ROLLING_1, GeneralEquations
from reference.equations.state_vector import (
    DISSIPATED,
    LEAN,
    SLIP,
    TURN,
    U1,
    U2,
    W1,
    W2,
    W3,
    Angles,
    rotation,
)
from reference.nonsmooth.events import EventKind, hardly_runs
from reference.nonsmooth.level_spin import level_turning, stands, with_level
from reference.nonsmooth.patch_onset import growth, moving, patch_onset, rim_of, with_turning
from reference.nonsmooth.radau_iia import integrator
from reference.nonsmooth.slip_onset import (
    LEAN_OF_CAN,
    RIM,
    Onset,
    SlipOnset,
    UnilateralHold,
    holding,
    holding_on_rim,
    onset,
    reserve,
)
from reference.nonsmooth.stopping import LANDING, at_rest
from reference.problem.outcome import Outcome
from reference.problem.states import Floats

# Rounds in which slip and rolling that begin together find their directions, each with the other's;
# a Newton iteration starts from them, to which a guess is enough.
ROUNDS = 12
AGREED = 1e-6
LETS_GO = {EventKind.TURNS, EventKind.RUNS}
# Round-offs of a difference that is zero.
ULPS = 1e-14
# In sigma: what fluid stops sooner has stopped.
AT_ONCE = 1e-10
# How far along to look for how the accelerations change.
LATER = 1e-6


@dataclass(frozen=True, slots=True, kw_only=True)
class ModeTransition:
    """Mode and motion from an instant on.

    Attributes
    ----------
    mode : Mode
    slip : Onset or None
    roll : SlipOnset or None
        How it begins, if it does.
    rim : UnilateralHold
        How friction holds the rim.
    ending : Outcome or None
        Why there is nothing to follow.
    """

    mode: Mode
    slip: Onset | None = None
    roll: SlipOnset | None = None
    rim: UnilateralHold = RIM
    ending: Outcome | None = None

    @property
    def at_once(self) -> bool:
        """Return whether a slip or a rolling begins from rest."""
        return self.slip is not None or self.roll is not None

    def keeps_direction(self, equations: Equations, y: Floats) -> bool:
        """Return whether what begins still moves, in a state soon after, in its direction."""
        along = self.slip is None or float(moving(equations, y) @ self.slip.direction) > 0
        level = level_turning(y[:, None])[:, 0]
        return along and (self.roll is None or float(level @ self.roll.direction) > 0)

    def infinitesimal(self, y: Floats) -> Floats:
        """Return the state, shape (13, 1), in which each beginning motion is infinitely slow."""
        column = y[:, None]
        if self.roll is not None:
            column = LEAN_OF_CAN.infinitesimal(column, self.roll.direction[:, None])
        if self.slip is not None:
            column = self.rim.infinitesimal(column, self.slip.direction[:, None])
        return column


def begin_on_rim(equations: Equations, y: Floats) -> tuple[Floats, ModeTransition]:
    """Return a state on the rim, shape (13,), with all held that rests, and how it goes on."""
    y, mode = slips_or_rests(equations, y)
    if equations.fluid and y[LEAN] < LANDING:
        # fluid below a can that all but lies on its face holds its contact point
        y = _stopped_by_fluid(equations, y, mode)
        if abs(float(rotation(y[:, None])[0])) <= hardly_runs(np.abs(y[W2])):
            return land(equations, y, mode)
    if equations.resistance and stands(y[:, None])[0]:
        y, mode = at_rest(y, mode)
    now = begin(equations, y, mode)
    if equations.contour and now.mode.runs == 0:
        y = _still_on_rim(y)
    return y, now


def slips_or_rests(equations: Equations, y: Floats) -> tuple[Floats, Mode]:
    """Return the mode of a release, and its state, without a turning of a patch that is none.

    A turning no larger than the round-off of the others is none.
    """
    mode = Mode(slips=bool(moving(equations, y).any()))
    if mode.slips and not y[SLIP].any() and _hardly_drills(equations, y):
        return with_turning(y[:, None], np.zeros(1))[:, 0], Mode()
    return y, mode


def _hardly_drills(equations: Equations, y: Floats) -> bool:
    """Return whether the turning about the normal is no more than the round-off of the others."""
    turns = abs(float(equations.turning(y[:, None])[0]))
    return turns <= ULPS * float(np.abs(y[TURN]).max())


def _still_on_rim(y: Floats) -> Floats:
    """Return a state with theta' = 0, of one whose sin(phi) theta' is a round-off.

    Of a can that all but lies on its face theta' itself is none, and would stay as it is.
    """
    at, along = Angles.of(y[LEAN]), float(rotation(y[:, None])[0])
    if abs(along) <= ULPS * float(at.S) * abs(float(y[W3])):
        return y
    out = y.copy()
    out[W1] = y[W3] * at.S / at.C
    return out


def _stopped_by_fluid(equations: Equations, y: Floats, mode: Mode) -> Floats:
    """Return a state whose contact point has stopped, where fluid stops it within a round-off.

    By an impulse of its moment; the energy that it takes is counted as dissipated.
    """
    column = y[:, None]
    rates, along = equations.rates(column, mode)[:, 0], float(rotation(column)[0])
    at, held = Angles.of(y[LEAN]), replace(mode, lands=True)
    slowing = abs(float(at.S * rates[W3] - at.C * rates[W1]))
    if not isinstance(equations, GeneralEquations) or slowing * AT_ONCE < abs(along):
        return y
    change = equations.impulses(y, held)[:, equations.moments_that_hold(held).index(ROLLING_1)]
    out = y.copy()
    out[[*TURN, *SLIP]] -= change * along / float(at.S * change[2] - at.C * change[0])
    lost = equations.energy(column, mode) - equations.energy(out[:, None], mode)
    out[DISSIPATED] += lost[0]
    return out


def begin(
    equations: Equations, y: Floats, mode: Mode, event: EventKind | None = None
) -> ModeTransition:
    """Return the transition with which a motion continues.

    Parameters
    ----------
    equations : Equations
    y : ndarray, shape (13,)
    mode : Mode
        With all held that is at rest.
    event : EventKind, optional
        Which has ended the mode. What lets go at its limit goes: the roundings of its margin there
        are of either sign, and would hold it again.
    """
    column = y[:, None]
    moment = equations.contact(column, mode).moment[:, 0] if event in LETS_GO else np.zeros(3)
    if event is EventKind.TURNS:
        mode = replace(mode, turns=int(-np.sign(moment[2])))
    else:
        mode = turning(equations, column, mode)
    if event is EventKind.RUNS:
        mode = replace(mode, runs=int(np.sign(moment[0])))
    else:
        mode = running(equations, column, mode)
    return settled(equations, y, ModeTransition(mode=mode))


def settled(equations: Equations, y: Floats, now: ModeTransition) -> ModeTransition:
    """Release holds beyond their limits until the others hold, if the plane can push so."""
    contact = None
    while now.ending is None:
        contact = equations.contact(now.infinitesimal(y), now.mode)
        then = _give_way(equations, y, now, contact)
        if then is now or then == now:
            break
        now = then
    if now.slip and now.roll and now.ending is None:
        now, contact = _agree(equations, y, now), None
    if now.ending is not None or equations.bilateral_normal:
        return now
    if contact is None:
        contact = equations.contact(now.infinitesimal(y), now.mode)
    ending = _impossible(float(contact.force[2, 0]), float(contact.normal_mobility[0]))
    return now if ending is None else replace(now, ending=ending)


def land(equations: Equations, y: Floats, mode: Mode) -> tuple[Floats, ModeTransition]:
    """Return a state whose contact point, stopped by fluid, is held, and what follows."""
    at, y = Angles.of(y[LEAN]), y.copy()
    y[W1] = y[W3] * at.S / at.C
    return y, begin(equations, y, replace(mode, runs=0, lands=True))


def begin_slip(equations: Equations, y: Floats, now: ModeTransition) -> ModeTransition:
    """Release the slip of the rim, in its only admissible direction."""
    rest = rim_of(equations)
    free, here = rest.freed(now.mode), now.infinitesimal(y)[:, 0]
    slip: Onset | Outcome
    if isinstance(equations, GeneralEquations) and equations.patch:
        slip = patch_onset(equations, here, free)
    else:
        slip = onset(equations, here, free)
    if isinstance(slip, Outcome):
        return replace(now, ending=slip)
    return replace(now, mode=free, slip=slip, rim=rest)


def begin_roll(equations: Equations, y: Floats, now: ModeTransition) -> ModeTransition:
    """Release the rolling of the can, in its only admissible direction."""
    free = LEAN_OF_CAN.freed(now.mode)
    here = now.infinitesimal(y)[:, 0]
    roll = onset(equations, here, free, LEAN_OF_CAN)
    if isinstance(roll, Outcome):
        return replace(now, ending=roll)
    return replace(now, mode=free, roll=roll)


def straight_on(equations: Equations, y: Floats, now: ModeTransition, ahead: Floats) -> Floats:
    """Return a linear guess of the change of a state, shape (13, n), after sigma, shape (n,)."""
    rest = now.rim
    column, sticking = y[:, None], now.mode
    if now.at_once:
        column = replace(now, slip=None).infinitesimal(y)
        sticking = replace(now.mode, slips=now.mode.slips and now.slip is None)
    guess = equations.rates(column, sticking) * ahead
    if now.roll is not None:
        others = replace(now, roll=None, mode=replace(now.mode, rests=True))
        level = _grown(equations, y, others, now.roll, LEAN_OF_CAN, ahead=ahead)
        guess[TURN] = with_level(y[:, None] + guess, level)[TURN] - y[TURN, None]
    if now.slip is not None:
        others = replace(now, slip=None, mode=replace(now.mode, slips=False))
        grown = _grown(equations, y, others, now.slip, rest, ahead=ahead)
        guess[SLIP] = grown[:2]
        if equations.patch:
            turned = with_turning(y[:, None] + guess, grown[2] / equations.patch)
            guess[TURN] = turned[TURN] - y[TURN, None]
    return guess


def _grown(
    equations: Equations,
    y: Floats,
    others: ModeTransition,
    begun: Onset,
    rest: UnilateralHold,
    *,
    ahead: Floats,
) -> Floats:
    """Return a guess of a slip or a rolling at the points of a step, shape (2, n).

    On the edge of its cone the acceleration with which it begins is next to nothing, and soon no
    measure of what it becomes: that follows from what would hold it, were it held further on.
    """
    column, held = others.infinitesimal(y), others.mode
    rates = equations.rates(column, held)
    bend = (equations.rates(column + LATER * rates, held) - rates) / LATER
    times = np.append(0.0, ahead)
    along = column + rates * times + bend * times**2 / 2
    if isinstance(equations, GeneralEquations) and rest.patch:
        gained = growth(equations, along[:, 1:], rest.freed(held))
        return np.asarray(ahead[-1] * (gained @ integrator().T))
    reaction, _ = rest.reaction(equations, equations.contact(along, held))
    against = -reaction / np.maximum(np.hypot.reduce(reaction), np.finfo(float).tiny)
    moving = rest.infinitesimal(along, against)
    contact = equations.contact(moving, rest.freed(held))
    gains = (rest.acceleration(contact, moving) * against).sum(axis=0)
    gains = begun.size + np.maximum(gains[1:] - gains[0], 0.0)
    return np.asarray(ahead[-1] * (integrator() @ gains) * begun.direction[:, None])


def turning(equations: Equations, column: Floats, mode: Mode) -> Mode:
    """Return the mode in which turning about the normal continues, or is held."""
    if not equations.drilling:
        return mode
    about = float(equations.turning(column)[0])
    held = replace(mode, turns=0)
    contact = equations.contact(column, held)
    needed = contact.moment[2, 0]
    small = 1e-12 * (1 + float(np.abs(column[[U1, U2, W2], 0]).max()))
    if abs(about) > small:
        return replace(mode, turns=int(np.sign(about)))
    if holding(equations, contact)[0] > 0:
        return held
    return replace(mode, turns=int(-np.sign(needed)))


def running(equations: Equations, column: Floats, mode: Mode) -> Mode:
    """Return the mode in which the contact point runs on along the rim, or is held there."""
    if not equations.contour or mode.lands:
        return mode
    along = float(rotation(column)[0])
    small = 1e-12 * (1 + float(np.abs(column[[U1, U2, W2], 0]).max()))
    if abs(along) > small:
        return replace(mode, runs=int(np.sign(along)))
    held = replace(mode, runs=0)
    contact = equations.contact(column, held)
    if holding_on_rim(equations, contact, column)[0] > 0:
        return held
    return replace(mode, runs=int(np.sign(contact.moment[0, 0])))


def _give_way(
    equations: Equations, y: Floats, now: ModeTransition, contact: Contact
) -> ModeTransition:
    """Release one motion that is held beyond its limit, given the contact as it is."""
    rest, column = rim_of(equations), now.infinitesimal(y)
    may_slip = not now.mode.slips and np.isfinite(equations.mu)
    if may_slip and contact.force[2, 0] <= 0:
        return begin_slip(equations, y, now)
    if now.mode.rests and reserve(equations, contact, LEAN_OF_CAN)[0] < 0:
        return begin_roll(equations, y, now)
    if equations.drilling and now.mode.turns == 0:
        mode = turning(equations, column, now.mode)
        if mode != now.mode:
            return replace(now, mode=mode)
    if equations.contour and now.mode.runs == 0 and not now.mode.lands:
        mode = running(equations, column, now.mode)
        if mode != now.mode:
            return replace(now, mode=mode)
    if may_slip and reserve(equations, contact, rest)[0] < 0:
        return begin_slip(equations, y, now)
    return now


def _agree(equations: Equations, y: Floats, now: ModeTransition) -> ModeTransition:
    """Return the directions of a slip and a rolling that begin together."""
    for _ in range(ROUNDS):
        before = now
        now = begin_roll(equations, y, replace(now, roll=None, mode=replace(now.mode, rests=True)))
        if now.ending is None:
            now = begin_slip(
                equations, y, replace(now, slip=None, mode=replace(now.mode, slips=False))
            )
        if now.ending is not None or _apart(before, now) < AGREED:
            break
    return now


def _apart(one: ModeTransition, other: ModeTransition) -> float:
    """Return the difference of the directions of two transitions."""
    pairs = ((one.slip, other.slip), (one.roll, other.roll))
    return max(float(np.abs(a.direction - b.direction).max()) for a, b in pairs if a and b)


def _impossible(normal: float, mobility: float) -> Outcome | None:
    """Return the outcome of a contact that cannot continue, or None."""
    if mobility > 0:
        return None if normal > 0 else Outcome.LIFTED
    return Outcome.INDETERMINATE if normal > 0 else Outcome.INCONSISTENT
