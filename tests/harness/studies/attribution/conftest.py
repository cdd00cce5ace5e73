"""What the tests of the attribution share."""

import pytest

from models import Scene, load


@pytest.fixture(scope="session")
def paper() -> Scene:
    """Return the paper's release, one bounce."""
    return load("paper-release")
