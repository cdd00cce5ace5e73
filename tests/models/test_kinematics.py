"""Angles to quaternion and back, against the paper's matrices and against 60-digit arithmetic."""

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from models import angle_rates, angles, angular_velocity, load, principal, quaternion, to_body
from models.kinematics import angles_of_record, half_angles

EPS = np.finfo(np.float64).eps

tilts = st.floats(1e-12, np.pi - 1e-12) | st.floats(-300.0, 0.0).map(lambda x: 10.0**x)
turns = st.floats(-np.pi, np.pi)
rates = st.floats(-1e5, 1e5)


def rotation_z(angle: float) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return np.array(((c, -s, 0.0), (s, c, 0.0), (0.0, 0.0, 1.0)))


def rotation_y(angle: float) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return np.array(((c, 0.0, s), (0.0, 1.0, 0.0), (-s, 0.0, c)))


def matrix(q: np.ndarray) -> np.ndarray:
    """Return the matrix of a unit quaternion, body to world."""
    w, x, y, z = q
    return np.array(
        (
            (1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
            (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
            (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
        )
    )


def same_angle(left: np.ndarray | float, right: float, tolerance: float) -> bool:
    return bool(abs(principal(left - right)) <= tolerance)


@given(phi=tilts, psi=turns, theta=turns)
def test_the_quaternion_is_the_papers_rotation(phi: float, psi: float, theta: float) -> None:
    expected = rotation_z(psi) @ rotation_y(-phi) @ rotation_z(theta)
    # Products of three rotations and of quaternion elements: a few roundings each of size eps.
    np.testing.assert_allclose(matrix(quaternion(phi, psi, theta)), expected, atol=8 * EPS, rtol=0)


@given(phi=tilts, psi=turns, theta=turns)
def test_the_symmetry_axis_leans_away_from_the_contact(
    phi: float, psi: float, theta: float
) -> None:
    axis = matrix(quaternion(phi, psi, theta)) @ (0.0, 0.0, 1.0)
    expected = (-np.sin(phi) * np.cos(psi), -np.sin(phi) * np.sin(psi), np.cos(phi))
    np.testing.assert_allclose(axis, expected, atol=8 * EPS, rtol=0)  # as above


@given(phi=tilts, psi=turns, theta=turns, sign=st.sampled_from((-1.0, 1.0)))
def test_angles_survive_the_round_trip_at_any_tilt(
    phi: float, psi: float, theta: float, sign: float
) -> None:
    back = angles(sign * quaternion(phi, psi, theta))
    # phi keeps its relative precision however small it is: two roundings in, three out. Near pi
    # it is w and z that are small, so the precision is that of pi - phi and sigma is the one kept.
    assert abs(back[0] - phi) <= 8 * EPS * phi
    # psi and theta come from half sums, each up to 2 pi: a handful of ulps of 2 pi.
    assert same_angle(back[1], psi, 16 * EPS * np.pi)
    assert same_angle(back[2], theta, 16 * EPS * np.pi)


@pytest.mark.parametrize("phi", [1e-9, 1e-5, 0.4, np.pi / 2 - 1e-9, np.pi / 2, 3.0])
def test_angles_of_a_rounded_quaternion_match_sixty_digits(phi: float) -> None:
    q = quaternion(phi, 2.5, -1.5)
    with mpmath.workdps(60):
        w, x, y, z = (mpmath.mpf(float(component)) for component in q)
        exact_phi = 2 * mpmath.atan2(mpmath.hypot(x, y), mpmath.hypot(w, z))
        sigma, delta = 2 * mpmath.atan2(z, w), 2 * mpmath.atan2(x, -y)
        exact_psi, exact_theta = float((sigma + delta) / 2), float((sigma - delta) / 2)
    found = angles(q)
    assert abs(found[0] - float(exact_phi)) <= 4 * EPS * phi  # hypot twice, arctan2 once
    assert same_angle(found[1], exact_psi, 4 * EPS * np.pi)
    assert same_angle(found[2], exact_theta, 4 * EPS * np.pi)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_flat_can_has_its_sum_and_a_difference_of_zero(sign: float) -> None:
    phi, sigma, delta = half_angles(sign * quaternion(0.0, 0.3, 0.4))
    assert phi == 0.0
    assert delta == 0.0
    assert same_angle(sigma / 2.0, 0.35, 4 * EPS) or same_angle(sigma / 2.0, 0.35 + np.pi, 4 * EPS)


@given(phi=tilts, psi=turns, phi_dot=rates, psi_dot=rates, theta_dot=rates)
def test_angular_velocity_is_the_papers_in_its_own_frame(
    phi: float, psi: float, phi_dot: float, psi_dot: float, theta_dot: float
) -> None:
    in_b = (psi_dot * np.sin(phi), -phi_dot, psi_dot * np.cos(phi) + theta_dot)
    expected = rotation_z(psi) @ rotation_y(-phi) @ in_b
    found = angular_velocity(phi, psi, phi_dot, psi_dot, theta_dot)
    scale = abs(phi_dot) + abs(psi_dot) + abs(theta_dot)
    atol = 8 * EPS * scale + np.finfo(np.float64).tiny  # sums of products, or below all digits
    np.testing.assert_allclose(found, expected, atol=atol, rtol=0)


@given(
    phi=st.floats(1e-9, np.pi - 1e-3),
    psi=turns,
    phi_dot=rates,
    psi_dot=rates,
    theta_dot=rates,
)
def test_rates_survive_the_round_trip(
    phi: float, psi: float, phi_dot: float, psi_dot: float, theta_dot: float
) -> None:
    omega = angular_velocity(phi, psi, phi_dot, psi_dot, theta_dot)
    back = angle_rates(phi, psi, omega)
    size = np.abs(omega).max() + abs(theta_dot * np.sin(phi)) + abs(phi_dot)
    # phi' and the sum lose an ulp of omega; psi' and theta' divide that by sin phi: the price of
    # angles that are singular at flat, and no more than it.
    assert abs(back[0] - phi_dot) <= 8 * EPS * size
    assert abs(back[1] - psi_dot) <= 8 * EPS * (size + abs(theta_dot)) / np.sin(phi)
    assert abs(back[2] - theta_dot) <= 8 * EPS * size / np.sin(phi)


def test_rates_of_a_flat_can_give_all_spin_to_theta() -> None:
    phi_dot, psi_dot, theta_dot = angle_rates(0.0, 0.0, (0.5, -0.25, 3.0))
    assert [float(rate) for rate in (phi_dot, psi_dot, theta_dot)] == [0.25, 0.0, 3.0]


def test_the_sum_of_the_rates_is_smooth_where_each_runs_away() -> None:
    # 5.6e4 rad/s at phi = 4.2e-5 is the paper's bounce; the sum must not inherit that size.
    _, psi_dot, theta_dot = angle_rates(
        4.2e-5, 1.0, angular_velocity(4.2e-5, 1.0, 0.0, 5.6e4, -5.6e4 + 0.01)
    )
    # The round-off of omega (2.4 rad/s, in the plane) divided by phi, and cancelled in the sum to
    # the ulp of the two large terms.
    assert abs(psi_dot + theta_dot - 0.01) <= 4 * EPS * 5.6e4


def test_arrays_broadcast() -> None:
    q = quaternion(np.full((4, 1), 0.2), np.linspace(0, 1, 3), 0.5)
    assert q.shape == (4, 3, 4)
    assert angles(q)[1].shape == (4, 3)
    omega = angular_velocity(0.2, np.linspace(0, 1, 3), 1.0, 2.0, np.ones((4, 1)))
    assert omega.shape == (4, 3, 3)
    assert angle_rates(0.2, np.linspace(0, 1, 3), omega)[2].shape == (4, 3)


@given(angle=st.floats(-1e6, 1e6))
def test_principal_is_the_same_angle_in_half_open_range(angle: float) -> None:
    inside = float(principal(angle))
    ulp = np.spacing(max(abs(angle), np.pi))  # one rounding of a product, one of a difference
    assert -np.pi - 2 * ulp < inside <= np.pi + 2 * ulp
    assert abs(np.exp(1j * inside) - np.exp(1j * angle)) <= 4 * ulp


@pytest.mark.parametrize("angle", [0.0, 1.0, -3.14159, np.pi])
def test_principal_leaves_an_angle_in_range_untouched(angle: float) -> None:
    assert principal(angle) == angle


@given(phi=tilts, psi=turns, theta=turns)
def test_to_body_undoes_the_rotation(phi: float, psi: float, theta: float) -> None:
    q = quaternion(phi, psi, theta)
    vector = np.array((1.0, -2.0, 0.5))
    expected = matrix(q).T @ vector
    np.testing.assert_allclose(to_body(q, vector), expected, atol=16 * EPS * 2.3, rtol=0)


@pytest.mark.parametrize("passes", [1, 2, 3])
@pytest.mark.parametrize("noise", [0.0, 1e-11, -1e-11])
def test_a_half_turn_through_the_flat_state_grows(passes: int, noise: float) -> None:
    # rocks in a plane from one side of its face to the other, 40 samples a side
    time = np.linspace(0.0, passes + 1.0, 40 * (passes + 1))
    side = np.floor(time)
    phi = 0.2 * np.sin(np.pi * (time - side)) + 1e-12
    phi_dot = 0.2 * np.pi * np.cos(np.pi * (time - side))
    psi = 0.3 + np.pi * side
    spin = angular_velocity(phi, psi, phi_dot, np.full_like(phi, noise), np.full_like(phi, -noise))
    found = angles_of_record(
        load("falls-flat").can, time, quaternion(phi, psi, -psi), spin, start=(0.3, -0.3)
    )
    np.testing.assert_allclose(found.psi, psi, atol=1e-9)
    assert not found.unresolved.any()
