"""Settings of PyBullet that change what is read, or what is printed."""

import numpy as np
import pytest

from harness.core.case import Case, Value
from harness.core.simulation import Simulation
from harness.engines.registry import engine
from models import Scene

DANTZIG = "CONSTRAINT_SOLVER_LCP_DANTZIG"


def _run(scene: Scene, timestep: float, **options: Value) -> Simulation:
    case = Case(scene=scene, engine="pybullet", timestep=timestep, options=tuple(options.items()))
    return engine("pybullet").simulate(case)


def test_of_a_timestep_in_parts_the_force_is_that_of_its_last_part(gentle: Scene) -> None:
    whole = _run(gentle, 4e-4, numSubSteps=4).trajectory
    parts = _run(gentle, 1e-4).trajectory
    assert whole is not None
    assert parts is not None
    weight = gentle.can.mass * gentle.gravity
    times = whole.time[(whole.time > 0.01) & (whole.time < 0.2)]
    for axis in range(3):
        mine = np.interp(times, whole.time, whole.contact_force[:, axis])
        fine = np.interp(times + 3e-4, parts.time, parts.contact_force[:, axis])
        np.testing.assert_allclose(mine, fine, atol=0.005 * weight)


def test_another_solver_finds_the_same_motion_and_says_nothing(
    gentle: Scene, capfd: pytest.CaptureFixture[str]
) -> None:
    shipped, other = _run(gentle, 1e-3), _run(gentle, 1e-3, constraintSolverType=DANTZIG)
    assert shipped.trajectory is not None
    assert other.trajectory is not None
    apart = np.abs(other.trajectory.position - shipped.trajectory.position).max()
    assert 0.0 < apart < 1e-6 * gentle.can.radius
    assert capfd.readouterr() == ("", "")
