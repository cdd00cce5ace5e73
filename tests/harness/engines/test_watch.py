"""The watch: it counts bounces, not ripples, and knows flat from over from broken."""

import math
from dataclasses import replace

import numpy as np
import pytest

from harness.core.bounce import PROMINENCE
from harness.core.errors import InvalidSettingError
from harness.core.simulation import Outcome
from harness.core.trajectory import Trajectory, take
from harness.engines.stepping.horizon import Watch, countable, longest_time, natural_time
from models import Horizon, Scene, quaternion
from models.kinematics import nutation
from tests.support.trajectories import make_trajectory

TIME = np.linspace(0.0, 1.0, 4001)

FLAT_ALLOWANCE = 20.0
"""As the docstring has it, and not imported: whoever changes it is told."""


def over(watch: Watch, samples: Trajectory) -> Outcome | None:
    """Show a watch these samples, with their nutation."""
    return watch.over(samples.time, samples.velocity, nutation(samples.quaternion))


def told(
    scene: Scene, time: np.ndarray, phi: np.ndarray, part: int = 100
) -> tuple[Outcome | None, float]:
    """Return what a watch says of nutation over time, told in parts, and when."""
    watch = Watch(scene)
    for left in range(0, len(time), part):
        inside = slice(left, left + part)
        n = len(time[inside])
        zero = np.zeros(n)
        outcome = over(
            watch,
            make_trajectory(n, time=time[inside], quaternion=quaternion(phi[inside], zero, zero)),
        )
        if outcome is not None:
            return outcome, watch.ended_at
    return None, watch.ended_at


def bouncing(periods: float, lowest: float = 0.01) -> np.ndarray:
    """Return nutation that starts at its maximum, 0.4, and has so many minima in one second."""
    return np.hypot(lowest, 0.4 * np.cos(np.pi * periods * TIME))


@pytest.mark.parametrize("wanted", [1, 2, 5])
@pytest.mark.parametrize("part", [1, 100, 4001])
def test_it_ends_after_the_maximum_that_closes_the_last_bounce(
    gentle: Scene, wanted: int, part: int
) -> None:
    scene = replace(gentle, horizon=Horizon(bounces=wanted))
    outcome, when = told(scene, TIME, bouncing(6.5), part)
    assert outcome is Outcome.FINISHED
    closing = wanted / 6.5  # the time of the maximum
    # from it, phi falls by the prominence: 0.4 (1 - cos x) = 0.004 at x = 0.1415
    assert closing < when < closing + 0.1415 / (np.pi * 6.5) + 2e-3


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("part", [1, 3, 17, 250])
def test_what_it_says_does_not_depend_on_the_parts(gentle: Scene, seed: int, part: int) -> None:
    """Told whole, no stretch only falls or only rises; in parts most do, some across a turn."""
    random = np.random.default_rng(seed)
    steps = np.linspace(0.0, 1.0, 41)
    heights = 10.0 ** random.uniform(-4.0, 0.1, len(steps))
    heights[0] = gentle.release.phi
    phi = np.interp(TIME, steps, heights)
    scene = replace(gentle, horizon=Horizon(bounces=int(random.integers(1, 9))))
    assert told(scene, TIME, phi, part) == told(scene, TIME, phi, len(TIME))


def test_too_few_bounces_do_not_end_it(gentle: Scene) -> None:
    scene = replace(gentle, horizon=Horizon(bounces=7))
    assert told(scene, TIME, bouncing(6.5)) == (None, math.inf)


def test_a_horizon_in_seconds_is_not_ended_by_bounces(gentle: Scene) -> None:
    scene = replace(gentle, horizon=Horizon(seconds=1.0))
    assert told(scene, TIME, bouncing(6.5)) == (None, math.inf)


def test_a_ripple_is_no_bounce(gentle: Scene) -> None:
    # half the prominence from top to bottom, four times through the fall and the rise
    ripple = 0.25 * PROMINENCE * 0.4 * np.sin(2.0 * np.pi * 40.0 * TIME)
    phi = bouncing(1.0) + ripple
    scene = replace(gentle, horizon=Horizon(bounces=2))
    assert told(scene, TIME, phi)[0] is None  # one bounce, whatever the ripples
    scene = replace(gentle, horizon=Horizon(bounces=1))
    twice = np.hypot(0.01, 0.4 * np.cos(np.pi * 2.0 * TIME)) + ripple
    outcome, when = told(scene, TIME, twice)
    assert outcome is Outcome.FINISHED
    assert 0.45 < when < 0.65  # at the maximum at 0.5, not at the first ripple


def test_a_release_that_first_rises_has_no_bounce_before_its_first_minimum(gentle: Scene) -> None:
    scene = replace(gentle, release=replace(gentle.release, phi=0.2, phi_dot=1.0))
    phi = np.abs(0.4 * np.sin(np.pi / 6.0 + np.pi * 4.0 * TIME))
    phi = np.hypot(0.01, phi)
    outcome, when = told(scene, TIME, phi)
    assert outcome is Outcome.FINISHED
    first_maximum, period = (1.0 / 3.0) / 4.0, 0.25
    assert first_maximum + period < when < first_maximum + 1.3 * period


