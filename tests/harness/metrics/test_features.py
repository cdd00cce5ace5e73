"""Bounces read off motions whose bounces are known: phi exp(i chi) on a straight line."""

from dataclasses import replace

import numpy as np
import pytest

from harness.metrics.bounces import bounces
from harness.metrics.motion import Motion, motion
from models import Can, Scene, angular_velocity, load, quaternion
from tests.support.trajectories import make_trajectory

SCENE = load("paper-release")
CAN: Can = SCENE.can
A_P = CAN.a + CAN.h**2
SLOWNESS = np.sqrt(A_P / (A_P + 1.0))
EPS = np.finfo(np.float64).eps
AMPLITUDE, RATE = 0.03, 40.0  # rad, rad/s: phi rises to the amplitude and back in pi/RATE


def rocking(time: np.ndarray, nearest: float, sign: float = 1.0, ratio: float = 0.3) -> Motion:
    """Return a motion whose maxima lie at RATE t = pi/2 + n pi, and whose minima half way between.

    phi exp(i chi) is AMPLITUDE sin(RATE t) + i nearest cos(RATE t), an ellipse. It is traversed
    like a straight line near its short ends; psi grows by pi/SLOWNESS from maximum to maximum.
    """
    s, c = np.sin(RATE * time), np.cos(RATE * time)
    x, y = AMPLITUDE * s, -nearest * c
    vx, vy = AMPLITUDE * RATE * c, nearest * RATE * s
    phi = np.hypot(x, y)
    chi = np.unwrap(np.arctan2(y, x))
    psi = sign * chi / SLOWNESS
    phi_dot = (x * vx + y * vy) / phi
    psi_dot = sign * (x * vy - y * vx) / phi**2 / SLOWNESS
    theta, theta_dot = 0.5 * time - psi, 0.5 - psi_dot
    n = len(time)
    force = np.column_stack((np.full(n, ratio), np.zeros(n), np.ones(n)))
    release = replace(SCENE.release, psi=float(psi[0]), theta=float(theta[0]))
    return motion(
        make_trajectory(
            n,
            time=time,
            quaternion=quaternion(phi, psi, theta),
            angular_velocity=angular_velocity(phi, psi, phi_dot, psi_dot, theta_dot),
            contact_force=force,
        ),
        replace(SCENE, release=release),
    )


def dense(nearest: float, start: float, end: float) -> np.ndarray:
    """Return times between two phases RATE t that are dense by angle round every minimum."""
    times = [np.linspace(start, end, 2001)]
    for n in range(int(start / np.pi), int(end / np.pi) + 1):
        chi = np.linspace(-1.5, 1.5, 301)
        near = n * np.pi + np.arctan(np.tan(chi) * nearest / AMPLITUDE)
        times.append(near[(near > start) & (near < end)])
    return np.unique(np.concatenate(times)) / RATE


@pytest.mark.parametrize("nearest", [5e-3, 1e-4, 4.2e-5])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_bounce_is_read_off_from_maximum_to_maximum(nearest: float, sign: float) -> None:
    time = dense(nearest, 0.3 * np.pi, 2.7 * np.pi)
    (first, second) = bounces(rocking(time, nearest, sign), CAN)
    for number, found in enumerate((first, second)):
        assert found.resolved
        # half way between two extrema is where the cubic between two samples is exact to the
        # fourth power of their distance, 4e-3 of a radian of phase
        assert found.time * RATE == pytest.approx((1 + number) * np.pi, abs=1e-9)
        assert found.start * RATE == pytest.approx((0.5 + number) * np.pi, abs=1e-6)
        assert found.end * RATE == pytest.approx((1.5 + number) * np.pi, abs=1e-6)
        assert found.phi_min == pytest.approx(nearest, rel=1e-6)
        # psi is still at a maximum: an error of 1e-6 in its phase moves it by next to nothing
        turn = sign * np.pi / SLOWNESS
        assert found.angle_of_turn == pytest.approx(turn, abs=1e-6)
        assert found.rotation_turn == pytest.approx(0.5 * np.pi / RATE - turn, abs=1e-6)
        peak = sign * AMPLITUDE * RATE / nearest / SLOWNESS
        assert found.peak_psi_dot == pytest.approx(peak, rel=1e-9)  # 1/psi' is a parabola
        assert found.peak_friction_ratio == 0.3 / 1.0


def test_the_error_of_the_turn_falls_at_least_with_the_square_of_the_spacing() -> None:
    nearest = 5e-3
    errors = []
    for n in (101, 201):
        time = np.linspace(0.3 * np.pi, 1.7 * np.pi, n) / RATE
        (found,) = bounces(rocking(time, nearest), CAN)
        errors.append(abs(found.angle_of_turn - np.pi / SLOWNESS))
    # the zero of phi' is found to second order, and psi moves evenly there: at least second order
    assert errors[1] < errors[0] / 3.5


@pytest.mark.parametrize("offset", [0.0, 0.2, 0.5, 0.8])
def test_of_a_bounce_between_two_samples_the_minimum_is_that_of_the_straight_line(
    offset: float,
) -> None:
    nearest = 4.2e-5
    width = nearest / AMPLITUDE / RATE  # in which psi moves by a radian
    step = 1.2 * width
    near = np.pi / RATE + (np.arange(-400, 400) + offset) * step
    far = np.linspace(0.3 * np.pi, 1.7 * np.pi, 2001) / RATE
    time = np.unique(np.concatenate((far[np.abs(far - np.pi / RATE) > 400 * step], near)))
    (found,) = bounces(rocking(time, nearest), CAN)
    assert found.resolved
    # over two samples the ellipse is a straight line to (step RATE)^2, 3e-6
    assert found.phi_min == pytest.approx(nearest, rel=1e-4)
    assert abs(found.time - np.pi / RATE) < 1e-4 * width


