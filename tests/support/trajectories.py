"""Trajectories made by hand."""

from dataclasses import replace
from typing import Any

import numpy as np

from harness.core.simulation import Simulation
from harness.core.trajectory import Trajectory


def path_of(simulation: Simulation) -> Trajectory:
    """Return the trajectory of a simulation that has one."""
    assert simulation.trajectory is not None, simulation.ending
    return simulation.trajectory


def changed(simulation: Simulation, **fields: Any) -> Simulation:
    """Return a simulation with other arrays in its trajectory, if it has one."""
    if simulation.trajectory is None:
        return simulation
    return replace(simulation, trajectory=replace(simulation.trajectory, **fields))


def make_trajectory(samples: int, **given: Any) -> Trajectory:
    """Return a trajectory of n samples, s apart, at rest at the origin but for what is given."""
    ones = np.ones(samples)
    fields = {
        "time": np.arange(samples, dtype=float),
        "position": np.zeros((samples, 3)),
        "quaternion": np.outer(ones, (1.0, 0.0, 0.0, 0.0)),
        "velocity": np.zeros((samples, 3)),
        "angular_velocity": np.zeros((samples, 3)),
        "contact_point": np.zeros((samples, 3)),
        "contact_force": np.outer(ones, (0.0, 0.0, 1.0)),
        "penetration": np.zeros(samples),
        "contact_count": np.ones(samples, dtype=np.int64),
    }
    return Trajectory(**(fields | given))
