"""Conditioning of a motion: how many digits the numbers of its release determine.

Near an equilibrium the force on phi is a small difference of terms. Gravity alone cancels
without loss (`reference.equations.balancing_angle`), and a motion near the balancing angle is
solved for exactly the doubles given; but its neighbours, one ulp away, move otherwise. Where
precession takes part, the terms are rounded before they cancel, and the motion is known to that
share only. A release that moves has its energy to round-off: it decides where phi turns, at the
top, by the energy over the square of the force that is left there.

Effects that no formula predicts are measured by solving the neighbours of a problem as well.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from enum import Enum

import numpy as np

from reference.equations.balancing_angle import short_of_balance
from reference.problem.can import ParameterError
from reference.problem.problem import Problem, ProblemError
from reference.problem.states import Floats, States, initial_states

# What is promised of every motion, relative; less than this is not worth a sentence.
PROMISED = 1e-9
EPS = float(np.finfo(float).eps)
# Of a force of some ten rounded terms, in a motion that may respond by ten times their share.
ROUNDINGS = 256 * EPS


class Lost(Enum):
    """What round-off takes from a motion, in the sentence that says how much."""

    ENERGY = (
        "At its highest the can all but balances, and round-off of the energy is up to {share:.0e} "
        "of what is left: the motion is known to no more than that."
    )
    FORCE = (
        "Beside steady rolling the forces on phi cancel, and round-off is up to {share:.0e} of "
        "what is left: the motion is known to no more than that."
    )
    NEIGHBOURS = (
        "Beside the balancing angle one ulp of phi changes the force on it by {share:.0e} of "
        "itself: the motion is that of exactly the numbers given."
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class RoundOff:
    """Loss by round-off of a motion.

    Attributes
    ----------
    lost : Lost
    share : float
        How much, relative.
    """

    lost: Lost
    share: float

    @property
    def sentence(self) -> str:
        """Return the loss in words."""
        return self.lost.value.format(share=self.share)


def round_off(problem: Problem, top: States) -> RoundOff | None:
    """Return the loss by round-off of a motion that rocks; None if below 1e-9.

    Parameters
    ----------
    problem : Problem
    top : States
        At a maximum of phi, shape (1,).
    """
    moving = problem.phi_dot != 0
    at = top if moving else initial_states(problem)
    left, terms = (float(part[0]) for part in _forces(at, problem))
    if moving:
        lost = ROUNDINGS * (1 + terms + problem.phi_dot**2) / left**2
    else:
        lost = float(lost_of_force(at, problem)[0])
    if lost > PROMISED:
        return RoundOff(lost=Lost.ENERGY if moving else Lost.FORCE, share=lost)
    changed = EPS * problem.phi / left
    if changed > PROMISED and not moving:
        return RoundOff(lost=Lost.NEIGHBOURS, share=changed)
    return None


def lost_of_force(states: States, problem: Problem) -> Floats:
    """Return the share of the force on phi that round-off takes, shape (n,)."""
    left, terms = _forces(states, problem)
    return np.asarray(ROUNDINGS * terms / left)


def _forces(states: States, problem: Problem) -> tuple[Floats, Floats]:
    """Return the force on phi, and the sum of the magnitudes of its rounded terms."""
    p = problem.parameters
    S, C = np.sin(states.phi), np.cos(states.phi)
    short: Floats = short_of_balance(np.asarray(p.h), states.phi)
    gravity = -np.sqrt(p.h**2 + 1) * np.sin(short)
    square = p.a_p * S * C + (p.c_p * S + p.h * (1 + 2 * C)) * 2 * np.sin(states.phi / 2) ** 2
    whirl = square * states.psi_dot**2
    drag = (p.c_p * S + p.h * C) * states.spin * states.psi_dot
    left = np.abs(gravity + (whirl - drag)) + np.finfo(float).tiny
    return np.asarray(left), np.asarray(np.abs(whirl) + np.abs(drag))


def neighbours(problem: Problem, share: float) -> Iterator[tuple[Problem, ...]]:
    """Yield for each number of a problem the problems in which it is a little larger or smaller.

    Parameters
    ----------
    problem : Problem
    share : float
        By how much, relative. A number that is zero stays: it has no digits to lose.

    Yields
    ------
    tuple of Problem
        Two, or one where the other is impossible: c = 2 a and phi = pi/2 are limits.
    """
    can = problem.parameters
    for name in ("a", "c", "h", "phi", "phi_dot", "psi_dot", "theta_dot"):
        value = getattr(can if name in {"a", "c", "h"} else problem, name)
        beside = []
        for factor in (1 + share, 1 - share) if value else ():
            try:
                if name in {"a", "c", "h"}:
                    moved = replace(can, **{name: value * factor})
                    beside.append(replace(problem, parameters=moved))
                else:
                    beside.append(replace(problem, **{name: value * factor}))
            except (ParameterError, ProblemError):
                continue
        if beside:
            yield tuple(beside)
