"""The horizontal part of the angular velocity, which rolling resistance opposes.

The angular velocity w without its part about the vertical is (C w1 - S w3, w2) along (cos psi, sin
psi, 0) and (-sin psi, cos psi, 0). This part is zero for a can at rest, and for a can that turns
only about the vertical through its contact: theta' = phi' = 0.
"""

import numpy as np

from reference.equations.frames import to_body, to_level
from reference.equations.state_vector import LEAN, TURN, Angles
from reference.problem.states import Floats

# A slip or a rolling so small that nothing but its direction matters.
HARDLY = 1e-60
# Beside a turning about the vertical it must be larger, to have a direction beside the round-off of
# that: this one has it to 1e-5, and nothing else feels it.
BESIDE = 1e-11
# Level turning below this share of the whole is the round-off of turning about the vertical.
STILL = 1e-14


def level_turning(y: Floats) -> Floats:
    """Return the horizontal part, shape (2, n), of states (13, n)."""
    return to_level(y[TURN], Angles.of(y[LEAN]))[:2]


def stands(y: Floats) -> Floats:
    """Return whether the horizontal part is zero but for round-off, shape (n,), bool."""
    return np.asarray(np.hypot(*level_turning(y)) <= STILL * np.abs(y[TURN]).max(axis=0))


def with_level(y: Floats, level: Floats) -> Floats:
    """Return states (13, n) with the given horizontal part, shape (2, n)."""
    at = Angles.of(y[LEAN])
    vertical = to_level(y[TURN], at)[2]
    columns = y.copy()
    columns[TURN] = to_body(np.array([level[0], level[1], vertical]), at)
    return columns


def rolled(y: Floats, direction: Floats) -> Floats:
    """Return states that roll infinitely slowly, in the given directions, shape (2, n)."""
    vertical = np.abs(to_level(y[TURN], Angles.of(y[LEAN]))[2])
    return with_level(y, (HARDLY + BESIDE * vertical) * direction)
