"""What the tests of studies share."""

import pytest

from harness.core.trajectory import Trajectory
from tests.harness.studies.changed_motions import SCENE, exact_trajectory


@pytest.fixture(scope="session")
def exact() -> Trajectory:
    """Return the exact motion of `changed_motions.SCENE`."""
    return exact_trajectory(SCENE)
