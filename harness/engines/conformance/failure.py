"""Numerical failure: an outcome, never an exception, and never numbers that are none."""

from dataclasses import replace

import numpy as np

from harness.engines.conformance.bench import FINE, Bench
from harness.engines.conformance.verdict import Found, holds, not_applicable
from harness.engines.horizon import Watch
from harness.simulation import Outcome, Simulation
from models.scene import Horizon

_VIOLENT = 1e8
"""rad/s: the can would turn a hundred thousand times in a timestep of the suite."""

_COARSEST = 0.5
"""s: a timestep of a whole rocking."""

_DEPTH, _SHORT = 1e-3, 5e-6
"""m and s: a penetration that is pushed out within some steps."""


def divergence(bench: Bench) -> Found:
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


def flight(bench: Bench) -> Found:
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
