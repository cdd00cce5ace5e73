"""The state of a can that may slip, in the time of its rim: what is integrated, row by row.

With T = tan(phi/2) and the time sigma defined by dt = sin(phi) dsigma,

    (ln T)' = phi',    psi' = w1,    (psi + theta)' = S w3 + T S w1,    t' = S

where w = (Psi S, -Phi, Psi C + Theta) is the angular velocity in the frame B (without the rotation
theta). Nothing grows as phi goes to 0, for every force of the plane comes times S. The slip u =
(u1, u2) is the velocity of the rim's material at the contact, along (cos psi, sin psi) and
(-sin psi, cos psi); (x, y) is the contact point.
"""

from dataclasses import dataclass
from math import atan, exp

import numpy as np
from numpy.typing import NDArray

from reference.equations.reaction_force import contact_from_middle
from reference.problem.problem import Problem
from reference.problem.states import Floats, Snapshot, initial_states

ROWS = 13
LEAN, W1, W2, W3, PSI, TOTAL, TIME, U1, U2, X, Y, DISSIPATED, SUPPLIED = range(ROWS)
TURN = [W1, W2, W3]
SLIP = [U1, U2]
# What nothing depends on: the place of the contact, and the works.
ALONG = frozenset({X, Y, DISSIPATED, SUPPLIED})
# A row may be zero: then it is measured against its neighbours, times this.
FLOOR = 1e-12
# Below this the square of a slip is no number any more.
LEAST_SLIP = np.finfo(float).tiny ** 0.25

# Of the velocities, or of forces of size 1: a part smaller than this share has their round-off.
QUIET = 1e-3

Index = NDArray[np.intp]


@dataclass(frozen=True, slots=True)
class Angles:
    """Nutation and its functions, each of shape (n,), exact however small it is."""

    T: Floats
    S: Floats
    C: Floats

    @classmethod
    def of(cls, lean: Floats) -> "Angles":
        """From ln tan(phi/2)."""
        T = np.exp(lean)
        return cls(T=T, S=2 * T / (1 + T * T), C=-np.tanh(lean))


def rotation(y: Floats) -> Floats:
    """Return sin(phi) theta', shape (n,): how fast the contact point runs along the rim."""
    at = Angles.of(y[LEAN])
    return np.asarray(at.S * y[W3] - at.C * y[W1])


def released(problem: Problem, *, at: bool = True) -> Floats:
    """State at the release, with the can's centre over (0, 0); the contact there without `at`."""
    p, e = problem.parameters, problem.effects
    y = np.zeros(ROWS)
    y[LEAN] = np.log(np.tan(problem.phi / 2))
    S, C = np.sin(problem.phi), np.cos(problem.phi)
    y[TURN] = problem.psi_dot * S, -problem.phi_dot, problem.psi_dot * C + problem.theta_dot
    y[SLIP] = problem.slip
    y[PSI], y[TOTAL] = problem.psi, problem.psi + problem.theta
    if at:
        y[[X, Y]] = contact_from_middle(initial_states(problem), p, e)[0, :2]
    return y


def sizes(rows: Index, y: Floats, patch: float = 0.0) -> Floats:
    """Return the size of each entry, as the scale of errors and differences.

    Parameters
    ----------
    rows : ndarray of int
        U1 and U2, if they are there, last; U1 alone is a normal force.
    y : ndarray, shape (rows, n)
    patch : float
        Radius of the patch of contact, whose turning has a friction as its slip has.
    """
    size = np.ones_like(y)
    turns = (rows >= W1) & (rows <= W3)
    turning = np.abs(y[turns]).max(axis=1, keepdims=True)
    size[turns] = np.maximum(turning, FLOOR * (1 + turning.max()))
    if rows[-1] == U1:
        size[-1] = np.maximum(1.0, np.abs(y[-1]))
    if rows[-1] == U2:
        size[-2:] = np.maximum(np.hypot(y[-2], y[-1]), LEAST_SLIP)
        if patch:
            size[-2:] = np.maximum(size[-2:], patch * np.abs(y[turns]).max(axis=0))
    return size


def tail_of(start: Floats, series: Floats, *, resisted: bool) -> float:
    """Return the last two coefficients of a step, shape (13, n), over the size of its rows.

    Parameters
    ----------
    start : ndarray, shape (13,)
    series : ndarray, shape (13, n)
        Chebyshev's, of the change since the start.
    resisted : bool
        Whether rolling meets resistance.
    """
    size = np.abs(start) + np.abs(series).sum(axis=1)
    size[LEAN] = 1.0
    size[SLIP] = np.hypot(*size[SLIP])
    size = np.maximum(size, 1e-9 * size.max())
    # of a part of the angular velocity that is zero there is only the noise of the others
    size[TURN] = np.maximum(size[TURN], QUIET * size[TURN].max())
    # a slip has the round-off of all velocities; how well its direction is known shows in what
    # the friction does to them
    size[SLIP] = np.maximum(size[SLIP], QUIET * max(1.0, size[TURN].max()))
    if resisted:
        # where it all but holds the can, moments of size 1 leave their round-off
        size[TURN] = np.maximum(size[TURN], QUIET)
    return float((np.abs(series[:, -2:]).max(axis=1) / size).max())


def phi_of(lean: float) -> float:
    """Return the nutation from ln tan(phi/2)."""
    return 2 * atan(exp(lean))


def snapshot_of(y: Floats) -> Snapshot:
    """State of the can, from one column."""
    at = Angles.of(y[LEAN])
    psi_dot, axial = float(y[W1] / at.S), float(y[W3])
    return Snapshot(
        phi=float(2 * np.arctan(at.T)),
        phi_dot=float(-y[W2]),
        psi=float(y[PSI]),
        psi_dot=psi_dot,
        theta=float(y[TOTAL] - y[PSI]),
        theta_dot=float(axial - psi_dot * at.C),
        spin=float(axial + y[W1] * at.T),
    )
