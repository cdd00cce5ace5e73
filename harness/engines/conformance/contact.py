"""The contact: of the same instant as the state, and obeying Newton's second law.

Both are told from what a reading of the next instant would give. Between samples t apart

    m (v' - v)/t = F - m g z

holds for the force F that was applied. A misfit as large as the change of F from sample to sample
is a force of the wrong instant; half of that is what a force at either end may differ from the
mean.

Numerical failure: an outcome, never an exception, and never numbers that are none.
"""

from dataclasses import replace

import numpy as np

from harness.core.simulation import Outcome, Simulation
from harness.engines.conformance.fixture import (
    COARSE,
    FINE,
    ClauseEvidence,
    Fixture,
    holds,
    not_applicable,
    within,
)
from harness.engines.stepping.horizon import Watch
from models.rim import contact_point
from models.scene import Horizon

NEWTON = 0.6
"""Misfit over the change of the force from sample to sample: 0 where the force of a step is told,
1/2 where that of its first instant is, with a tenth for the curvature; 1 is the next instant."""

SAME = 0.1
"""Distance of the contact point from the lowest point of the rim, over the way of that point from
sample to sample: 1 is the next instant. A tenth is left to engines that round the rim a little."""


def newton(bench: Fixture) -> ClauseEvidence:
    """Compare the force of each sample with the change of the velocity up to the next."""
    path = bench.trajectory(bench.case(bench.brief, COARSE))
    can, gravity = bench.brief.can, bench.brief.gravity
    if len(path) < 3:  # noqa: PLR2004 - two changes of the velocity to compare one change of force
        return holds(f"{len(path)} samples are too few", "")
    gained = can.mass * np.diff(path.velocity, axis=0) / np.diff(path.time)[:, None]
    weight = np.array((0.0, 0.0, can.mass * gravity))
    misfit = np.linalg.norm(gained - path.contact_force[:-1] + weight, axis=1)
    change = np.linalg.norm(np.diff(path.contact_force, axis=0), axis=1)
    # root mean squares, so that one step in which the force happens to rest does not decide
    ratio = float(np.sqrt(np.mean(misfit**2) / np.mean(change**2)))
    worst = float(misfit.max()) / (can.mass * gravity)
    detail = f"misfit over the change of the force; at most {worst:.1g} of the weight"
    return within(ratio, NEWTON, "1", detail)


def same_instant(bench: Fixture) -> ClauseEvidence:
    """Compare the contact point of each sample with the lowest point of the rim."""
    path = bench.trajectory(bench.case(bench.gentle, FINE))
    low = contact_point(bench.gentle.can, path.position, path.quaternion)
    single = (path.contact_count == 1)[:-1]
    if not single.any():
        return holds("no sample touches in one point", "")
    off = np.linalg.norm((path.contact_point - low)[:-1, :2], axis=1)[single]
    way = np.linalg.norm(np.diff(low[:, :2], axis=0), axis=1)[single]
    ratio = float(np.sqrt(np.mean(off**2) / np.mean(way**2)))
    worst = float(off.max()) / bench.gentle.can.radius
    detail = f"distance over the way between samples; at most {worst:.1g} of the radius"
    return within(ratio, SAME, "1", detail)


_VIOLENT = 1e8
"""rad/s: the can would turn a hundred thousand times in a timestep of the suite."""

_COARSEST = 0.5
"""s: a timestep of a whole rocking."""

_DEPTH, _SHORT = 1e-3, 5e-6
"""m and s: a penetration that is pushed out within some steps."""


def divergence(bench: Fixture) -> ClauseEvidence:
    """Ask for what few engines can do, and see that they say so.

    Violent rates; a timestep as long as the motion; and a rim that starts inside the plane, which a
    contact tied to a short timestep throws out at any speed.
    """
    if not bench.steps:
        return not_applicable("a solver that chooses its own steps takes as many as it needs")
    release = bench.brief.release
    violent = replace(release, phi_dot=_VIOLENT, theta_dot=_VIOLENT)
    sunk = replace(release, height=-_DEPTH)
    told = []
    for scene, timestep in (
        (replace(bench.brief, release=violent), 1e-3),
        (replace(bench.gentle, horizon=Horizon(seconds=20.0)), _COARSEST),
        (replace(bench.brief, release=sunk), _SHORT),
    ):
        simulation = bench.run_anew(bench.case(scene, timestep))  # raises where the answer does
        outcome: object = simulation.outcome
        if not isinstance(outcome, Outcome):
            return holds(f"`outcome` is {outcome!r}, not an Outcome", "")
        if _exploded(simulation) and outcome is not Outcome.DIVERGED:
            return holds(f"the speed grows without bound, and the outcome is {outcome.name}", "")
        told.append(simulation.outcome.name.lower().replace("_", " "))
    return holds("", ", ".join(told))


def _exploded(simulation: Simulation) -> bool:
    """Whether the record reaches a speed that no fall gives."""
    path = simulation.trajectory
    return path is not None and Watch(simulation.case.scene).over(path) is Outcome.DIVERGED


def flight(bench: Fixture) -> ClauseEvidence:
    """Throw the can up: where nothing touches there is no contact point, and no force."""
    if not bench.steps:
        return not_applicable("a can that rolls by its equations does not leave the plane")
    path = bench.trajectory(bench.case(bench.thrown, FINE))
    pointed = np.isfinite(path.contact_point).all(axis=1)
    pushed = path.contact_force[:, 2] > 0.0
    wrong = []
    if (pointed != pushed).any():
        wrong.append(f"{int((pointed != pushed).sum())} samples with a point but no force, or not")
    if ((path.contact_count > 0) != pushed).any():
        wrong.append("the number of points that bear a force does not tell whether one does")
    if np.any(path.contact_force[~pushed] != 0.0):
        wrong.append("a force without a load")
    if pushed.all():
        wrong.append("the thrown can never leaves the plane")
    return holds("; ".join(wrong), f"{int((~pushed).sum())} of {len(path)} samples in flight")