def test_flat_is_a_can_that_does_not_rise_again(gentle: Scene) -> None:
    T = natural_time(gentle)
    allowed = FLAT_ALLOWANCE * T
    time = np.linspace(0.0, 3.0 * allowed, 3000)
    phi = 0.4 * np.exp(-time / (0.1 * allowed))
    outcome, when = told(gentle, time, phi)
    assert outcome is Outcome.FLAT
    sinks = 0.1 * allowed * math.log(1.0 / PROMINENCE)  # when it passes below the prominence
    assert when == pytest.approx(sinks + allowed, rel=2e-3)  # to the spacing of the samples


def test_a_can_that_rises_just_in_time_is_not_flat(gentle: Scene) -> None:
    allowed = FLAT_ALLOWANCE * natural_time(gentle)
    time = np.linspace(0.0, 0.98 * allowed, 1000)
    phi = np.where((time < 0.01 * allowed) | (time > 0.96 * allowed), 0.39, 1e-4)
    assert told(gentle, time, phi)[0] is None


def test_over_is_a_can_on_its_side(gentle: Scene) -> None:
    phi = 0.4 + 2.0 * TIME
    outcome, when = told(gentle, TIME, phi)
    assert outcome is Outcome.OVERTURNED
    assert when == TIME[np.flatnonzero(phi >= np.pi / 2.0)[0]]


@pytest.mark.parametrize("speed", [np.nan, np.inf, 1e3])
def test_speeds_that_are_none_or_huge_have_diverged(gentle: Scene, speed: float) -> None:
    velocity = np.zeros((3, 3))
    velocity[1, 2] = speed
    watch = Watch(gentle)
    assert over(watch, make_trajectory(3, velocity=velocity)) is Outcome.DIVERGED


@pytest.mark.parametrize("part", [1, 100, 4001])
def test_a_run_ends_where_its_speed_is_first_too_large(gentle: Scene, part: int) -> None:
    watch = Watch(replace(gentle, horizon=Horizon(seconds=1.0)))
    phi, zero = bouncing(6.5), np.zeros(len(TIME))
    velocity = np.zeros((len(TIME), 3))
    velocity[:, 2] = 1e3 * (TIME >= 0.3)
    whole = make_trajectory(
        len(TIME), time=TIME, velocity=velocity, quaternion=quaternion(phi, zero, zero)
    )
    outcomes = [
        over(watch, take(whole, np.arange(left, min(left + part, len(TIME)))))
        for left in range(0, int(0.3 * 4000) + 1, part)
    ]
    assert outcomes[-1] is Outcome.DIVERGED
    assert set(outcomes[:-1]) <= {None}
    assert watch.ended_at == 0.3


def test_what_comes_after_the_end_does_not_change_how_a_run_ended(gentle: Scene) -> None:
    tilt = np.array((0.4, 2.0, 0.4))
    velocity = np.zeros((3, 3))
    velocity[2, 2] = 1e3
    watch = Watch(gentle)
    told_at_once = make_trajectory(
        3, velocity=velocity, quaternion=quaternion(tilt, np.zeros(3), np.zeros(3))
    )
    assert over(watch, told_at_once) is Outcome.OVERTURNED


def test_a_fast_release_has_not_diverged(gentle: Scene) -> None:
    fast = replace(gentle, release=replace(gentle.release, theta_dot=3000.0))
    velocity = np.zeros((3, 3))
    velocity[:, 0] = 3000.0 * gentle.can.radius  # rolling at that rate
    flat = quaternion(np.full(3, 0.4), np.zeros(3), np.zeros(3))
    assert over(Watch(fast), make_trajectory(3, velocity=velocity, quaternion=flat)) is None


def test_the_longest_time_goes_with_the_horizon(gentle: Scene) -> None:
    assert longest_time(replace(gentle, horizon=Horizon(seconds=0.7))) == 0.7
    one, two = (longest_time(replace(gentle, horizon=Horizon(bounces=n))) for n in (1, 2))
    assert two == 2.0 * one
    assert math.isfinite(longest_time(replace(gentle, gravity=0.0)))


def test_a_bounce_is_allowed_a_hundred_natural_times(gentle: Scene) -> None:
    one = replace(gentle, horizon=Horizon(bounces=1))
    assert longest_time(one) == pytest.approx(100.0 * natural_time(gentle), rel=1e-12)


def test_more_than_1e15_steps_are_refused(gentle: Scene) -> None:
    scene = replace(gentle, horizon=Horizon(seconds=1.0))
    countable(1.01e-15, scene)
    with pytest.raises(InvalidSettingError):
        countable(0.99e-15, scene)


@pytest.mark.parametrize(("share", "outcome"), [(0.999, None), (1.001, Outcome.DIVERGED)])
def test_a_thousand_times_the_energy_of_the_release_has_diverged(
    gentle: Scene, share: float, outcome: Outcome | None
) -> None:
    still = replace(gentle.release, phi_dot=0.0, psi_dot=0.0, theta_dot=0.0)
    weight = gentle.gravity * gentle.can.bounding_radius
    velocity = np.zeros((3, 3))
    velocity[1, 2] = np.sqrt(share * 1e3 * weight)
    flat = quaternion(np.full(3, 0.4), np.zeros(3), np.zeros(3))
    watch = Watch(replace(gentle, release=still, horizon=Horizon(seconds=1.0)))
    assert over(watch, make_trajectory(3, velocity=velocity, quaternion=flat)) is outcome
