"""Energy and the quality of contact, on motions where both are known."""

from dataclasses import replace

import numpy as np
import pytest

from harness.metrics.energy import energy, energy_drift
from harness.metrics.motion import contact_quality, motion, motion_frame
from models import Scene, quaternion
from tests.support.trajectories import make_trajectory

EPS = np.finfo(np.float64).eps


def test_energy_is_the_sum_of_its_parts(gentle: Scene) -> None:
    can, g = gentle.can, gentle.gravity
    lying = quaternion(np.pi / 2.0, 0.7, 0.2)[None]  # the axis points to (-cos psi, -sin psi, 0)
    axis = -np.array((np.cos(0.7), np.sin(0.7), 0.0))
    across = np.array((0.0, 0.0, 1.0))
    one = make_trajectory(
        1,
        quaternion=lying,
        position=np.array(((0.0, 0.0, 2.0),)),
        velocity=np.array(((3.0, 0.0, 4.0),)),
        angular_velocity=(5.0 * axis + 7.0 * across)[None],
    )
    expected = (
        can.mass * g * 2.0
        + can.mass * 25.0 / 2.0
        + can.axial_inertia * 25.0 / 2.0
        + can.transverse_inertia * 49.0 / 2.0
    )
    assert energy(one, gentle)[0] == pytest.approx(expected, rel=8 * EPS, abs=0)


def test_drift_is_the_largest_departure_with_its_sign(gentle: Scene) -> None:
    heights = np.array((1.0, 1.2, 0.5, 0.9))
    rising = make_trajectory(4, position=np.column_stack((np.zeros((4, 2)), heights)))
    assert energy_drift(rising, gentle) == pytest.approx(
        -0.5 / gentle.can.radius, rel=8 * EPS, abs=0
    )


def test_quality_counts_time_and_not_samples(gentle: Scene) -> None:
    time = np.array((0.0, 1.0, 2.0, 2.1, 2.2, 10.0))
    force = np.outer(np.array((1.0, 1.0, 0.0, 0.0, 1.0, 1.0)), (0.0, 0.0, 1.0))
    point = np.zeros((6, 3))
    point[2:4] = np.nan
    velocity = np.outer(np.array((0.1, 0.2, 9.0, 9.0, 0.3, 0.0)), (0.6, 0.8, 5.0))
    found = contact_quality(
        motion(
            make_trajectory(
                6,
                time=time,
                contact_force=force,
                contact_point=point,
                velocity=velocity,
                penetration=np.array((1e-6, 3e-6, -1e-3, np.nan, 0.0, 0.0)),
                contact_count=np.array((1, 2, 0, 0, 1, 1)),
            ),
            gentle,
        )
    )
    assert found.max_penetration == 3e-6
    assert found.max_slip == pytest.approx(0.3, rel=4 * EPS, abs=0)  # in flight nothing slips
    # trapezia: half of each neighbouring gap
    assert found.lift_off_fraction == pytest.approx((0.55 + 0.1) / 10.0, rel=64 * EPS, abs=0)
    assert found.multi_contact_fraction == pytest.approx(1.0 / 10.0, rel=64 * EPS, abs=0)


def test_a_can_that_never_touches_has_neither_depth_nor_slip(gentle: Scene) -> None:
    aloft = make_trajectory(
        3,
        contact_force=np.zeros((3, 3)),
        contact_point=np.full((3, 3), np.nan),
        penetration=np.full(3, np.nan),
        contact_count=np.zeros(3, dtype=np.int64),
    )
    found = contact_quality(motion(aloft, gentle))
    assert (found.max_penetration, found.max_slip) == (0.0, 0.0)
    assert found.lift_off_fraction == pytest.approx(1.0, abs=4 * EPS)


def test_slip_is_that_of_the_material_at_the_contact(gentle: Scene) -> None:
    # a wheel of radius 2 that rolls to +x at 6 m/s turns at 3 rad/s about +y
    n = 3
    rolling = make_trajectory(
        n,
        position=np.tile((0.0, 0.0, 2.0), (n, 1)),
        velocity=np.tile((6.0, 0.0, 0.0), (n, 1)),
        angular_velocity=np.tile((0.0, 3.0, 0.0), (n, 1)),
    )
    np.testing.assert_array_equal(motion(rolling, gentle).slip, 0.0)
    sliding = replace(rolling, velocity=np.tile((6.0, 1.5, 0.0), (n, 1)))
    np.testing.assert_array_equal(motion(sliding, gentle).slip, 1.5)


def test_the_friction_ratio_is_that_of_the_forces(gentle: Scene) -> None:
    force = np.array(((3.0, 4.0, 10.0), (0.0, 0.0, 0.0), (1.0, 0.0, -2.0)))
    found = motion(make_trajectory(3, contact_force=force), gentle)
    assert found.friction_ratio[0] == 0.5
    assert np.isnan(found.friction_ratio[1:]).all()  # no contact, and a plane that pulls
    np.testing.assert_array_equal(found.touching, (True, False, False))


def test_a_can_about_to_lift_off_has_no_friction_ratio(gentle: Scene) -> None:
    """Of a normal force that is round-off it would be 1e15."""
    weight = gentle.can.mass * gentle.gravity
    force = weight * np.array(
        ((0.2, 0.0, 1.0), (0.2, 0.0, 1.01e-3), (0.2, 0.0, 0.99e-3), (0.2, 0.0, 1e-16))
    )
    found = motion(make_trajectory(4, contact_force=force, contact_point=np.zeros((4, 3))), gentle)
    assert found.friction_ratio[:2] == pytest.approx([0.2, 0.2 / 1.01e-3])
    assert np.isnan(found.friction_ratio[2:]).all()
    assert found.touching.all()


def test_a_table_of_a_motion_has_a_column_for_each_component(gentle: Scene) -> None:
    turned = np.array((0.5, -0.1, 0.7, 0.5))
    one = make_trajectory(
        1,
        quaternion=turned[None],
        position=np.array(((1.0, 2.0, 3.0),)),
        contact_point=np.array(((4.0, 5.0, 0.0),)),
        contact_force=np.array(((6.0, 7.0, 8.0),)),
    )
    seen = motion(one, gentle)
    row = motion_frame(seen).iloc[0]
    assert [row[f"quaternion_{letter}"] for letter in "wxyz"] == turned.tolist()
    assert [row[f"{letter}_m"] for letter in "xyz"] == [1.0, 2.0, 3.0]
    assert [row[f"contact_{letter}_m"] for letter in "xy"] == [4.0, 5.0]
    assert [row[f"force_{letter}_N"] for letter in "xyz"] == [6.0, 7.0, 8.0]
    for name in ("phi", "psi", "theta"):
        assert row[f"{name}_rad"] == getattr(seen.angles, name)[0]
        assert row[f"{name}_dot_rad_s"] == getattr(seen.angles, f"{name}_dot")[0]
