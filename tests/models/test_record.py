"""Unwrapping psi and theta, on bounces whose exact motion is a straight line."""

import pickle

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from models import (
    RESOLVED_STEP,
    Angles,
    Can,
    RecordShapeError,
    angles_of_record,
    angular_velocity,
    quaternion,
)

EPS = np.finfo(np.float64).eps
CAN = Can.from_groups(mass=0.043, radius=0.037, a=0.727, c=0.615, h=1.473)
A_P = CAN.a + CAN.h**2
SLOWNESS = np.sqrt(A_P / (A_P + 1.0))
NEAREST, SPEED = 4.2e-5, 4.0  # rad, rad/s: the paper's bounce


def bounce(time: np.ndarray) -> Angles:
    """Return a bounce at time 0: phi exp(i chi) on a straight line at constant speed."""
    line = NEAREST + 1j * SPEED * time
    phi, chi = np.abs(line), np.angle(line)
    psi, psi_dot = chi / SLOWNESS, NEAREST * SPEED / phi**2 / SLOWNESS
    return Angles(
        phi=phi,
        psi=psi,
        theta=0.3 * time - psi,
        phi_dot=SPEED**2 * time / phi,
        psi_dot=psi_dot,
        theta_dot=0.3 - psi_dot,
        unresolved=np.zeros(time.shape, dtype=bool),
    )


def record(motion: Angles) -> tuple[np.ndarray, np.ndarray]:
    """Return the quaternions and angular velocities of a motion."""
    m = motion
    return (
        quaternion(m.phi, m.psi, m.theta),
        angular_velocity(m.phi, m.psi, m.phi_dot, m.psi_dot, m.theta_dot),
    )


def unwrapped(time: np.ndarray, motion: Angles) -> Angles:
    q, omega = record(motion)
    return angles_of_record(CAN, time, q, omega, start=(motion.psi[0], motion.theta[0]))


def test_a_resolved_bounce_comes_back_as_it_was() -> None:
    time = NEAREST / SPEED * np.tan(np.linspace(-1.57, 1.57, 41))
    motion = bounce(time)
    found = unwrapped(time, motion)
    assert not found.unresolved.any()
    for key in ("psi", "theta"):
        # half sums of angles up to 2 pi, a few ulps each
        np.testing.assert_allclose(
            getattr(found, key), getattr(motion, key), atol=32 * EPS * np.pi, rtol=0
        )
    turn = found.psi[-1] - found.psi[0]
    assert turn > np.pi  # more than the half turn at which nearest branches give up
    np.testing.assert_allclose(found.phi, motion.phi, rtol=8 * EPS)
    # psi' carries the round-off of omega, divided by phi
    omega = np.linalg.norm(record(motion)[1], axis=-1)
    assert (np.abs(found.psi_dot - motion.psi_dot) <= 8 * EPS * omega / motion.phi).all()
    np.testing.assert_allclose(found.phi_dot, motion.phi_dot, atol=16 * EPS * SPEED, rtol=0)


@pytest.mark.parametrize("mirror", [1.0, -1.0])
def test_a_bounce_between_two_samples_is_guessed_by_the_rates_and_owned_up_to(
    mirror: float,
) -> None:
    time = np.array((-3e-4, -2e-4, -1e-4, 1e-4, 2e-4, 3e-4))
    m = bounce(time)
    m = Angles(
        phi=m.phi,
        psi=mirror * m.psi,
        theta=mirror * m.theta,
        phi_dot=m.phi_dot,
        psi_dot=mirror * m.psi_dot,
        theta_dot=mirror * m.theta_dot,
        unresolved=m.unresolved,
    )
    found = unwrapped(time, m)
    assert found.unresolved.tolist() == [False, False, False, True, False, False]
    np.testing.assert_allclose(found.psi, m.psi, atol=32 * EPS * np.pi, rtol=0)  # 186 degrees


def test_a_record_is_unresolved_from_a_right_angle_on() -> None:
    time = np.linspace(0.0, 1.0, 11)
    for step, unresolved in ((RESOLVED_STEP * 0.999, False), (RESOLVED_STEP * 1.001, True)):
        psi = step * np.arange(11.0)
        motion = Angles(
            phi=np.full(11, 0.3),
            psi=psi,
            theta=np.zeros(11),
            phi_dot=np.zeros(11),
            psi_dot=np.full(11, step / 0.1),
            theta_dot=np.zeros(11),
            unresolved=np.zeros(11, dtype=bool),
        )
        # Where psi alone turns steadily the straight line is only the start of a circle, so the
        # rates' prediction is less than the step: the branch chosen decides.
        assert unwrapped(time, motion).unresolved[1:].all() == unresolved


