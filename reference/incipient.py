"""Where a rim at rest begins to slip.

The direction e of a slip that grows from nothing is that of its own acceleration under the friction
-mu N e: e x a(e) = 0 with e.a(e) >= 0. At the edge of the friction cone, where sticking ends, e is
against the force that sticking took, and a(e) = 0: there slip grows as the square of time, and how
fast is found a little later along the motion that sticks.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import brentq

from reference.contact_modes import Contact, Equations, Mode
from reference.rows import SLIP
from reference.states import Floats

DIRECTIONS = 180
# A slip so small that nothing but its direction matters.
HARDLY = 1e-60
# How far along to look for the acceleration of slip at the edge of the cone.
LATER = 1e-6
# Within this share of mu N the sticking force is on the edge of the cone.
EDGE = 1e-9


@dataclass(frozen=True, slots=True, kw_only=True)
class Onset:
    """How slip begins: u = size sigma^power (cos angle, sin angle)."""

    angle: float
    size: float
    power: int


def slack(equations: Equations, found: Contact) -> Floats:
    """How much of the cone a contact that sticks leaves, (mu N - |F|) sin phi, shape (n,)."""
    F1, F2, N = found.force
    return np.asarray(equations.mu * N - np.hypot(F1, F2))


def onset(equations: Equations, y: Floats, mode: Mode) -> Onset | None:
    """Return how slip begins from a rim at rest; None if it does not.

    Parameters
    ----------
    equations : Equations
    y : ndarray, shape (13,)
    mode : Mode
        In which it sticks.
    """
    column = y[:, None]
    F1, F2, N = equations.contact(column, mode).force[:, 0]
    slipping = replace(mode, slips=True)
    if abs(equations.mu * N - np.hypot(F1, F2)) > EDGE * max(equations.mu * N, np.hypot(F1, F2)):
        return _at_once(equations, y, slipping)
    later = y + LATER * equations.rates(column, mode)[:, 0]
    start = float(np.arctan2(-F2, -F1))
    width = 1e-3

    def across(angle: float) -> float:
        return float(_acceleration(equations, later, slipping, np.array([angle]))[1][0])

    if across(start - width) * across(start + width) > 0:
        return None
    angle = float(brentq(across, start - width, start + width, xtol=1e-15))
    along = float(_acceleration(equations, later, slipping, np.array([angle]))[0][0])
    if not along > 0:
        return None
    return Onset(angle=start, size=along / LATER / 2, power=2)


def _at_once(equations: Equations, y: Floats, mode: Mode) -> Onset | None:
    """Return the direction in which slip gains speed fastest."""
    # begun aside of the likely directions, so that no root is an end
    angles = np.linspace(-np.pi, np.pi, DIRECTIONS + 1) + 0.5
    _, across = _acceleration(equations, y, mode, angles)
    best: Onset | None = None
    for i in np.flatnonzero(across[:-1] * across[1:] <= 0):
        angle = float(
            brentq(
                lambda x: float(_acceleration(equations, y, mode, np.array([x]))[1][0]),
                angles[i],
                angles[i + 1],
                xtol=1e-15,
            )
        )
        along = float(_acceleration(equations, y, mode, np.array([angle]))[0][0])
        if along > 0 and (best is None or along > best.size):
            best = Onset(angle=angle, size=along, power=1)
    return best


def _acceleration(
    equations: Equations, y: Floats, mode: Mode, angles: Floats
) -> tuple[Floats, Floats]:
    """Acceleration of slip along a direction and across it, both of shape (n,)."""
    columns = np.repeat(y[:, None], angles.size, axis=1)
    cos, sin = np.cos(angles), np.sin(angles)
    columns[SLIP] = HARDLY * cos, HARDLY * sin
    a1, a2 = equations.contact(columns, mode).slipping
    return a1 * cos + a2 * sin, a2 * cos - a1 * sin