@pytest.mark.parametrize("offset", [0.0, 0.2, 0.5, 0.8])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_peaks_are_told_between_samples_as_far_apart_as_they_are_wide(
    offset: float, sign: float
) -> None:
    nearest = 4.2e-5
    width = nearest / AMPLITUDE / RATE  # in which psi' falls to the half
    near = np.pi / RATE + (np.arange(-400, 400) + offset) * width
    far = np.linspace(0.3 * np.pi, 1.7 * np.pi, 2001) / RATE
    time = np.unique(np.concatenate((far[np.abs(far - np.pi / RATE) > 400 * width], near)))
    rocked = rocking(time, nearest, sign)
    hump = 0.3 - ((time - np.pi / RATE) / width) ** 2
    (found,) = bounces(replace(rocked, friction_ratio=hump), CAN)
    peak = sign * AMPLITUDE * RATE / nearest / SLOWNESS
    # over two samples the ellipse is a straight line to (width RATE)^2, 2e-6
    assert found.peak_psi_dot == pytest.approx(peak, rel=1e-5)
    assert found.peak_friction_ratio == pytest.approx(0.3, rel=1e-9)


def test_a_kink_is_as_high_as_its_samples() -> None:
    time = dense(5e-3, 0.3 * np.pi, 1.7 * np.pi)
    slipping = np.minimum(0.3, 0.31 - np.abs(time - np.pi / RATE))
    (found,) = bounces(replace(rocking(time, 5e-3), friction_ratio=slipping), CAN)
    assert found.peak_friction_ratio == 0.3


def test_a_peak_far_above_every_sample_is_not_made_up() -> None:
    time = dense(5e-3, 0.3 * np.pi, 1.7 * np.pi)
    rocked = rocking(time, 5e-3)
    rate = np.ones_like(time)
    middle = len(time) // 2
    rate[middle - 1 : middle + 2] = (1.0, 50.0, 20.0)  # a parabola of 1/rate goes below zero
    (found,) = bounces(replace(rocked, angles=replace(rocked.angles, psi_dot=rate)), CAN)
    assert found.peak_psi_dot == 50.0


@pytest.mark.parametrize("shift", [-1, 1])
def test_rates_that_lag_behind_the_angles_by_a_step_still_tell_the_extrema(shift: int) -> None:
    step = 5e-3 / RATE
    time = np.arange(0.3 * np.pi / RATE, 1.7 * np.pi / RATE, step)
    rocked = rocking(time, 5e-3)
    late = np.roll(rocked.angles.phi_dot, shift)
    shifted = replace(rocked, angles=replace(rocked.angles, phi_dot=late))
    (found,) = bounces(shifted, CAN)
    for told, phase in ((found.start, 0.5), (found.time, 1.0), (found.end, 1.5)):
        assert told == pytest.approx(phase * np.pi / RATE + shift * step, abs=1e-3 * step)


def test_a_record_too_coarse_to_count_turns_says_so() -> None:
    time = np.linspace(0.3 * np.pi, 1.7 * np.pi, 400) / RATE
    (found,) = bounces(rocking(time, 4.2e-5), CAN)
    assert not found.resolved


@pytest.mark.parametrize(
    ("start", "end", "complete"),
    [
        (0.3, 1.7, 1),
        (0.6, 1.7, 1),  # a release that falls is a maximum, to the reference too
        (0.3, 1.4, 0),  # ends before it
        (0.5, 1.7, 1),  # released at rest is released at a maximum
        (0.3, 2.4, 1),
        (1.2, 1.7, 0),  # begins on the rise
        (0.6, 3.7, 3),
        (0.3, 0.9, 0),
    ],
)
def test_only_complete_bounces_count(start: float, end: float, complete: int) -> None:
    time = dense(5e-3, start * np.pi, end * np.pi)
    assert len(bounces(rocking(time, 5e-3), CAN)) == complete


def test_a_ripple_is_no_bounce() -> None:
    time = np.linspace(0.0, 1.0, 2001)
    phi = 0.4 - 0.1 * time + 0.0015 * np.sin(60.0 * time)
    zero = np.zeros_like(time)
    record = motion(
        make_trajectory(len(time), time=time, quaternion=quaternion(phi, zero, zero)), SCENE
    )
    assert bounces(record, CAN) == ()


def test_a_bounce_without_contact_has_no_friction_ratio() -> None:
    time = dense(5e-3, 0.3 * np.pi, 1.7 * np.pi)
    rocked = rocking(time, 5e-3)
    (found,) = bounces(replace(rocked, friction_ratio=np.full(len(time), np.nan)), CAN)
    assert np.isnan(found.peak_friction_ratio)


def test_a_single_sample_has_no_bounce(gentle: Scene) -> None:
    one = motion(make_trajectory(1, quaternion=quaternion(0.3, 0.0, 0.0)[None]), gentle)
    assert bounces(one, CAN) == ()
