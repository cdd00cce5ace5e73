"""The static penetration, on toy contacts whose depth is known."""

# ruff: noqa: D102 - the methods of a toy are described where its role is

from dataclasses import replace

import numpy as np
import pytest

from harness.engines.stepping.settling import settle
from harness.engines.world import Contact
from models import Pose, Scene, Twist, contact_point, release_state


class Spring:
    """A world of one step: a spring of so much stiffness, N/m, below a plane at some height."""

    def __init__(self, scene: Scene, stiffness: float, height: float = 0.0) -> None:
        self.scene, self.stiffness, self.height = scene, stiffness, height
        self.mass, self.timestep = scene.can.mass, 1e-4
        self.inertia = np.ones(3)

    def place(self, pose: Pose, twist: Twist) -> None:
        self._pose, self._twist = pose, twist

    def signed_distance(self) -> float:
        low = contact_point(self.scene.can, self._pose.position, self._pose.quaternion)
        return float(low[2]) - self.height

    def step(self) -> None:
        push = self.stiffness * max(0.0, -self.signed_distance()) / self.mass - self.scene.gravity
        velocity = self._twist.velocity + np.array((0.0, 0.0, push * self.timestep))
        self._twist = Twist(velocity=velocity, angular_velocity=self._twist.angular_velocity)

    def pose(self) -> Pose:
        return self._pose

    def twist(self) -> Twist:
        return self._twist

    def set_timestep(self, timestep: float) -> None:
        raise AssertionError(timestep)

    def contact(self) -> Contact:
        raise AssertionError("settling is a matter of the gap alone")


@pytest.mark.parametrize("stiffness", [1e3, 1e5, 1e9])
@pytest.mark.parametrize("height", [0.0, 1e-3, -1e-3])
def test_a_spring_is_compressed_by_the_weight(
    gentle: Scene, stiffness: float, height: float
) -> None:
    pose, twist = release_state(gentle.can, gentle.release)
    world = Spring(gentle, stiffness, height)
    depth, settled = settle(world, gentle, pose, twist)
    # the search stops at 1e-6 of its bracket, which is within a factor of four of the depth; the
    # gap itself is a difference of lengths of the size of the can
    expected = gentle.can.mass * gentle.gravity / stiffness
    assert depth == pytest.approx(expected, rel=4e-6, abs=1e-16)
    lowered = pose.position[2] - settled.position[2]
    assert lowered == pytest.approx(depth - height, rel=1e-9, abs=1e-16)
    np.testing.assert_array_equal(settled.position[:2], pose.position[:2])
    np.testing.assert_array_equal(settled.quaternion, pose.quaternion)


def test_a_contact_that_takes_more_than_a_tenth_of_the_radius_is_not_settled(gentle: Scene) -> None:
    pose, twist = release_state(gentle.can, gentle.release)
    depth, settled = settle(Spring(gentle, 1e2), gentle, pose, twist)
    assert depth == 0.0
    np.testing.assert_allclose(settled.position, pose.position, atol=1e-16, rtol=0)  # an ulp


def test_without_a_load_there_is_no_depth(gentle: Scene) -> None:
    scene = replace(gentle, gravity=0.0)
    pose, twist = release_state(scene.can, scene.release)
    depth, _ = settle(Spring(scene, 1e5), scene, pose, twist)
    assert depth == 0.0
