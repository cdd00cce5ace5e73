"""Numbers that prose cites of scenes and contacts, just inside and just outside each.

They are written out here and not imported: whoever changes one in the code is told which sentence
no longer holds. What is refused beyond them is in the tests of each class.
"""

from dataclasses import replace

import numpy as np
import pytest

from models import Effects, Horizon, InvalidValueError, Pose, Slip, load
from models.mjcf_contact import friction_solref, spring, surface

SCENE = load("gentle-rock")


def test_the_largest_horizon_and_the_longest_citation_are_allowed() -> None:
    assert Horizon(bounces=100_000).bounces == 100_000
    assert replace(SCENE, cite="x" * 500).cite == "x" * 500


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_quaternion_is_normalised_in_single_precision_at_least(sign: float) -> None:
    unit = np.array((1.0, 0.0, 0.0, 0.0))
    Pose(position=np.zeros(3), quaternion=(1.0 + sign * 0.99e-6) * unit)
    with pytest.raises(InvalidValueError) as caught:
        Pose(position=np.zeros(3), quaternion=(1.0 + sign * 1.01e-6) * unit)
    assert (caught.value.key, caught.value.allowed) == ("quaternion", "of unit length")


def test_a_contact_that_rubs_is_a_spring_whose_time_constant_is_four_timesteps() -> None:
    """But for the least impedance that MuJoCo allows, a ten-thousandth."""
    scene = replace(SCENE, effects=Effects(slip=Slip(mu=0.3)))
    assert spring(scene) is None
    share = 1.0 - 1e-4
    found = spring(scene, 1e-5)
    assert found == pytest.approx((-share / (4e-5) ** 2, -share / 4e-5), rel=1e-12)
    # half of the slip is taken back in a step
    assert friction_solref(1e-5) == pytest.approx((-1.0, -1e-4 / 2e-5), rel=1e-12)


def test_without_slip_friction_is_two_in_mujoco() -> None:
    assert surface(SCENE)["friction"].split()[0] == "2.0"
