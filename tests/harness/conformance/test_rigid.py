"""Rigid-body mechanics told anew agrees with the reference, which knows other equations."""

import numpy as np
import pytest

from harness.engines.conformance.motion import rolling_acceleration
from harness.engines.reference.truth import truth
from models import Pose, Twist, load

EPS = np.finfo(np.float64).eps


@pytest.mark.parametrize("scene", ["gentle-rock", "wobble", "steady-rolling", "petals"])
def test_the_force_is_that_of_the_reference(scene: str) -> None:
    own = load(scene)
    exact = truth(own)
    times = np.linspace(0.0, exact.ends, 17)
    path = exact.at(times)
    for i in range(len(times)):
        _, _, force = rolling_acceleration(
            own.can,
            own.gravity,
            Pose(position=path.position[i], quaternion=path.quaternion[i]),
            Twist(velocity=path.velocity[i], angular_velocity=path.angular_velocity[i]),
        )
        scale = np.linalg.norm(path.contact_force[i])
        # nine equations whose matrix is of condition 1e3 in SI units, of a state known to the
        # reference's 1e-12
        assert np.abs(force - path.contact_force[i]).max() < 1e-9 * scale


def test_the_acceleration_is_the_derivative_of_the_velocity() -> None:
    own = load("wobble")
    exact = truth(own)
    step = 1e-5  # s
    path = exact.at(np.array((0.1, 0.1 + step, 0.1 + 2.0 * step)))
    a, e, _ = rolling_acceleration(
        own.can,
        own.gravity,
        Pose(position=path.position[1], quaternion=path.quaternion[1]),
        Twist(velocity=path.velocity[1], angular_velocity=path.angular_velocity[1]),
    )
    for found, exactly in ((a, path.velocity), (e, path.angular_velocity)):
        central = (exactly[2] - exactly[0]) / (2.0 * step)
        # central differences leave (rate step)^2/6; the contact point runs round at some 500 rad/s
        assert np.abs(central - found).max() < 5e-6 * np.abs(found).max()


def test_a_can_at_rest_in_balance_stays() -> None:
    own = load("gentle-rock")
    half = own.can.balancing_angle / 2.0
    pose = Pose(
        position=np.array((0.0, 0.0, own.can.bounding_radius)),
        quaternion=np.array((np.cos(half), 0.0, -np.sin(half), 0.0)),
    )
    still = Twist(velocity=np.zeros(3), angular_velocity=np.zeros(3))
    a, e, force = rolling_acceleration(own.can, own.gravity, pose, still)
    assert np.abs(a).max() < 100.0 * EPS * own.gravity
    assert np.abs(e).max() < 100.0 * EPS * own.gravity / own.can.radius
    weight = own.can.mass * own.gravity
    np.testing.assert_allclose(force, (0.0, 0.0, weight), atol=100.0 * EPS * weight)
