"""The lowest point of the rim, its slip, and the release."""

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from models import Can, Release, contact_point, contact_velocity, quaternion, release_state, to_body

EPS = np.finfo(np.float64).eps
CAN = Can.from_groups(mass=0.043, radius=0.037, a=0.727, c=0.615, h=1.473)

releases = st.builds(
    Release,
    phi=st.floats(1e-9, np.pi / 2 - 1e-9),
    psi=st.floats(-10.0, 10.0),
    theta=st.floats(-10.0, 10.0),
    phi_dot=st.floats(-10.0, 10.0),
    psi_dot=st.floats(-1e3, 1e3),
    theta_dot=st.floats(-1e3, 1e3),
)


@given(release=releases)
def test_the_released_can_touches_the_plane_and_does_not_slip(release: Release) -> None:
    pose, twist = release_state(CAN, release)
    point = contact_point(CAN, pose.position, pose.quaternion)
    slip = contact_velocity(CAN, pose.quaternion, twist.velocity, twist.angular_velocity)
    # phi comes back from the quaternion to an ulp or two, and moves the rim by that times its
    # distance; psi likewise, by the speed of the centre times a few ulps of its size.
    assert abs(point[2]) <= 8 * EPS * CAN.bounding_radius
    speed = CAN.bounding_radius * np.linalg.norm(twist.angular_velocity)
    assert np.linalg.norm(slip) <= 64 * EPS * speed


@example(Release(phi=1.0, phi_dot=0.0, psi_dot=2.2250738585e-313, theta_dot=2.2250738585e-313))
@given(release=releases)
def test_the_centre_of_mass_is_above_the_origin_and_moves_as_the_paper_says(
    release: Release,
) -> None:
    pose, twist = release_state(CAN, release)
    r, R, H = release, CAN.radius, CAN.half_height
    s, c = np.sin(r.phi), np.cos(r.phi)
    assert tuple(pose.position[:2]) == (0.0, 0.0)
    assert pose.position[2] == R * s + H * c
    # (eq01:com_velocity), its bracket closed where it must be
    inwards = -r.phi_dot * (R * s + H * c)
    across = r.psi_dot * (R * c - H * s) + R * r.theta_dot
    cos, sin = np.cos(r.psi), np.sin(r.psi)
    expected = (
        inwards * cos - across * sin,
        inwards * sin + across * cos,
        r.phi_dot * (R * c - H * s),
    )
    size = CAN.bounding_radius * (abs(r.phi_dot) + abs(r.psi_dot) + abs(r.theta_dot))
    # of a speed below the least normal number an ulp is the least number there is
    ulp = max(EPS * size, np.finfo(np.float64).smallest_subnormal)
    np.testing.assert_allclose(twist.velocity, expected, atol=16 * ulp, rtol=0)


@pytest.mark.parametrize("phi", [1e-6, 0.3, 1.5, 1.7, 3.0])
def test_no_point_of_either_rim_is_lower(phi: float) -> None:
    q = quaternion(phi, 0.8, -0.3)
    lowest = contact_point(CAN, np.zeros(3), q)
    angle = np.linspace(0.0, 2.0 * np.pi, 4001)
    for height in (-CAN.half_height, CAN.half_height):
        rim = np.stack(
            (CAN.radius * np.cos(angle), CAN.radius * np.sin(angle), np.full(4001, height)), axis=-1
        )
        to_world = q * (1.0, -1.0, -1.0, -1.0)  # the conjugate: to_body of it is from the body
        assert to_body(to_world, rim)[:, 2].min() >= lowest[2] - 4 * EPS * CAN.bounding_radius
    in_body = to_body(q, lowest)
    # it is on the rim
    assert np.hypot(*in_body[:2]) == pytest.approx(CAN.radius, rel=8 * EPS, abs=0)
    assert abs(in_body[2]) == pytest.approx(CAN.half_height, rel=8 * EPS, abs=0)


def test_records_are_handled_at_once() -> None:
    q = quaternion(np.linspace(0.1, 1.0, 5), 0.2, 0.3)
    points = contact_point(CAN, np.ones((5, 3)), q)
    velocities = contact_velocity(CAN, q, np.ones((5, 3)), np.ones((5, 3)))
    assert points.shape == velocities.shape == (5, 3)
    one = contact_point(CAN, np.ones(3), q[2])
    np.testing.assert_array_equal(points[2], one)  # the same operations: equal bits
