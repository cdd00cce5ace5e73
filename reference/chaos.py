"""How fast motions part that begin almost alike, and until when they can be compared at all.

A can with its mass off the axis is chaotic (Srinivasan and Ruina): a disturbance grows as
exp(rate t) whoever computes it, and once it has grown to the size of the motion two computations
agree or differ for no reason that can be named. Beside the release a few are followed that differ
by one part in 1e12; the distance of two motions is the angle between their orientations.
"""

from dataclasses import dataclass, replace

import numpy as np

from reference.integrate import solve
from reference.problem import Problem
from reference.solution import Solution
from reference.states import Floats, States

DISTURBANCE = 1e-12
# Motions as far apart as this, rad, have nothing to do with each other.
PARTED = 0.1
# From here to there a distance grows undisturbed by round-off and by its own size.
GROWING = (1e-11, 1e-3)
# Copies of a regular motion part like time, or its square; by more than this it takes chaos, and an
# engine's error of 1e-5 becomes as large as the motion.
CHAOTIC = 1e4
# A motion that takes more evaluations than this is seen in all its copies for its first part alone,
# of about so many: else four copies would take longer than anybody waits.
AFFORDED = 40_000
FIRST_PART = 15_000
# A copy that ends earlier than the motion by less, relative, ends with it: horizons are rounded,
# and what ends a motion comes sooner or later by as much as the disturbance has grown.
EARLIER = 1e-9
DISTURBED = ("phi", "theta", "psi_dot", "theta_dot")


@dataclass(frozen=True, slots=True, kw_only=True)
class Divergence:
    """How disturbed releases part from the undisturbed one.

    Attributes
    ----------
    times, distance : ndarray, shape (n,)
        The largest distance so far of any of them, rad.
    growth : float
        The last of it over the disturbance.
    rate : float
        Of exponential growth, Lyapunov's, in sqrt(g/R).
    parted : float
        When a disturbance of 1e-12 has grown to `PARTED`: foretold from the rate where that is
        beyond the motion, infinite where nothing grows.
    """

    times: Floats
    distance: Floats
    growth: float
    rate: float
    parted: float

    @property
    def chaotic(self) -> bool:
        """Whether the disturbance grows so much that agreement ends, and exponentially."""
        return self.growth > CHAOTIC and self.rate > 0


def divergence(problem: Problem, own: Solution | None = None) -> Divergence:
    """Return how releases part that differ from a problem's by one part in 1e12.

    Parameters
    ----------
    problem : Problem
        Followed by the smallest model that carries it.
    own : Solution, optional
        Of the problem itself, if it is known.
    """
    if own is None:
        own = solve(problem, model="auto")
    dear = own.evaluations > AFFORDED
    ends = own.t_end * (FIRST_PART / own.evaluations if dear else 1.0)
    times = own.grid()
    times = times[times <= ends]
    states, far = own.at(times), np.zeros_like(times)
    until = replace(problem, bounces=None, duration=ends)
    for name in DISTURBED:
        value = getattr(problem, name)
        moved = replace(until, **{name: value + DISTURBANCE * max(abs(value), 1e-3)})
        other = solve(moved, model="auto")
        gone = times > other.t_end * (1 + EARLIER)
        far[gone] = np.maximum(far[gone], PARTED)
        both = np.minimum(times[~gone], other.t_end)
        known = states if other.t_end >= times[-1] else own.at(both)
        far[~gone] = np.maximum(far[~gone], _distance(known, other.at(both)))
    far = np.maximum.accumulate(far)
    reached = times[far >= PARTED]
    growing = (far > GROWING[0]) & (far < GROWING[1])
    rate = 0.0
    if np.unique(far[growing]).size > 1:
        rate = float(np.polyfit(times[growing], np.log(far[growing]), 1)[0])
    return Divergence(
        times=times,
        distance=far,
        growth=float(far[-1] / DISTURBANCE),
        rate=rate,
        parted=float(reached[0]) if reached.size else _foretold(ends, far[-1], rate),
    )


def _foretold(ends: float, last: float, rate: float) -> float:
    """When a distance that goes on growing will have grown to the size of the motion."""
    return float(ends + np.log(PARTED / last) / rate) if rate > 0 and last > 0 else np.inf


def _distance(own: States, other: States) -> Floats:
    """Angle between orientations that are near each other, shape (n,): no arccos of almost 1."""
    psi = other.psi - own.psi
    total = (other.psi + other.theta) - (own.psi + own.theta)
    lean = other.phi - own.phi
    aside = np.sqrt(np.sin(own.phi) * np.sin(other.phi)) * 2 * np.sin(psi / 2)
    about = total - 2 * np.sin(own.phi / 2) * np.sin(other.phi / 2) * psi
    return np.asarray(np.sqrt(lean**2 + aside**2 + about**2))
