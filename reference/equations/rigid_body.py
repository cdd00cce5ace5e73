"""The rigid body: mass, centre and inertia of a can, and how its contact answers an impulse."""

from dataclasses import dataclass

import numpy as np

from reference.equations.frames import dot
from reference.equations.state_vector import Angles
from reference.problem.can import Parameters
from reference.problem.effects import Effects
from reference.problem.states import Floats


@dataclass(frozen=True, slots=True, kw_only=True)
class Setting:
    """Position and motion of the body, in frame B; vectors of shape (3, n).

    `moment`, shape (n,), is along the horizontal direction of the lean, times S: that of dry
    friction along the rim where the normal force is a state (`reference.equations.creeping`).
    """

    at: Angles
    mass: float
    inertia: Floats
    centre: Floats
    arm: Floats
    turning: Floats
    velocity: Floats
    arm_rate: Floats
    gravity: Floats
    shaking: Floats
    moment: Floats


def body_of(p: Parameters, e: Effects, theta: Floats) -> tuple[float, Floats, Floats]:
    """Return mass, centre of mass (3, n) from the can's centre, inertia (3, 3, n), in frame B."""
    n = theta.size
    inertia = np.repeat(np.diag([p.a, p.a, p.c])[..., None], n, axis=2)
    if e.mass is None:
        return 1.0, np.zeros((3, n)), inertia
    share, x, y, z = e.mass.share, e.mass.x, e.mass.y, e.mass.z
    cos, sin = np.cos(theta), np.sin(theta)
    place = np.array([x * cos - y * sin, x * sin + y * cos, z + 0 * cos])
    square = np.eye(3)[..., None] * dot(place, place) - place[:, None] * place[None]
    return 1 + share, share / (1 + share) * place, inertia + share / (1 + share) * square


def mobility_of(inverse: Floats, here: Setting, at: Angles) -> Floats:
    """Return D of `reference.equations.newton_euler`, in level directions, shape (n, 6, 6)."""
    n = at.S.size
    x, y, z = here.arm
    zero = np.zeros_like(x)
    arm = np.array([[zero, -z, y], [z, zero, -x], [-y, x, zero]]).transpose(2, 0, 1)
    lever = inverse @ arm
    level = np.zeros((n, 3, 3), dtype=x.dtype)
    level[:, 0, 0], level[:, 0, 2] = at.C, -at.S
    level[:, 2, 0], level[:, 2, 2] = at.S, at.C
    level[:, 1, 1] = 1.0
    back = np.swapaxes(level, 1, 2)
    D = np.empty((n, 6, 6), dtype=lever.dtype)
    D[:, :3, :3] = level @ inverse @ back
    D[:, :3, 3:] = level @ lever @ back
    D[:, 3:, :3] = np.swapaxes(D[:, :3, 3:], 1, 2)
    D[:, 3:, 3:] = np.eye(3) / here.mass - level @ arm @ lever @ back
    return D
