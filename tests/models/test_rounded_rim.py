"""A rim that is an arc: where it touches, and how a can is released on it."""

from dataclasses import replace

import numpy as np
import pytest

from models import Effects, Release, RoundedRim, contact_offset, load, quaternion, to_body
from models.rim import arc_of, release_state, released, rolling_velocity

CAN = load("gentle-rock").can
ARC = 2e-3
EPS = np.finfo(np.float64).eps


@pytest.mark.parametrize("phi", [0.05, 0.4, 1.2])
@pytest.mark.parametrize("psi", [0.0, 2.0])
def test_the_offset_is_the_lowest_point_of_the_arc(phi: float, psi: float) -> None:
    turn = np.linspace(-np.pi, np.pi, 721)[:, None]  # round the rim, and round its section
    tube = np.linspace(0.0, np.pi / 2.0, 181)[None, :]
    out = CAN.radius - ARC + ARC * np.sin(tube)
    low = -(CAN.half_height - ARC) - ARC * np.cos(tube)
    points = np.stack(
        np.broadcast_arrays(out * np.cos(turn), out * np.sin(turn), low * np.ones_like(turn)), -1
    ).reshape(-1, 3)
    back = quaternion(phi, psi, 0.0) * np.array((1.0, -1.0, -1.0, -1.0))
    in_world = to_body(back, points)
    lowest = in_world[np.argmin(in_world[:, 2])]
    found = contact_offset(CAN, phi, psi, arc=ARC)
    # a grid of half a degree: its square over 8 in height, itself in place
    grid = np.radians(0.5)
    assert found[2] == pytest.approx(lowest[2], abs=grid**2 * CAN.radius)
    assert found[2] <= lowest[2] + 4 * EPS
    np.testing.assert_allclose(found, lowest, atol=grid * CAN.radius, rtol=0)


def test_without_an_arc_it_is_the_sharp_rim() -> None:
    scene = load("gentle-rock")
    assert arc_of(scene.effects) == 0.0
    pose, twist = released(scene)
    sharp, moving = release_state(scene.can, scene.release)
    np.testing.assert_array_equal(pose.position, sharp.position)
    np.testing.assert_array_equal(twist.velocity, moving.velocity)


def test_the_released_can_touches_and_rolls_on_its_arc() -> None:
    release = Release(phi=0.4, psi=0.3, phi_dot=-0.5, psi_dot=2.0, theta_dot=-1.0)
    scene = replace(
        load("gentle-rock"), release=release, effects=Effects(rim=RoundedRim(radius=ARC))
    )
    pose, twist = released(scene)
    offset = contact_offset(CAN, 0.4, 0.3, arc=ARC)
    assert pose.position[2] + offset[2] == 0.0
    slip = twist.velocity + np.cross(twist.angular_velocity, offset)
    np.testing.assert_allclose(slip, 0.0, atol=8 * EPS * 2.0 * CAN.bounding_radius)
    np.testing.assert_array_equal(
        twist.velocity, rolling_velocity(CAN, 0.4, 0.3, twist.angular_velocity, arc=ARC)
    )
