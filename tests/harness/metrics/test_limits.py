"""Numbers that docstrings cite of the metrics, just inside and just outside each.

They are written out here as the docstrings have them, and not imported: whoever changes one in the
code is told which sentence no longer holds.
"""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from harness.metrics import convergence
from harness.metrics.bounces import bounces
from harness.metrics.convergence import asymptotic_order, observed_order, pareto_front, plateau
from harness.metrics.error import hausdorff
from harness.metrics.motion import Motion, contact_quality, motion
from models import Scene, angular_velocity, quaternion
from tests.support.trajectories import make_trajectory

HALVES = (1.0, 0.5, 0.25)


def ladder(*slopes: float) -> list[float]:
    """Return errors at timesteps that halve, with these slopes from the coarsest on."""
    return [2.0 ** -sum(slopes[:count]) for count in range(len(slopes) + 1)]


@pytest.mark.parametrize(("off", "straight"), [(0.199, True), (0.201, False)])
def test_a_slope_may_be_a_fifth_off_the_order(off: float, *, straight: bool) -> None:
    found = asymptotic_order(HALVES, ladder(1.0 + off, 1.0 - off))
    assert (found is not None) is straight


@pytest.mark.parametrize(("power", "falls"), [(0.251, True), (0.249, False), (-1.0, False)])
def test_an_order_is_a_quarter_at_least(power: float, *, falls: bool) -> None:
    found = asymptotic_order(HALVES, ladder(power, power))
    assert (found is not None) is falls


def test_an_order_needs_three_neighbouring_rungs() -> None:
    assert asymptotic_order(HALVES[:2], ladder(1.0)) is None
    found = asymptotic_order(HALVES, ladder(1.0, 1.0))
    assert found is not None
    assert (found.points, found.coarsest, found.finest) == (3, 1.0, 0.25)


def test_the_confidence_of_an_order_is_that_of_95_percent() -> None:
    # of three rungs about a line of slope 1: residuals d/3, -2 d/3, d/3 octaves, one degree of
    # freedom, for which the table of Student's t has 12.706 at 95 %
    found = asymptotic_order(HALVES, ladder(1.1, 0.9))
    assert found is not None
    assert found.order == pytest.approx(1.0, rel=1e-12)
    assert found.confidence == pytest.approx(12.706 * 0.1 / math.sqrt(3.0), rel=1e-4)


def test_of_a_straight_line_of_four_rungs_too() -> None:
    # slopes 1.1, 0.9, 1.1 about their fit: two degrees of freedom, 4.303 in the table
    y = -np.log2(ladder(1.1, 0.9, 1.1))
    x = np.arange(4.0)
    slope, offset = np.polyfit(x, y, 1)
    rest = y - slope * x - offset
    expected = 4.303 * math.sqrt(float(rest @ rest) / 2.0 / 5.0)
    found = asymptotic_order((*HALVES, 0.125), ladder(1.1, 0.9, 1.1))
    assert found is not None
    assert found.confidence == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize(("left", "points"), [(0.201, 4), (0.199, 3)])
def test_a_rung_counts_whose_rest_is_a_fifth_of_the_level(left: float, points: int) -> None:
    for level in (1.0, -1.0):
        errors = [level * (1.0 + left * 2.0**rung) for rung in (3, 2, 1, 0)]
        found = asymptotic_order((*HALVES, 0.125), errors, level)
        assert found is not None
        assert found.points == points


def test_of_ranges_equally_long_the_finest_counts() -> None:
    steps = [2.0**-rung for rung in range(7)]
    errors: list[float | None] = [*ladder(3.0, 3.0), None, *ladder(1.0, 1.0)]
    found = asymptotic_order(steps, errors)
    assert found is not None
    assert found.order == pytest.approx(1.0, rel=1e-9)
    assert (found.coarsest, found.finest) == pytest.approx((2.0**-4, 2.0**-6))


