"""Changes of a state: between two states, and from one state to another."""

import numpy as np
import pytest

from harness.core.trajectory import Trajectory
from harness.engines.linearised import LinearisedMotion, change_between
from harness.studies.gradients.design import value_of
from harness.sweep.parameters import scene_at
from models import load
from models.rim import released


@pytest.mark.parametrize("key", ["release.phi", "release.psi", "release.theta_dot"])
def test_a_motion_is_displaced_to_where_the_change_leads(key: str) -> None:
    scene = load("gentle-rock")
    before = value_of(scene, key)
    start, near, far = (released(scene_at(scene, {key: before + s})) for s in (0.0, 1e-7, 1e-3))
    change = change_between(start, near, 1e-7)
    nothing = np.full((1, 3), np.nan)
    motion = Trajectory(
        time=np.zeros(1),
        position=start[0].position[None],
        quaternion=start[0].quaternion[None],
        velocity=start[1].velocity[None],
        angular_velocity=start[1].angular_velocity[None],
        contact_point=nothing,
        contact_force=nothing,
        penetration=nothing[:, 0],
        contact_count=np.ones(1, dtype=np.int64),
    )
    moved = LinearisedMotion(trajectory=motion, changes=change[None, :, None]).displaced(0, 1e-3)
    pose, twist = far
    # what is left is of second order: a millionth, times curvatures of about one
    assert moved.position[0] == pytest.approx(pose.position, abs=1e-6)
    assert abs(moved.quaternion[0] @ pose.quaternion) == pytest.approx(1.0, abs=1e-12)
    assert moved.velocity[0] == pytest.approx(twist.velocity, abs=1e-6)
    assert moved.angular_velocity[0] == pytest.approx(twist.angular_velocity, abs=1e-6)
    assert np.abs(change).max() > 1e-3
