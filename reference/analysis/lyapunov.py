"""Divergence of motions with almost equal releases, and how long two motions can be compared.

A can with its mass off the axis is chaotic (Srinivasan and Ruina): a disturbance grows as
exp(rate t) in every computation, and once it has grown to the size of the motion, agreement or
difference of two computations means nothing. Disturbances of the release by one part in 1e12 are
integrated by the variational equations (`reference.analysis.variational`). These are linear, so
that a disturbance continues to grow beyond the largest possible distance of two motions. The
distance of two motions is the angle between their orientations.

On a contact that gives way disturbed releases are solved themselves, and disturbed by more.
"""

from dataclasses import dataclass, replace

import numpy as np

from reference.analysis.variational import (
    DISTURBED,
    release_disturbances,
    stretches,
    without_tangent,
)
from reference.equations.newton_euler import GeneralEquations
from reference.nonsmooth.segments import SegmentsPath
from reference.problem.problem import Problem
from reference.problem.states import Floats, States
from reference.solution import Solution
from reference.solver import solve

DISTURBANCE = 1e-12
# Of a rate or an angle smaller than this the disturbance is one part in 1e12 of this.
LEAST = 1e-3
# Angle between orientations, rad, from which two motions have nothing to do with each other.
PARTED = 0.1
# From here on a distance grows at its rate: before it finds the direction that grows fastest.
GROWING = 1e-11
# Copies of a regular motion part like time, or its square; by more than this it takes chaos, and an
# engine's error of 1e-5 becomes as large as the motion.
CHAOTIC = 1e4
# Of the copies on a contact that gives way: above the round-off of what its stiffness multiplies.
OF_COPIES = 1e-9
INSTANTS = 400
# Logarithm of the largest distance that is said: beyond it a double would overflow.
LARGEST = 600.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Divergence:
    """Growth of the difference between disturbed releases and the undisturbed one.

    Attributes
    ----------
    times, distance : ndarray, shape (n,)
        The largest distance so far of any disturbed release, rad, by the linear equations: beyond
        `PARTED` a measure of growth, and no longer the distance of two motions.
    growth : float
        The last distance over the disturbance.
    rate : float
        Of exponential growth, Lyapunov's, in sqrt(g/R); 0 where nothing has grown tenfold.
    parted : float
        Time at which a disturbance of 1e-12 has grown to `PARTED`: predicted from the rate where
        that is beyond the motion, infinite where nothing grows.
    """

    times: Floats
    distance: Floats
    growth: float
    rate: float
    parted: float

    @property
    def chaotic(self) -> bool:
        """Return whether the disturbance grows exponentially, and so much that agreement ends."""
        return self.growth > CHAOTIC and self.rate > 0


def divergence(problem: Problem, own: Solution | None = None) -> Divergence:
    """Return the divergence of releases that differ from a problem's by one part in 1e12.

    Parameters
    ----------
    problem : Problem
        Solved by the smallest model that carries it.
    own : Solution, optional
        Of the problem itself, if it is known.
    """
    if own is None:
        own = solve(problem, model="auto")
    if problem.effects.compliance is not None:
        return _by_copies(problem, own)
    path = own.path
    if not isinstance(path, SegmentsPath):
        # closed forms have no pieces
        until = replace(problem, bounces=None, duration=own.t_end)
        path = solve(until, model="general").path
        assert isinstance(path, SegmentsPath)  # noqa: S101 - what the general can is followed on
    if without_tangent(path.pieces):
        return _by_copies(problem, own)
    equations = GeneralEquations(parameters=problem.parameters, effects=problem.effects)
    sizes = [max(abs(getattr(problem, name)), LEAST) for name in DISTURBED]
    start = DISTURBANCE * np.array(sizes) * release_disturbances(problem)
    times, logarithms = [], []
    for stretch in stretches(equations, path.pieces, start):
        times.append(stretch.times)
        with np.errstate(divide="ignore"):  # what is not disturbed at all
            logs = np.log(stretch.angles()) + stretch.logarithms[:, None]
        logarithms.append(logs.max(axis=0))
    return _read(np.concatenate(times), np.maximum.accumulate(np.concatenate(logarithms)))


def _by_copies(problem: Problem, own: Solution) -> Divergence:
    """Return the divergence that solutions of disturbed releases show."""
    until = replace(problem, bounces=None, duration=own.t_end)
    largest = np.full(INSTANTS, -np.inf)
    times = np.linspace(0.0, own.t_end, INSTANTS)
    for name in DISTURBED:
        value = getattr(problem, name)
        step = OF_COPIES * max(abs(value), LEAST)
        other = solve(replace(until, **{name: value + step}))
        at = np.minimum(times, other.t_end)
        distance = _angle_between(own.at(at), other.at(at))
        with np.errstate(divide="ignore"):  # what is not disturbed at all
            largest = np.maximum(largest, np.log(distance))
    seen = np.maximum.accumulate(largest) + np.log(DISTURBANCE / OF_COPIES)
    return _read(times[1:], seen[1:])


def _angle_between(one: States, other: States) -> Floats:
    """Return the angle of the rotation from one orientation to another, shape (n,), rad."""
    lean = np.sin((one.phi - other.phi) / 2), np.sin(one.phi) * np.sin(other.phi)
    turn = np.sin((one.psi - other.psi) / 2)
    axes = 2 * np.arcsin(np.sqrt(np.clip(lean[0] ** 2 + lean[1] * turn**2, 0.0, 1.0)))
    spin = (one.psi + one.theta) - (other.psi + other.theta)
    return np.asarray(np.hypot(axes, 2 * np.abs(np.sin(spin / 2))))


def _read(times: Floats, logarithms: Floats) -> Divergence:
    """Return the divergence that logarithms of distances, which never fall, show."""
    last = float(logarithms[-1])
    rate = 0.0
    growing = logarithms > np.log(GROWING)
    if np.unique(logarithms[growing]).size > 1:
        rate = float(np.polyfit(times[growing], logarithms[growing], 1)[0])
    reached = times[logarithms >= np.log(PARTED)]
    foretold = times[-1] + (np.log(PARTED) - last) / rate if rate > 0 else np.inf
    return Divergence(
        times=times,
        distance=np.exp(np.minimum(logarithms, LARGEST)),
        growth=float(np.exp(min(last, LARGEST)) / DISTURBANCE),
        rate=rate,
        parted=float(reached[0] if reached.size else foretold),
    )
