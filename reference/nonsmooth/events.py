"""Events within a piece of a motion, and their instants to round-off.

A quantity that must stay positive is sampled on a fine grid of the piece; where it falls through
zero, its root is computed on the piece's own polynomial.
"""

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum, auto
from functools import cached_property

import numpy as np
import scipy

from reference.equations.compiled_equations import CompiledEquations, laws_of
from reference.equations.contact_laws import Contact, Equations, Mode
from reference.equations.state_vector import LEAN, TIME, W2, rotation
from reference.nonsmooth.level_spin import stands
from reference.nonsmooth.patch_onset import moving, rim_of
from reference.nonsmooth.segments import Segment
from reference.nonsmooth.slip_onset import LEAN_OF_CAN, holding, holding_on_rim, reserve
from reference.nonsmooth.stopping import LANDING
from reference.problem.outcome import Outcome
from reference.problem.states import Floats

LOOKS = tuple(np.linspace(0.0, 1.0, 41).tolist())
# ln tan(phi/2) below which a can lies flat: phi is 1e-80, as in the march of the can that rolls.
FLAT = -184.0
# The same where the normal force is asked for: below 1e-26 its round-off would lift the can.
FLAT_AND_PUSHED = -60.0
# Where a can has 1e-5 rad to fall its contact point, stopped by fluid but for this share of its
# fall, is held: what that takes is below the round-off of the energy, and the stiffness of a film,
# which grows as 1/phi^2 as does what it makes of a round-off, is not followed to the end.
STOPPED_BY_FLUID = 1e-13
# And whatever the speed of its fall: a boundary layer, whose moment goes with |theta'|^(3/2), never
# quite stops the point. The energy of this is 1e-30.
HARDLY_RUNS = 1e-15
# Of the fall of a parabola below three places: where these are less far from zero it is followed.
NEAR_ZERO = 4.0
# Share of a piece after which what begins with it has a direction.
BEGUN = 1e-9
# Of the bracket under N: nearer to zero the normal force is no longer a number.
LEAST_MOBILITY = 1e-6


class EventKind(Enum):
    """Kinds of events."""

    MAXIMUM = auto()
    MINIMUM = auto()
    HORIZON = auto()
    OVERTURNED = auto()
    FLAT = auto()
    SLIPS = auto()
    LIFTS = auto()
    JAMS = auto()
    HELD = auto()
    TURNS = auto()
    ROLLS = auto()
    TOUCHES = auto()
    STANDS = auto()
    RUNS = auto()
    LANDS = auto()
    LEAVES = auto()


