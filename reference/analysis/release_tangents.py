"""Derivatives of the release of a motion, by the numbers of a problem.

A contact that gives way is as deep at the release as bears the normal force of a rigid one, which
depends on the release, on the can and on all its effects.
"""

from dataclasses import replace
from typing import Any

import numpy as np

from reference.analysis.linearisation import (
    CORE,
    NUMBER,
    STEP,
    Quantity,
    UndecidedError,
    by_state,
    core_of,
)
from reference.analysis.stepped_constants import constants, equations_of_contact, stepped
from reference.analysis.variational import release_disturbances
from reference.compliant.equations import DEPTH, CompliantEquations
from reference.compliant.integrator import bears, load_of, on_rigid_plane
from reference.equations.contact_laws import Mode
from reference.equations.newton_euler import GeneralEquations
from reference.equations.state_vector import U1, U2, W2
from reference.integrable.tangents import BY
from reference.nonsmooth.segments import Segment
from reference.problem.problem import Problem
from reference.problem.states import Floats

HELD = (
    "friction holds a turning at the release: what stops a disturbance of it moves a contact that "
    "gives way as well"
)
CAN = ("a", "c", "h")
OF_RELEASE = frozenset({*BY, "height"} - {*CAN})


def numbers(problem: Problem) -> tuple[str, ...]:
    """Return the numbers of a problem by which derivatives are taken."""
    height = ("height",) if problem.height > 0 else ()
    return (*BY, *height, *constants(problem.effects))


def released_tangents(problem: Problem, first: Segment, by: tuple[str, ...]) -> Floats:
    """Return the derivatives of the state at the release, by the core of its piece, (k, m)."""
    out = np.zeros((core_of(first.start).size, len(by)))
    # of those of `release_disturbances`: phi, psi' and theta'; phi' has the place of theta
    out[: CORE.size, [0, 2, 3]] = release_disturbances(problem)[:, [0, 2, 3]]
    out[NUMBER[W2], 1] = -1.0
    if problem.height > 0:
        out[NUMBER[DEPTH], by.index("height")] = -1.0
    elif problem.effects.compliance is not None and not first.mode.flies:
        out[NUMBER[DEPTH]] = _deeper(problem, first, by, out[: CORE.size])
    return out


def _deeper(problem: Problem, first: Segment, by: tuple[str, ...], release: Floats) -> Floats:
    """Return the derivatives of the depth that bears the normal force of a rigid contact, (m,).

    A slip that begins at the release has the direction of its acceleration, whose angle moves.
    """
    equations = equations_of_contact(problem.parameters, problem.effects)
    rigid, start, now = on_rigid_plane(problem)
    if equations.moments_that_hold(first.mode) or rigid.moments_that_hold(now.mode):
        raise UndecidedError(HELD)
    plane = replace(problem, effects=replace(problem.effects, patch=0.0, compliance=None))
    known = constants(plane.effects)
    y = now.infinitesimal(start)

    def slope(quantity: Quantity) -> tuple[Floats, Floats]:
        """Return the derivatives of a quantity by the core, and of all by the numbers."""
        by_core = by_state(quantity, rigid, y, now.mode)
        out = by_core @ release
        for place, name in enumerate(by):
            if name in known or name in CAN:
                varied = quantity(stepped(plane, name), y.astype(complex), now.mode)
                out[place] += varied[0].imag / STEP
        return by_core, out

    load = np.zeros(len(by))
    if bears(now):
        by_core, load = slope(load_of)
        if now.slip is not None:
            turned = np.zeros(by_core.size)
            turned[[NUMBER[U1], NUMBER[U2]]] = -y[U2, 0], y[U1, 0]
            aside, moved = slope(_aside)
            load = load - by_core @ turned * moved / (aside @ turned)
    deep: Any = first.start[DEPTH, None].astype(complex)
    for place, name in enumerate(by):
        if name.startswith("compliance."):
            load[place] -= _elastic(stepped(problem, name), deep)
    return np.asarray(load / _elastic(equations, deep + 1j * STEP))


def _elastic(equations: GeneralEquations, stepped_depth: Floats) -> float:
    """Return the derivative of the elastic force by what is stepped in it."""
    assert isinstance(equations, CompliantEquations)  # noqa: S101 - no other contact has a depth
    return float(equations.elastic_force(stepped_depth).imag[0] / STEP)


def _aside(rigid: GeneralEquations, y: Floats, mode: Mode) -> Floats:
    """Return the acceleration of a slip across its direction, times its size."""
    ahead, aside = rigid.contact(y, mode).slipping
    return np.asarray(y[U1] * aside - y[U2] * ahead)