def test_a_slope_needs_two_points_and_a_spread_three() -> None:
    assert observed_order((1.0, 0.5), (1.0, 0.5)).order == pytest.approx(1.0)
    assert math.isnan(observed_order((1.0, 0.5), (1.0, 0.5)).spread)
    assert observed_order(HALVES, ladder(1.5, 0.5)).spread == pytest.approx(0.5)


@pytest.mark.parametrize(("share", "level"), [(0.99, True), (1.01, False)])
def test_a_level_is_one_where_it_outweighs_the_rest_at_the_finest_rung(
    share: float, *, level: bool
) -> None:
    steps = [2.0**rung for rung in range(6)]
    found = plateau(steps, [1.0 + share * step for step in steps])
    assert (found is not None) is level
    if found is not None:
        assert found.level == pytest.approx(1.0, rel=1e-6)
        assert found.timestep == pytest.approx(1.0 / share, rel=1e-6)
        assert (found.rungs, found.erratic) == (6, False)


def test_a_level_of_second_order_outweighs_below_the_root() -> None:
    steps = [4.0 * 2.0**rung for rung in range(6)]
    found = plateau(steps, [1.0 + 0.02 * step**2 for step in steps])
    assert found is not None
    assert found.timestep == pytest.approx(math.sqrt(50.0), rel=1e-6)


