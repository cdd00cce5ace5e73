"""Where a contact at rest begins to slip, or to roll against resistance.

The direction e of a slip that grows from nothing is that of its own acceleration under the friction
-mu N e: e x a(e) = 0 with e.a(e) >= 0. At the edge of the friction cone, where sticking ends, e is
against the force that sticking took, and a(e) = 0: there slip grows as the square of time, and how
fast is found a little later along the motion that sticks.

The level part of the angular velocity begins in the same way, under the moment -l_r N e.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import brentq

from reference.contact_modes import Contact, Equations, Mode
from reference.frames import to_level
from reference.rolled import HARDLY, rolled
from reference.rows import LEAN, SLIP, Angles
from reference.states import Floats

DIRECTIONS = 180
# How far along to look for the acceleration at the edge of the cone.
LATER = 1e-6
# Within this share of the limit the force that holds is on the edge of the cone.
EDGE = 1e-9


@dataclass(frozen=True, slots=True, kw_only=True)
class Onset:
    """How slip or rolling begins: u = size sigma^power (cos angle, sin angle)."""

    angle: float
    size: float
    power: int

    @property
    def direction(self) -> Floats:
        """A unit vector, shape (2,)."""
        return np.array([np.cos(self.angle), np.sin(self.angle)])


@dataclass(frozen=True, slots=True, kw_only=True)
class Rest:
    """What may be held at rest by a reaction within a cone.

    Attributes
    ----------
    freed : callable
        The mode in which it is not held.
    hardly : callable
        States (13, n) in which it moves hardly, in directions of shape (2, n).
    acceleration : callable
        Of what begins, shape (2, n), from a contact and its states.
    reaction : callable
        That holds it, shape (2, n), and its limit, shape (n,).
    """

    freed: Callable[[Mode], Mode]
    hardly: Callable[[Floats, Floats], Floats]
    acceleration: Callable[[Contact, Floats], Floats]
    reaction: Callable[[Equations, Contact], tuple[Floats, Floats]]


def _slipping(y: Floats, direction: Floats) -> Floats:
    columns = y.copy()
    columns[SLIP] = HARDLY * direction
    return columns


RIM = Rest(
    freed=lambda mode: replace(mode, slips=True),
    hardly=_slipping,
    acceleration=lambda found, _: found.slipping,
    reaction=lambda equations, found: (found.force[:2], equations.mu * found.force[2]),
)
"""Friction holds the rim's material where it touches."""

LEAN_OF_CAN = Rest(
    freed=lambda mode: replace(mode, rests=False),
    hardly=rolled,
    acceleration=lambda found, y: to_level(found.turning, Angles.of(y[LEAN]))[:2],
    reaction=lambda equations, found: (found.moment[:2], equations.resistance * found.force[2]),
)
"""Rolling resistance holds the level part of the angular velocity."""


def slack(equations: Equations, found: Contact, rest: Rest = RIM) -> Floats:
    """How much of the cone a contact that holds leaves, (mu N - |F|) sin phi, shape (n,)."""
    reaction, limit = rest.reaction(equations, found)
    return np.asarray(limit - np.hypot(*reaction))


def onset(equations: Equations, y: Floats, mode: Mode, rest: Rest = RIM) -> Onset | None:
    """Return how slip, or rolling, begins from rest; None if it does not.

    Parameters
    ----------
    equations : Equations
    y : ndarray, shape (13,)
    mode : Mode
        In which it is held.
    rest : Rest
        Which of the two.
    """
    column, free = y[:, None], rest.freed(mode)
    reaction, limits = rest.reaction(equations, equations.contact(column, mode))
    (R1, R2), limit = reaction[:, 0], limits[0]
    if abs(limit - np.hypot(R1, R2)) > EDGE * max(limit, np.hypot(R1, R2)):
        return _at_once(equations, y, free, rest)
    later = y + LATER * equations.rates(column, mode)[:, 0]
    start = float(np.arctan2(-R2, -R1))
    width = 1e-3

    def across(angle: float) -> float:
        return float(_acceleration(equations, later, free, rest, np.array([angle]))[1][0])

    if across(start - width) * across(start + width) > 0:
        return None
    angle = float(brentq(across, start - width, start + width, xtol=1e-15))
    along = float(_acceleration(equations, later, free, rest, np.array([angle]))[0][0])
    if not along > 0:
        return None
    return Onset(angle=start, size=along / LATER / 2, power=2)


def _at_once(equations: Equations, y: Floats, mode: Mode, rest: Rest) -> Onset | None:
    """Return the direction in which it gains speed fastest."""
    # begun aside of the likely directions, so that no root is an end
    angles = np.linspace(-np.pi, np.pi, DIRECTIONS + 1) + 0.5
    _, across = _acceleration(equations, y, mode, rest, angles)
    best: Onset | None = None
    for i in np.flatnonzero(across[:-1] * across[1:] <= 0):
        angle = float(
            brentq(
                lambda x: float(_acceleration(equations, y, mode, rest, np.array([x]))[1][0]),
                angles[i],
                angles[i + 1],
                xtol=1e-15,
            )
        )
        along = float(_acceleration(equations, y, mode, rest, np.array([angle]))[0][0])
        if along > 0 and (best is None or along > best.size):
            best = Onset(angle=angle, size=along, power=1)
    return best


def _acceleration(
    equations: Equations, y: Floats, mode: Mode, rest: Rest, angles: Floats
) -> tuple[Floats, Floats]:
    """Acceleration along a direction and across it, both of shape (n,)."""
    cos, sin = np.cos(angles), np.sin(angles)
    columns = rest.hardly(np.repeat(y[:, None], angles.size, axis=1), np.array([cos, sin]))
    a1, a2 = rest.acceleration(equations.contact(columns, mode), columns)
    return a1 * cos + a2 * sin, a2 * cos - a1 * sin
