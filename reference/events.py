"""What can happen within a piece of a motion, and exactly when.

A quantity that must stay positive is looked at on a fine grid of the piece; where it comes down
through zero its root is found to round-off on the piece's own polynomial.
"""

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum, auto

import numpy as np
from scipy.optimize import brentq

from reference.contact_modes import Equations
from reference.incipient import slack
from reference.pieces import Piece
from reference.rows import LEAN, TIME, U1, U2, W2
from reference.states import Floats

LOOKS = np.linspace(0.0, 1.0, 41)
# ln tan(phi/2) below which a can lies flat: phi is 1e-26.
FLAT = -60.0
# Of the bracket under N: nearer to zero the normal force is no longer a number.
LEAST_GRIP = 1e-6
# A slip slower than this and slowing is about to stop: round-off of the can's own velocity.
STOPPED = 1e-14


class What(Enum):
    """What happens."""

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


@dataclass(frozen=True, slots=True, kw_only=True)
class Event:
    """What happens, and where in its piece."""

    c: float
    what: What


Margin = Callable[[Floats], Floats]


def events(piece: Piece, equations: Equations, t_end: float) -> list[Event]:
    """Return what happens in a piece, in order, cut or not.

    Parameters
    ----------
    piece : Piece
        With cut 1.
    equations : Equations
    t_end : float
        The horizon.
    """
    found = [
        Event(c=c, what=what)
        for what, margin in _margins(piece, equations, t_end).items()
        for c in _crossings(margin, piece)
    ]
    return sorted(found, key=lambda event: event.c)


def _margins(piece: Piece, equations: Equations, t_end: float) -> dict[What, Margin]:
    """Return what must stay positive, in the mode of the piece."""
    mode = piece.mode
    margins: dict[What, Margin] = {
        What.OVERTURNED: lambda y: -y[LEAN],
        What.FLAT: lambda y: y[LEAN] - FLAT,
        What.MAXIMUM: lambda y: -y[W2],
        What.MINIMUM: lambda y: y[W2],
    }
    if np.isfinite(t_end):
        margins[What.HORIZON] = lambda y: t_end - y[TIME]
    if not equations.pulls:
        margins[What.LIFTS] = lambda y: equations.contact(y, mode).force[2]
    if mode.slips:
        margins[What.JAMS] = lambda y: equations.contact(y, mode).grip - LEAST_GRIP
    elif np.isfinite(equations.mu):
        margins[What.SLIPS] = lambda y: slack(equations, y, mode)
    if equations.drilling and mode.turns:
        margins[What.HELD] = lambda y: mode.turns * equations.turning(y)
    elif equations.drilling:
        margins[What.TURNS] = lambda y: spare(equations, y, piece)
    return margins


def spare(equations: Equations, y: Floats, piece: Piece) -> Floats:
    """How much more moment the plane could hold the can with, about the normal."""
    found = equations.contact(y, piece.mode)
    return np.asarray(equations.drilling * found.force[2] - np.abs(found.moment[2]))


def _crossings(margin: Margin, piece: Piece) -> list[float]:
    looks, y = LOOKS, piece.at(LOOKS)
    if piece.mode.slips:
        # a slip that begins has no direction yet
        begun = np.hypot(y[U1], y[U2]) > 0
        looks, y = looks[begun], y[:, begun]
    values = margin(y)
    down = np.flatnonzero((values[:-1] > 0) & (values[1:] <= 0))

    def one(c: float) -> float:
        return float(margin(piece.at(np.array([c])))[0])

    return [_root(one, float(looks[i]), float(looks[i + 1])) for i in down]


def _root(margin: Callable[[float], float], left: float, right: float) -> float:
    """Where a margin comes down through zero; alone, a value may be rounded otherwise than here."""
    if margin(left) <= 0:
        return left
    if margin(right) >= 0:
        return right
    return float(brentq(margin, left, right, xtol=1e-15, rtol=1e-15))