@pytest.mark.parametrize("constant", [0.0, 1e-300])
def test_a_ladder_without_a_trend_is_level_up_to_its_coarsest_rung(
    constant: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(convergence, "_fit", lambda *_: (1.0, constant, 1.0, 0.0))
    found = plateau((8.0, 4.0, 2.0, 1.0), (1.0, 1.0, 1.0, 1.0))
    assert found is not None
    assert (found.timestep, found.rungs, found.erratic) == (8.0, 4, False)


def test_rungs_too_coarse_for_the_model_are_left_out_one_by_one() -> None:
    steps = [2.0**rung for rung in range(6)]
    errors = [1.0 + 0.1 * step for step in steps]
    errors[-1] *= 1.5
    found = plateau(steps, errors)
    assert found is not None
    assert found.rungs == 5
    assert found.level == pytest.approx(1.0, rel=1e-6)


def test_a_level_ends_at_the_coarsest_rung_that_was_tried() -> None:
    steps = [2.0**-rung for rung in range(6)]
    found = plateau(steps, [1.0 + 0.1 * step for step in steps])
    assert found is not None
    assert found.timestep == 1.0


def test_the_model_needs_four_rungs() -> None:
    steps = (1.0, 0.7, 0.5, 0.35)  # no three of them span a factor of four
    errors = [1.0 + 0.5 * step**2 for step in steps]
    found = plateau(steps, errors)
    assert found is not None
    assert (found.rungs, found.erratic) == (4, False)
    assert plateau(steps[1:], errors[1:]) is None


@pytest.mark.parametrize(("size", "fits"), [(0.0195, True), (0.0215, False)])
def test_the_model_is_believed_up_to_a_residual_of_2_percent(size: float, *, fits: bool) -> None:
    # a ripple from rung to rung, which no power of the timestep follows but at the coarsest few:
    # of 60 rungs they take some hundredths off the rms
    steps = [1.2**rung for rung in range(60)]
    found = plateau(steps, [1.0 / (1.0 + size * (-1.0) ** rung) for rung in range(60)])
    assert found is not None
    assert (found.rungs == 60) is fits


@pytest.mark.parametrize(("largest", "flat"), [(1.49, True), (1.51, False)])
def test_a_flat_ladder_varies_by_half_at_most(largest: float, *, flat: bool) -> None:
    for sign in (1.0, -1.0):
        smallest = 1e-3 * sign
        found = plateau((1.0, 0.1, 0.01), [smallest * size for size in (1.0, largest, 1.0)])
        assert (found is not None) is flat
        if found is not None:
            assert found.level == pytest.approx(smallest * largest ** (1.0 / 3.0), rel=1e-9)
            assert (found.timestep, found.rungs, found.erratic) == (1.0, 3, True)


@pytest.mark.parametrize(("coarsest", "flat"), [(4.0, True), (3.99, False)])
def test_a_flat_ladder_spans_a_factor_of_four(coarsest: float, *, flat: bool) -> None:
    found = plateau((coarsest, 2.0, 1.0), (1.0, 1.1, 1.0))
    assert (found is not None) is flat


def test_two_errors_or_two_signs_are_no_flat_ladder() -> None:
    assert plateau((4.0, 1.0), (1.0, 1.0)) is None
    assert plateau((16.0, 4.0, 1.0), (1.0, -1.0, 1.0)) is None
    assert plateau((16.0, 4.0, 1.0), (1.0, 0.0, None)) is None


def test_an_error_of_zero_is_left_out_of_a_ladder_and_one_of_minus_one_is_not() -> None:
    for level in (1.0, -1.0):
        found = plateau((64.0, 16.0, 4.0, 1.0), (level, 1.1 * level, 0.0, level))
        assert found is not None
        assert (found.timestep, found.rungs) == (64.0, 3)


@pytest.mark.parametrize(("depth", "found"), [(-1e-6, 0.0), (0.0, 0.0), (1e-6, 1e-6)])
def test_a_can_that_never_sank_has_no_penetration(
    depth: float, found: float, gentle: Scene
) -> None:
    hovering = make_trajectory(2, penetration=np.full(2, depth))
    assert contact_quality(motion(hovering, gentle)).max_penetration == found


def test_what_is_unknown_of_a_contact_is_nothing(gentle: Scene) -> None:
    unknown = np.full((2, 3), np.nan)
    found = contact_quality(
        motion(make_trajectory(2, penetration=unknown[:, 0], contact_point=unknown), gentle)
    )
    assert (found.max_penetration, found.max_slip, found.lift_off_fraction) == (0.0, 0.0, 1.0)


@pytest.mark.parametrize(("counts", "share"), [((1, 1), 0.0), ((1, 2), 0.5), ((2, 2), 1.0)])
def test_several_points_are_two_or_more(
    counts: tuple[int, int], share: float, gentle: Scene
) -> None:
    touching = make_trajectory(2, contact_count=np.array(counts))
    assert contact_quality(motion(touching, gentle)).multi_contact_fraction == share


def rocked(scene: Scene, time: np.ndarray, phi: np.ndarray, rate: np.ndarray) -> int:
    """Return the bounces of a can that rocks in a plane."""
    still = np.zeros(len(time))
    record = make_trajectory(
        len(time),
        time=time,
        quaternion=quaternion(phi, still, still),
        angular_velocity=angular_velocity(phi, still, rate, still, still),
    )
    return len(bounces(motion(record, scene), scene.can))


@pytest.mark.parametrize(("depth", "found"), [(0.0101, 1), (0.0099, 0)])
def test_a_bounce_stands_out_by_a_hundredth_of_the_largest_phi(
    depth: float, found: int, gentle: Scene
) -> None:
    time = np.linspace(0.0, 1.0, 401)
    phi = 0.1 * (1.0 - depth * np.sin(np.pi * time) ** 2)
    rate = -0.1 * depth * np.pi * np.sin(2.0 * np.pi * time)
    assert rocked(gentle, time, phi, rate) == found


def test_a_ripple_of_a_small_phi_stands_out_from_it_and_not_from_the_largest(gentle: Scene) -> None:
    time = np.linspace(0.0, 1.0, 401)
    phi = 0.21 + 0.19 * np.cos(2.0 * np.pi * time) - 1e-3 * np.cos(100.0 * np.pi * time)
    assert rocked(gentle, time, phi, np.zeros(401)) == 1


def sampled(scene: Scene, phi: tuple[float, ...], rate: tuple[float, ...]) -> Motion:
    """Return the motion of a can that rocks in a plane, a sample a second; phi in tenths."""
    still = np.zeros(len(phi))
    record = make_trajectory(
        len(phi),
        quaternion=quaternion(0.1 * np.array(phi), still, still),
        angular_velocity=angular_velocity(0.1 * np.array(phi), still, np.array(rate), still, still),
    )
    return motion(record, scene)


TWO = ((3.0, 2.0, 1.0, 2.0, 3.0, 2.0, 1.0, 2.0, 3.0), (0.0,) * 9)
"""Two bounces, from sample 0 to 4 and from there to 8."""


def test_a_bounce_holds_the_samples_from_maximum_to_maximum(gentle: Scene) -> None:
    rest = sampled(gentle, *TWO)
    seen = replace(
        rest,
        angles=replace(rest.angles, psi_dot=np.array((1.0, 0, 0, 0, -2.0, 9.0, 0, 0, 0))),
        friction_ratio=np.array((0.1, 0.2, 0.1, 0.1, 0.3, 0.5, 0.4, 0.4, 0.4)),
    )
    first, second = bounces(seen, gentle.can)
    assert (first.peak_psi_dot, second.peak_psi_dot) == (-2.0, 9.0)
    assert (first.peak_friction_ratio, second.peak_friction_ratio) == (0.3, 0.5)
    assert (first.start, first.end, second.start, second.end) == (0.0, 4.0, 4.0, 8.0)


@pytest.mark.parametrize("place", range(9))
def test_a_turn_is_unresolved_where_a_step_within_its_bounce_is(place: int, gentle: Scene) -> None:
    rest = sampled(gentle, *TWO)
    lost = np.arange(9) == place  # the step that ends with this sample
    first, second = bounces(replace(rest, angles=replace(rest.angles, unresolved=lost)), gentle.can)
    assert first.resolved is not (1 <= place <= 4)
    assert second.resolved is not (5 <= place <= 8)


@pytest.mark.parametrize(
    ("phi", "rate", "ends"),
    [
        ((3.0, 1.0, 4.0), (0.0, 0.0, 0.0), (0.0, 2.0)),
        # a release that falls, and a record that ends on a rise
        ((3.0, 1.0, 3.0, 2.0, 2.5), (-1.0, 0.0, 0.0, 0.0, 1.0), (0.0, 2.0)),
        # phi' is zero half way between the first two samples, and between the last two
        ((2.9, 3.0, 1.0, 3.0, 2.9), (1.0, -1.0, 0.0, 1.0, -1.0), (0.5, 3.5)),
    ],
)
def test_a_bounce_of_a_few_samples_begins_and_ends_at_its_maxima(
    phi: tuple[float, ...],
    rate: tuple[float, ...],
    ends: tuple[float, float],
    gentle: Scene,
) -> None:
    (found,) = bounces(sampled(gentle, phi, rate), gentle.can)
    assert (found.start, found.end) == pytest.approx(ends, abs=1e-9)


@pytest.mark.parametrize(("share", "found"), [(0.9e-6, 1), (1.1e-6, 0)])
@pytest.mark.parametrize("end", ["first", "last"])
def test_a_record_that_begins_or_ends_within_a_millionth_of_rest_has_its_maximum_there(
    share: float, found: int, end: str, gentle: Scene
) -> None:
    time = np.linspace(0.0, 1.0, 401)
    phi = 0.1 + 0.05 * np.cos(2.0 * np.pi * time)
    rate = -0.05 * 2.0 * np.pi * np.sin(2.0 * np.pi * time)
    rate[0] = rate[-1] = 0.0
    largest = float(np.abs(rate).max())
    rate[{"first": 0, "last": -1}[end]] = share * largest
    assert rocked(gentle, time, phi, rate) == found


def test_a_curve_has_two_ends() -> None:
    line = np.array(((0.0, 0.0), (1.0, 0.0)))
    assert hausdorff(line, line + np.array((0.0, 0.5))) == 0.5
    assert math.isnan(hausdorff(line[:1], line))
    assert math.isnan(hausdorff(line, line[:1]))


@pytest.mark.parametrize(("turn", "phi_min"), [(0.099, 0.95), (0.101, math.cos(0.0505))])
def test_from_a_tenth_of_a_radian_of_the_rim_on_a_minimum_is_that_of_a_straight_line(
    turn: float, phi_min: float, gentle: Scene
) -> None:
    # two samples at the same phi with phi' = -+ v: a cubic in time dips by v/4, and the chord of
    # phi exp(i chi) by what its cosine says; both records begin and end with a rest
    phi = 0.1 * np.array((2.0, 2.0, 1.0, 1.0, 2.0, 2.0))
    rate = 0.1 * np.array((0.0, 0.0, -0.2, 0.2, 0.0, 0.0))
    can = gentle.can
    psi = np.array((0.0, 0.0, 0.0, 1.0, 1.0, 1.0)) * turn / can.slowness
    still = np.zeros(6)
    record = make_trajectory(
        6,
        quaternion=quaternion(phi, psi, still),
        angular_velocity=angular_velocity(phi, psi, rate, still, still),
    )
    seen = motion(record, gentle)
    assert np.ptp(seen.angles.psi) * can.slowness == pytest.approx(turn, rel=1e-9)
    (found,) = bounces(seen, can)
    assert found.phi_min == pytest.approx(0.1 * phi_min, rel=1e-9)
    assert found.time == pytest.approx(2.5, rel=1e-12)


@pytest.mark.parametrize(("nearer", "distance"), [(15, 0.1), (16, 0.5)])
def test_the_chords_of_the_sixteen_nearest_points_are_tried(nearer: int, distance: float) -> None:
    # the curve passes 0.1 below the origin on a chord whose ends are farther away than the points
    # that lie 0.5 to its left
    angle = np.linspace(0.9, 1.1, nearer) * np.pi
    points = 0.5 * np.stack((np.cos(angle), np.sin(angle)), axis=-1)
    ends = np.array(((-3.0, -0.1), (1.0, -0.1), (5.0, 3.0)))
    curve = np.concatenate((points, ends))
    reached = np.concatenate((curve, np.zeros((1, 2))))
    assert hausdorff(reached, curve) == pytest.approx(distance, rel=1e-3)  # a chord of the arc
    assert hausdorff(reached[::-1], curve[::-1]) == pytest.approx(distance, rel=1e-3)


def test_a_curve_ends_where_its_points_end() -> None:
    line = np.array(((0.0, 0.0), (1.0, 0.0)))
    assert hausdorff(line, line + np.array(((0.0, 0.0), (1.0, 0.0)))) == 1.0
    assert hausdorff(line, line - np.array(((1.0, 0.0), (0.0, 0.0)))) == 1.0


@pytest.mark.parametrize("measure", [observed_order, asymptotic_order, plateau, pareto_front])
def test_two_lists_are_of_one_length(
    measure: Callable[[tuple[float, ...], tuple[float, ...]], object],
) -> None:
    with pytest.raises(ValueError, match="shorter"):
        measure(HALVES, HALVES[:2])


@pytest.mark.parametrize(("power", "told_apart"), [(0.31, True), (0.25, False)])
def test_no_power_below_three_tenths_is_told_from_a_level(
    power: float, *, told_apart: bool
) -> None:
    """The first order that is tried is 0.4, and it is refined by a step of 0.1 at most."""
    steps = [2.0**-k for k in range(8)]
    found = plateau(steps, [1.0 + 0.5 * step**power for step in steps])
    assert found is not None
    assert (abs(found.level - 1.0) < 1e-3) is told_apart