KINDS = tuple(EventKind)
"""In the order in which compiled code numbers them."""
LIMITS = {
    EventKind.LIFTS,
    EventKind.JAMS,
    EventKind.SLIPS,
    EventKind.ROLLS,
    EventKind.HELD,
    EventKind.TURNS,
    EventKind.STANDS,
    EventKind.RUNS,
}
"""Events that end a mode wherever their margin is negative, also at the start of a piece."""
EXTREMA = (EventKind.MAXIMUM, EventKind.MINIMUM)
ENDINGS = {
    EventKind.HORIZON: Outcome.FINISHED,
    EventKind.OVERTURNED: Outcome.OVERTURNED,
    EventKind.FLAT: Outcome.FELL_FLAT,
    EventKind.LIFTS: Outcome.LIFTED,
    EventKind.JAMS: Outcome.JAMMED,
}
"""Why a motion ends at an event."""
OF_THE_STATE = {
    EventKind.MAXIMUM,
    EventKind.MINIMUM,
    EventKind.HORIZON,
    EventKind.OVERTURNED,
    EventKind.FLAT,
    EventKind.HELD,
    EventKind.TOUCHES,
    EventKind.STANDS,
    EventKind.LANDS,
    EventKind.LEAVES,
}
"""Events whose margin needs the state alone, and no force, which may have no direction yet."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Event:
    """An event, and its place in its piece."""

    c: float
    what: EventKind


class EventSample:
    """A piece at given instants, with its contact there, computed on demand."""

    def __init__(self, y: Floats, piece: Segment, equations: Equations) -> None:
        self.y = y
        self._piece, self._equations = piece, equations

    @cached_property
    def contact(self) -> Contact:
        """Return force and accelerations at the contact."""
        return self._equations.contact(self.y, self._piece.mode)


Margin = Callable[[EventSample], Floats]


def events(
    piece: Segment, equations: Equations, t_end: float, *, pushes: Margin | None = None
) -> list[Event]:
    """Return the events of a piece, in order, whether or not the piece is cut.

    Parameters
    ----------
    piece : Segment
        With cut 1.
    equations : Equations
    t_end : float
        The horizon.
    pushes : callable, optional
        Of a contact that may be lost and found: positive where the plane pushes.
    """
    if isinstance(equations, CompiledEquations):
        from reference.nonsmooth import event_kernels

        limits = t_end, equations.bilateral_normal
        of_piece = laws_of(piece.mode), piece.start, piece.coefficients
        return compiled_events(event_kernels.located(equations.constants, *of_piece, limits))
    looks, y = np.array(LOOKS), piece.looked_at(LOOKS)
    begun = np.ones(looks.size, dtype=bool)
    if piece.mode.slips:
        # a slip that begins has no direction yet, and so no contact
        begun &= np.hypot.reduce(moving(equations, y)) > 0
    if equations.resistance and not piece.mode.rests:
        # nor has a rolling that does
        begun &= np.logical_not(stands(y))
    whole, touching = EventSample(y, piece, equations), EventSample(y[:, begun], piece, equations)

    def crossings(what: EventKind, margin: Margin) -> list[float]:
        def one(c: float) -> float:
            return float(margin(EventSample(piece.at(np.array([c])), piece, equations))[0])

        values = margin(whole if what in OF_THE_STATE else touching)
        places = looks if what in OF_THE_STATE else looks[begun]
        return _zeros(what, one, places, values)

    met = [
        Event(c=c, what=what)
        for what, margin in _margins(piece, equations, t_end, pushes).items()
        for c in crossings(what, margin)
    ]
    return sorted(met, key=lambda event: event.c)


def compiled_events(located: Floats) -> list[Event]:
    """Return events of compiled code, each with the index of its kind and its place."""
    return [Event(c=c, what=KINDS[int(index)]) for index, c in located.tolist()]


def _zeros(
    what: EventKind, margin: Callable[[float], float], places: Floats, values: Floats
) -> list[float]:
    """Return where a margin, sampled at some places, falls through zero."""
    if what in {EventKind.HELD, EventKind.STANDS} and values[0] <= 0:
        # a turning that begins has no sense yet
        values, places = values[1:], places[1:]
    down = np.flatnonzero((values[:-1] > 0) & (values[1:] <= 0))
    roots = [_root(margin, float(places[i]), float(places[i + 1])) for i in down]
    roots += [_root(margin, *bracket) for bracket in _dips(margin, places, values)]
    # what begins was possible at its beginning, which has no direction to be looked at
    if what in LIMITS and places.size and values[0] <= 0 and values.min() < 0:
        roots.insert(0, _root(margin, min(BEGUN, float(places[0])), float(places[0])))
    return roots


def _margins(
    piece: Segment, equations: Equations, t_end: float, pushes: Margin | None
) -> dict[EventKind, Margin]:
    """Return the quantities that must stay positive in the mode of the piece."""
    mode = piece.mode
    flat = FLAT if equations.bilateral_normal else FLAT_AND_PUSHED
    margins: dict[EventKind, Margin] = {
        EventKind.OVERTURNED: lambda seen: -seen.y[LEAN],
        EventKind.FLAT: lambda seen: seen.y[LEAN] - flat,
    }
    if mode.rests:
        margins[EventKind.ROLLS] = lambda seen: reserve(equations, seen.contact, LEAN_OF_CAN)
    else:
        margins[EventKind.MAXIMUM] = lambda seen: -seen.y[W2]
        margins[EventKind.MINIMUM] = lambda seen: seen.y[W2]
    if np.isfinite(t_end):
        margins[EventKind.HORIZON] = lambda seen: t_end - seen.y[TIME]
    if pushes is not None and mode.flies:
        margins[EventKind.TOUCHES] = lambda seen: -pushes(seen)
        return margins
    if pushes is not None:
        margins[EventKind.LIFTS] = pushes
    elif not equations.bilateral_normal:
        margins[EventKind.LIFTS] = lambda seen: seen.contact.force[2]
    if mode.slips or equations.drilling or equations.resistance or equations.contour:
        margins[EventKind.JAMS] = lambda seen: seen.contact.normal_mobility - LEAST_MOBILITY
    if not mode.slips and np.isfinite(equations.mu):
        rim = rim_of(equations)
        margins[EventKind.SLIPS] = lambda seen: reserve(equations, seen.contact, rim)
    if equations.drilling and mode.turns:
        margins[EventKind.HELD] = lambda seen: mode.turns * equations.turning(seen.y)
    elif equations.drilling:
        margins[EventKind.TURNS] = lambda seen: holding(equations, seen.contact)
    return margins | _along_the_rim(mode, equations)


def _along_the_rim(mode: Mode, equations: Equations) -> dict[EventKind, Margin]:
    """Return the quantities of the motion of the contact point along the rim."""
    margins: dict[EventKind, Margin] = {}
    if mode.lands:
        # of a can that rises from its face
        return {EventKind.LEAVES: lambda seen: LANDING - seen.y[LEAN]}
    if equations.fluid and not mode.rests:
        margins[EventKind.LANDS] = lambda seen: _to_landing(seen.y)
    if equations.contour and mode.runs:
        margins[EventKind.STANDS] = lambda seen: mode.runs * rotation(seen.y)
    elif equations.contour:
        margins[EventKind.RUNS] = lambda seen: holding_on_rim(equations, seen.contact, seen.y)
    return margins


def _to_landing(y: Floats) -> Floats:
    """Return the margin to where a can falls flat and fluid has stopped its contact point."""
    return np.asarray(np.maximum(y[LEAN] - LANDING, np.abs(rotation(y)) - hardly_runs(y[W2])))


def hardly_runs(falls: Floats) -> Floats:
    """Return the speed along the rim that fluid has stopped, of a can that falls, shape (n,)."""
    return np.maximum(STOPPED_BY_FLUID * falls, HARDLY_RUNS)


def _dips(
    margin: Callable[[float], float], places: Floats, values: Floats
) -> list[tuple[float, float]]:
    """Bracket the zeros of a margin that is positive at both neighbouring samples.

    Looked for where the parabola through three places comes near zero between them.
    """
    before, here, after = values[:-2], values[1:-1], values[2:]
    bend, slope = before - 2 * here + after, (after - before) / 2
    least = np.minimum(np.minimum(before, here), after)
    # the square of the margin of an enormous friction overflows, and its dip is then looked into
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        inside = (bend > 0) & (np.abs(slope) <= bend)
        drop = least - (here - slope**2 / (2 * bend))
        near = (least > 0) & inside & (least <= NEAR_ZERO * drop)
    brackets = []
    for i in np.flatnonzero(near):
        left, right = float(places[i]), float(places[i + 2])
        bottom = scipy.optimize.minimize_scalar(margin, bounds=(left, right), method="bounded")
        if bottom.fun < 0:
            brackets.append((left, float(bottom.x)))
    return brackets


def _root(margin: Callable[[float], float], left: float, right: float) -> float:
    """Return where a margin falls through zero; a single value may be rounded differently."""
    if margin(left) <= 0:
        return left
    if margin(right) >= 0:
        return right
    return float(scipy.optimize.brentq(margin, left, right, xtol=1e-15, rtol=1e-15))