def test_rates_that_contradict_the_angles_leave_the_record_unresolved() -> None:
    # psi is the same at both ends, but at 2.5 rad/s it moved by more than a right angle between
    q = quaternion((0.3, 0.3), 0.0, 0.0)
    omega = angular_velocity(0.3, 0.0, 0.0, (2.5, 2.5), -2.5)
    found = angles_of_record(CAN, [0.0, 1.0], q, omega)
    assert found.psi[1] == found.psi[0]
    assert found.unresolved.tolist() == [False, True]


def test_the_sum_is_followed_even_through_many_turns_a_sample() -> None:
    time = np.linspace(0.0, 1.0, 101)
    zero = np.zeros(101)
    motion = Angles(
        phi=np.full(101, 0.2),
        psi=2.0 * time,
        theta=1e4 * time,  # 16 turns a sample
        phi_dot=zero,
        psi_dot=zero + 2.0,
        theta_dot=zero + 1e4,
        unresolved=np.zeros(101, dtype=bool),
    )
    found = unwrapped(time, motion)
    assert not found.unresolved.any()
    # angles of size 1e4, the rates' round-off included
    np.testing.assert_allclose(found.theta, motion.theta, atol=8 * np.spacing(1e4), rtol=0)
    np.testing.assert_allclose(found.psi, motion.psi, atol=8 * np.spacing(1e4), rtol=0)


@given(
    steps=st.lists(
        st.tuples(st.floats(-1.4, 1.4), st.floats(-1.4, 1.4), st.floats(0.05, 3.0)),
        min_size=1,
        max_size=30,
    ),
    flips=st.lists(st.booleans(), min_size=31, max_size=31),
)
def test_slow_records_come_back_whatever_the_sign_of_their_quaternions(
    steps: list[tuple[float, float, float]], flips: list[bool]
) -> None:
    n = len(steps) + 1
    psi = np.concatenate(([0.0], np.cumsum([step[0] for step in steps])))
    theta = np.concatenate(([0.0], np.cumsum([step[1] for step in steps])))
    phi = np.array([0.7] + [step[2] for step in steps])
    sign = np.where(flips[:n], -1.0, 1.0)[:, None]
    # Rates of zero predict no change, so the nearest branch is taken: right up to half a turn.
    found = angles_of_record(
        CAN, np.arange(n) * 1.0, sign * quaternion(phi, psi, theta), np.zeros((n, 3))
    )
    tolerance = 64 * EPS * (1.0 + 1.4 * n)  # ulps of the largest angle
    np.testing.assert_allclose(found.psi, psi, atol=tolerance, rtol=0)
    np.testing.assert_allclose(found.theta, theta, atol=tolerance, rtol=0)
    assert not found.unresolved.any()


def test_the_record_starts_on_the_branch_asked_for() -> None:
    q = quaternion(0.4, 1.0, 2.0)[None]
    omega = np.zeros((1, 3))
    found = angles_of_record(CAN, [0.0], q, omega, start=(1.0 + 4 * np.pi, 2.0 - 6 * np.pi))
    assert found.psi[0] == pytest.approx(1.0 + 4 * np.pi, abs=8 * np.spacing(13.0))
    assert found.theta[0] == pytest.approx(2.0 - 6 * np.pi, abs=8 * np.spacing(17.0))
    assert found.unresolved.tolist() == [False]


def test_a_flat_can_is_no_error() -> None:
    time = np.array((0.0, 0.1, 0.2))
    found = angles_of_record(CAN, time, quaternion(0.0, 0.0, 3.0 * time), [[0.0, 0.0, 3.0]] * 3)
    np.testing.assert_allclose(found.psi + found.theta, 3.0 * time, atol=8 * EPS, rtol=0)
    assert np.isfinite(found.psi_dot).all()


@pytest.mark.parametrize(
    ("time", "q", "omega"),
    [
        ([], np.zeros((0, 4)), np.zeros((0, 3))),
        ([0.0, 1.0], np.ones((1, 4)), np.zeros((2, 3))),
        ([0.0, 1.0], np.ones((2, 4)), np.zeros((2, 4))),
        ([[0.0, 1.0]], np.ones((2, 4)), np.zeros((2, 3))),
    ],
)
def test_shapes_that_disagree_are_refused(
    time: list[float], q: np.ndarray, omega: np.ndarray
) -> None:
    with pytest.raises(RecordShapeError) as refused:
        angles_of_record(CAN, time, q, omega)
    error = refused.value
    assert error.time == np.shape(time)
    assert (error.quaternion, error.angular_velocity) == (q.shape, omega.shape)
    assert str(pickle.loads(pickle.dumps(error))) == str(error)  # noqa: S301 - our own bytes
    assert str(error).endswith(f"; found {error.time}, {q.shape} and {omega.shape}")
