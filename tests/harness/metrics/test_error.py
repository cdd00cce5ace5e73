"""Errors on motions whose differences are known."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from harness.core.bounce import Bounce
from harness.metrics.error import Errors, errors, hausdorff
from harness.metrics.motion import Motion, motion, shares
from models import Scene, load, quaternion
from tests.support.trajectories import make_trajectory

EPS = np.finfo(np.float64).eps
SCENE = load("gentle-rock")


def ring(radius: float, n: int, start: float = 0.0) -> np.ndarray:
    """Return n points of a circle, the first once more at the end, shape (n + 1, 2)."""
    angle = start + np.linspace(0.0, 2.0 * np.pi, n + 1)
    return radius * np.stack((np.cos(angle), np.sin(angle)), axis=-1)


def told(
    time: np.ndarray,
    phi: np.ndarray,
    psi: np.ndarray,
    points: np.ndarray,
    **more: object,
) -> Motion:
    """Return a motion with these angles and this locus; theta is -psi."""
    n = len(time)
    locus = np.column_stack((points, np.zeros(n)))
    trajectory = make_trajectory(
        n, time=time, quaternion=quaternion(phi, psi, -psi), contact_point=locus, **more
    )
    return motion(trajectory, SCENE)


def compared(found: Motion, true: Motion, split: float | None = None) -> Errors:
    """Return the errors, with a true bounce at `split`, if any."""
    bounces = () if split is None else (bounce(split),)
    return errors(found, true, bounces, bounces, true.locus)


def bounce(time: float, **more: Any) -> Bounce:
    """Return a bounce at a time."""
    plain: dict[str, Any] = {
        "phi_min": 0.1,
        "angle_of_turn": 3.0,
        "rotation_turn": -3.0,
        "peak_psi_dot": 50.0,
    }
    return Bounce(start=0.0, time=time, end=1.0, peak_friction_ratio=0.5, **(plain | more))


@pytest.fixture
def time() -> np.ndarray:
    """Return instants that crowd at the end, like those of a bounce."""
    return 1.0 - np.geomspace(1.0, 1e-6, 400)


@pytest.fixture
def true(time: np.ndarray) -> Motion:
    """Return a motion on a circle of 1 m."""
    n = len(time)
    return told(time, np.full(n, 0.3), 6.0 * time, ring(1.0, n - 1))


def test_a_motion_has_no_error_against_itself(true: Motion) -> None:
    found = compared(true, true, 0.5)
    for name in ("phi_rms", "phi_max", "psi_rms", "theta_rms", "contact_locus_max"):
        assert getattr(found, name) == 0.0
    assert found.contact_locus_hausdorff == 0.0
    # the angle of q^-1 q is round-off of products of numbers up to 1
    assert found.rotation_rms <= 8 * EPS
    assert found.angle_of_turn == (0.0,)


def test_a_constant_offset_is_its_own_rms(time: np.ndarray, true: Motion) -> None:
    n = len(time)
    found = told(time, np.full(n, 0.3 + 1e-3), 6.0 * time + 2e-3, ring(1.01, n - 1))
    e = compared(found, true, 0.5)
    # differences of angles up to 6 rad
    assert e.phi_rms == pytest.approx(1e-3, rel=1e-9)
    assert e.phi_rms_before == pytest.approx(1e-3, rel=1e-9)
    assert e.phi_rms_after == pytest.approx(1e-3, rel=1e-9)
    assert e.phi_max == pytest.approx(1e-3, rel=1e-9)
    # psi and theta start on the branch nearest to the release, offset and all
    assert e.psi_rms == pytest.approx(2e-3, rel=1e-9)
    assert e.theta_rms == pytest.approx(2e-3, rel=1e-9)
    assert e.contact_locus_rms == pytest.approx(0.01, rel=1e-9)
    assert e.contact_locus_max == pytest.approx(0.01, rel=1e-9)


def test_a_mean_is_one_over_time_and_not_over_samples(time: np.ndarray) -> None:
    # an error during the last thousandth of the time, where half of the samples crowd
    n = len(time)
    late = np.where(time > 0.999, 1e-2, 0.0)
    assert np.mean(late > 0.0) > 0.4
    phi = np.full(n, 0.3)
    true = told(time, phi, 0.0 * time, ring(1.0, n - 1))
    found = told(time, phi + late, 0.0 * time, ring(1.0, n - 1))
    e = compared(found, true)
    # sqrt(1/1000), to the width of one sample beside it
    assert e.phi_rms == pytest.approx(1e-2 * math.sqrt(1e-3), rel=0.05)


def test_before_and_after_the_bounce_are_told_apart(time: np.ndarray) -> None:
    n = len(time)
    phi = np.full(n, 0.3)
    true = told(time, phi, 0.0 * time, ring(1.0, n - 1))
    found = told(time, phi + np.where(time <= 0.5, 1e-3, 4e-3), 0.0 * time, ring(1.0, n - 1))
    e = compared(found, true, 0.5)
    assert e.phi_rms_before == pytest.approx(1e-3, rel=1e-9)
    assert e.phi_rms_after == pytest.approx(4e-3, rel=1e-9)
    at_the_bounce = phi + np.where(time == time[7], 1e-3, 0.0)
    sample = told(time, at_the_bounce, 0.0 * time, true.locus)
    assert compared(sample, true, float(time[7])).phi_rms_after == 0.0
    two = (bounce(0.5), bounce(0.9))  # the first of them is where before ends
    assert errors(found, true, two, two, true.locus).phi_rms_before == e.phi_rms_before
    without = compared(found, true)
    assert without.phi_rms_before == without.phi_rms
    assert math.isnan(without.phi_rms_after)


@pytest.mark.parametrize("angle", [1e-9, 1e-3, 3.0])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_orientations_are_compared_as_rotations(angle: float, sign: float) -> None:
    n = 5
    time = np.arange(n, dtype=float)
    flat = np.full(n, 0.3)
    true = told(time, flat, 0.1 * time, ring(1.0, n - 1))
    axis = np.array((0.6, 0.0, 0.8))
    w, v = math.cos(angle / 2.0), math.sin(angle / 2.0) * axis
    q = true.trajectory.quaternion
    turned = np.column_stack(
        (
            w * q[:, 0] - q[:, 1:] @ v,
            w * q[:, 1:] + q[:, :1] * v + np.cross(v, q[:, 1:]),
        )
    )
    other = replace(true.trajectory, quaternion=sign * turned)  # q and -q are the same rotation
    found = compared(replace(true, trajectory=other), true)
    assert found.rotation_rms == pytest.approx(angle, abs=8 * EPS)


def test_near_flat_opposite_psi_and_theta_are_hardly_a_rotation() -> None:
    n = 5
    time = np.arange(n, dtype=float)
    nearly_flat = np.full(n, 1e-6)
    true = told(time, nearly_flat, 0.0 * time, ring(1.0, n - 1))
    found = told(time, nearly_flat, 0.0 * time + 2.0, ring(1.0, n - 1))
    e = compared(found, true)
    assert e.psi_rms == pytest.approx(2.0, rel=1e-9)
    assert e.rotation_rms == pytest.approx(2.0 * 1e-6 * math.sin(1.0), rel=1e-6)


def test_bounces_are_compared_in_pairs_and_signed(true: Motion) -> None:
    found = (
        bounce(0.51, phi_min=0.11, angle_of_turn=3.5, rotation_turn=-2.0),
        bounce(0.9, angle_of_turn=-1.0),
    )
    e = errors(true, true, found, (bounce(0.5),), true.locus)
    assert e.angle_of_turn == (0.5,)
    assert e.rotation_turn == (1.0,)
    assert e.time_of_bounce == pytest.approx((0.01,), abs=EPS)
    assert e.phi_min == pytest.approx((0.01,), abs=EPS)
    assert e.peak_friction_ratio == (0.0,)
    assert errors(true, true, (), (bounce(0.5),), true.locus).angle_of_turn == ()


def test_the_largest_errors_are_those_of_a_single_sample() -> None:
    n = 11
    time, flat = np.arange(n, dtype=float), np.full(n, 0.3)
    points = np.column_stack((time, 0.0 * time))
    true = told(time, flat, 0.0 * time, points)
    once = np.where(time == 3.0, 1.0, 0.0)
    found = told(time, flat + 1e-3 * once, 0.0 * time, points + np.outer(once, (0.0, 0.25)))
    e = compared(found, true)
    assert e.phi_max == pytest.approx(1e-3, rel=1e-9)
    assert e.contact_locus_max == 0.25


def test_where_nothing_touches_the_locus_is_left_out() -> None:
    n = 11
    time = np.arange(n, dtype=float)
    points = np.column_stack((time, 0.0 * time))
    true = told(time, np.full(n, 0.3), 0.0 * time, points)
    lifted = points + np.array((0.0, 0.25))
    lifted[4:7] = np.nan
    found = told(time, np.full(n, 0.3), 0.0 * time, lifted)
    e = compared(found, true)
    assert e.contact_locus_rms == pytest.approx(0.25, rel=4 * EPS, abs=0)
    assert e.contact_locus_max == pytest.approx(0.25, rel=4 * EPS, abs=0)
    # the true points in the gap are nearest to the chord across it
    assert e.contact_locus_hausdorff == pytest.approx(0.25, rel=4 * EPS, abs=0)


def test_a_motion_that_never_touches_has_no_locus_error(true: Motion) -> None:
    n = len(true.time)
    aloft = replace(true, locus=np.full((n, 2), np.nan))
    e = compared(aloft, true)
    assert math.isnan(e.contact_locus_rms)
    assert math.isnan(e.contact_locus_max)
    assert math.isnan(e.contact_locus_hausdorff)


def test_the_distance_of_concentric_circles_is_that_of_their_radii() -> None:
    n = 720
    sagitta = 1.0 - math.cos(math.pi / n)  # by which a chord cuts off the circle
    for start in (0.0, 0.3 / n):
        found = hausdorff(ring(1.0, n), ring(1.1, n, start))
        assert found == pytest.approx(0.1, abs=1.1 * sagitta)


def test_the_spacing_of_points_is_no_distance() -> None:
    fine, coarse = np.linspace(0.0, 1.0, 1001), np.array((0.0, 0.3, 1.0))
    first, second = (np.column_stack((x, 2.0 * x)) for x in (fine, coarse))
    # a point of a straight line lies on its chords to the round-off of a foot
    assert hausdorff(first, second) <= 8 * EPS


@given(st.integers(0, 2**32 - 1))
def test_a_distance_of_curves_is_symmetric_and_zero_for_the_same(seed: int) -> None:
    random = np.random.default_rng(seed)
    first, second = (random.normal(size=(n, 2)).cumsum(axis=0) for n in (7, 12))
    assert hausdorff(first, second) == hausdorff(second, first)
    assert hausdorff(first, first) == 0.0
    moved = hausdorff(first, first + np.array((1e-3, 0.0)))
    assert moved <= 1e-3 * (1.0 + 1e-9)  # a shifted curve is nowhere farther than its shift


def test_one_point_is_no_curve() -> None:
    assert math.isnan(hausdorff(np.zeros((1, 2)), np.zeros((5, 2))))


@given(st.lists(st.floats(1e-9, 10.0), min_size=1, max_size=30))
def test_shares_are_those_of_trapezia(gaps: list[float]) -> None:
    time = np.concatenate(([0.0], np.cumsum(gaps)))
    weight = shares(time)
    assert weight.sum() == pytest.approx(1.0, abs=64 * EPS)
    # a trapezium is exact for what is linear in time: its mean is half the end
    assert weight @ time == pytest.approx(time[-1] / 2.0, rel=64 * EPS, abs=0)


def test_one_instant_has_the_whole_share() -> None:
    np.testing.assert_array_equal(shares(np.array((0.3,))), (1.0,))


def test_the_release_decides_the_branch_of_psi_and_theta(gentle: Scene) -> None:
    release = replace(gentle.release, psi=7.0, theta=-9.0)
    n = 4
    psi = 7.0 + 0.1 * np.arange(n)
    q = quaternion(np.full(n, 0.3), psi, np.full(n, -9.0))
    found = motion(make_trajectory(n, quaternion=q), replace(gentle, release=release))
    np.testing.assert_allclose(found.angles.psi, psi, atol=64 * EPS, rtol=0)
    np.testing.assert_allclose(found.angles.theta, -9.0, atol=64 * EPS, rtol=0)


def test_an_infinite_truth_is_nothing_to_compare_with(true: Motion) -> None:
    pulling = replace(bounce(0.5), peak_friction_ratio=math.inf)
    e = errors(true, true, (bounce(0.5),), (pulling,), true.locus)
    assert math.isnan(e.peak_friction_ratio[0])


def test_where_a_curve_crosses_itself_the_spacing_of_its_points_is_still_no_distance() -> None:
    across = np.column_stack((np.arange(-1.0, 1.05, 0.1), np.zeros(21)))
    back = np.array(((1.0, -0.95), (0.0, -0.95)))
    up = np.column_stack((np.zeros(7), np.arange(-0.95, 1.0, 0.3)))
    curve = np.vstack((across, back, up))
    middles = (curve[:-1] + curve[1:]) / 2.0
    finer = np.vstack([np.vstack(pair) for pair in zip(curve[:-1], middles, strict=True)])
    finer = np.vstack((finer, curve[-1:]))
    # the middle of a chord of `up` is nearer to a point of `across` than to the ends of its own
    assert hausdorff(curve, finer) <= 8 * EPS
