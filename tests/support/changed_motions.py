"""The exact motion of a scene with something changed, as an engine's run: for tests of verdicts."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from harness.core.case import Case
from harness.core.simulation import Outcome, Simulation
from harness.core.trajectory import Trajectory
from harness.engines.reference.truth import truth
from harness.evaluation.evaluate import measure_simulation
from harness.evaluation.evaluation import Evaluation
from models import Horizon, Scene, load, quaternion
from models.kinematics import angles

Fields = dict[str, np.ndarray]
"""The arrays of a trajectory by name."""

Change = Callable[[Fields], None]
"""Changes some of them in place."""

SCENE = replace(load("gentle-rock"), horizon=Horizon(seconds=0.33))
"""A whole bounce, and a little more."""


def exact_trajectory(scene: Scene) -> Trajectory:
    """Return the exact motion of a scene on its own grid."""
    own = truth(scene)
    return own.at(own.grid())


def changed(trajectory: Trajectory, change: Change) -> Trajectory:
    """Return a trajectory with something changed."""
    fields = {name: np.array(getattr(trajectory, name)) for name in trajectory.__slots__}
    change(fields)
    return Trajectory(**fields)


def run_of(
    trajectory: Trajectory | None, scene: Scene = SCENE, outcome: Outcome = Outcome.FINISHED
) -> Evaluation:
    """Return a trajectory as the measured run of an engine."""
    return measure_simulation(
        Simulation(
            case=Case(scene=scene, engine="mujoco", timestep=1e-4),
            outcome=outcome,
            trajectory=trajectory,
            engine_version="0",
            model="by hand",
            timestep=1e-4,
        )
    )


def turn_further(exact: Trajectory, degrees: float) -> Change:
    """Return the change that turns all about the vertical from the middle of the bounce on."""
    phi, psi, theta = angles(exact.quaternion)
    further = math.radians(degrees) * (exact.time > exact.time[np.argmin(phi)])

    def turn(fields: Fields) -> None:
        fields["quaternion"] = quaternion(phi, psi + further, theta)
        x, y, _ = fields["angular_velocity"].T.copy()
        fields["angular_velocity"][:, 0] = x * np.cos(further) - y * np.sin(further)
        fields["angular_velocity"][:, 1] = x * np.sin(further) + y * np.cos(further)

    return turn


def lean_further(exact: Trajectory, share: float) -> Change:
    """Return the change that adds a share of the largest phi to phi."""
    phi, psi, theta = angles(exact.quaternion)

    def lean(fields: Fields) -> None:
        fields["quaternion"] = quaternion(phi + share * float(phi.max()), psi, theta)

    return lean
