"""Numbers that prose cites of the timestep rule and of settling, just inside and just outside each.

They are written out here as README and the docstrings have them, and not imported: whoever changes
one in the code is told which sentence no longer holds.
"""

# ruff: noqa: D102 - the methods of a toy are described where its role is

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from harness.core.case import Case
from harness.core.errors import InvalidSettingError
from harness.engines.registry import engine
from harness.engines.stepping.recording import Chunk
from harness.engines.stepping.schedule import (
    ETA_SETTING,
    Adaptive,
    Fixed,
    Schedule,
    Stage,
    power_of_two,
)
from harness.engines.stepping.settling import settle
from models import Pose, Scene, Twist, contact_point, load, release_state
from tests.support.engines import STEPPING, stepping_engine

CAN = load("paper-release").can
UPRIGHT = (1.0, 0.0, 0.0, 0.0)
TILTED = (math.cos(0.1), math.sin(0.1), 0.0, 0.0)


def adaptive(
    *, largest: float = 2.0**-10, smallest: float = 2.0**-30, limit: float = 1.0, unit: float = 1.0
) -> Adaptive:
    eta = ETA_SETTING.adaptive
    assert isinstance(eta, float)
    return Adaptive(CAN, largest=largest, smallest=smallest, limit=limit, eta=eta, unit=unit)


def about_its_axis(rate: float) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return a tilted can that spins about its own axis: its tilt does not move, it turns."""
    c, s = math.cos(0.2), math.sin(0.2)
    return TILTED, (0.0, -s * rate, c * rate)


def rocking(rate: float) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return a can whose tilt of 0.2 rad falls with phi'/tan(phi) of this rate, 1/s."""
    return TILTED, (-rate * math.tan(0.2), 0.0, 0.0)


def stage(schedule: Adaptive, state: tuple[tuple[float, ...], tuple[float, ...]]) -> Stage:
    found = schedule.next(*state)
    assert found is not None
    return found


@pytest.mark.parametrize(("share", "exponent"), [(0.00999, -14), (0.01001, -15)])
def test_the_tilt_moves_by_a_hundredth_of_its_way_in_a_step(share: float, exponent: int) -> None:
    assert stage(adaptive(), rocking(share * 2.0**14)).timestep == 2.0**exponent


@pytest.mark.parametrize(("angle", "exponent"), [(0.00999, -14), (0.01001, -15)])
def test_a_can_turns_by_a_hundredth_of_a_radian_in_a_step(angle: float, exponent: int) -> None:
    # the natural time is so short that the rule for spin takes nothing off
    schedule = adaptive(unit=1e-12)
    assert stage(schedule, about_its_axis(angle * 2.0**14)).timestep == 2.0**exponent


@pytest.mark.parametrize("unit", [1.0, 0.0614])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_half_is_allowed_at_an_axial_rate_of_0_015_natural_units(unit: float, sign: float) -> None:
    def allowed(rate: float) -> float:
        return adaptive(unit=unit).eta(*about_its_axis(sign * rate / unit))

    assert allowed(0.0149) > 0.005 > allowed(0.0151)
    assert allowed(0.0) == pytest.approx(0.01, rel=1e-12, abs=0)
    assert allowed(0.045) == pytest.approx(0.0025, rel=1e-12, abs=0)  # 1/(1 + 3)


def test_a_top_is_allowed_a_hundredth_and_no_less() -> None:
    def allowed(rate: float) -> float:
        return adaptive().eta(*about_its_axis(rate))

    assert allowed(1.48) > 1.0001e-4  # 1/(1 + 98.7)
    assert allowed(1.49) == pytest.approx(1e-4, rel=1e-12, abs=0)  # not 1/(1 + 99.3)
    assert allowed(1e6) == pytest.approx(1e-4, rel=1e-12, abs=0)


@pytest.mark.parametrize(
    ("value", "found"), [(2.0**-14, 2.0**-14), (2.0**-14 * (1.0 - 1e-15), 2.0**-15), (3.0, 2.0)]
)
def test_steps_are_powers_of_two_and_no_larger(value: float, found: float) -> None:
    assert power_of_two(value) == found


def test_bounds_are_taken_down_to_powers_of_two() -> None:
    schedule = adaptive(largest=1.9 * 2.0**-10, smallest=1.9 * 2.0**-30)
    assert stage(schedule, rocking(0.0)).timestep == 2.0**-10
    assert stage(schedule, rocking(1e15)).timestep == 2.0**-30
    # never larger than the largest, whatever the smallest is said to be
    crossed = adaptive(largest=2.0**-10, smallest=2.0**-5)
    assert stage(crossed, rocking(1e15)).timestep == 2.0**-10


def test_an_upright_axis_takes_the_smallest_step_and_no_number_the_largest() -> None:
    assert adaptive().rate(UPRIGHT, (1.0, 0.0, 0.0)) == math.inf
    assert stage(adaptive(), (UPRIGHT, (1.0, 0.0, 0.0))).timestep == 2.0**-30
    assert stage(adaptive(), (TILTED, (math.nan, 0.0, 0.0))).timestep == 2.0**-10


@pytest.mark.parametrize(("share", "count"), [(0.00499, 100), (0.00501, 99), (0.6, 1)])
def test_the_tilt_moves_by_half_of_its_way_before_the_next_look(share: float, count: int) -> None:
    # the smallest step is the largest: the rate alone decides
    schedule = adaptive(largest=2.0**-10, smallest=2.0**-10)
    found = stage(schedule, rocking(share * 2.0**10))
    assert len(found.times) == found.ahead == count


def test_of_a_slow_motion_256_steps_are_taken_at_once() -> None:
    found = stage(adaptive(), rocking(0.5 * 2.0**10 / 257.0))
    assert len(found.times) == 256
    assert len(stage(adaptive(), rocking(0.5 * 2.0**10 / 255.0)).times) == 255


@pytest.mark.parametrize(("limit", "count"), [(7.0, 8), (7.99, 8), (8.0, 9)])
def test_steps_end_with_the_last_before_or_at_the_limit(limit: float, count: int) -> None:
    schedule = adaptive(limit=limit * 2.0**-10)
    assert len(stage(schedule, rocking(0.0)).times) == count
    assert schedule.next(*rocking(0.0)) is None


def test_a_long_run_goes_on_after_its_first_stage() -> None:
    schedule = adaptive(limit=255.0 * 2.0**-10)  # 256 states with both ends
    assert len(stage(schedule, rocking(0.0)).times) == 256
    assert schedule.next(*rocking(0.0)) is None
    schedule = adaptive(limit=256.0 * 2.0**-10)
    assert len(stage(schedule, rocking(0.0)).times) == 256
    assert stage(schedule, rocking(0.0)).times.tolist() == [256.0 * 2.0**-10]


@pytest.mark.parametrize("eta", [0.0, -0.01])
def test_the_share_of_the_way_is_positive(eta: float) -> None:
    case = Case(scene=load("paper-release"), engine="mujoco", profile="adaptive")
    with pytest.raises(InvalidSettingError) as caught:
        stepping_engine("mujoco").resolve(replace(case, options=(("eta", eta),)))
    assert (caught.value.name, caught.value.value) == ("eta", eta)


@pytest.mark.parametrize(
    ("limit", "count"), [(0.3, 4), (0.3 * (1.0 - 0.8e-12), 4), (0.3 * (1.0 - 1.2e-12), 3)]
)
def test_round_off_of_a_division_takes_no_fixed_step_away(limit: float, count: int) -> None:
    assert limit / 0.1 < 3.0
    found = Fixed(0.1, limit, 100).next(UPRIGHT, (0.0, 0.0, 0.0))
    assert found is not None
    assert len(found.times) == found.ahead == count


def test_fixed_steps_say_how_many_are_to_come() -> None:
    schedule = Fixed(1.0, 9.0, 4)
    found = [schedule.next(UPRIGHT, (0.0, 0.0, 0.0)) for _ in range(4)]
    assert [one.ahead for one in found if one is not None] == [10, 6, 2]
    assert found[3] is None


class SeenError(Exception):
    """Ends a run that has shown its schedule."""


@pytest.mark.parametrize("name", STEPPING)
def test_adaptive_steps_go_from_30_microseconds_down_to_nanoseconds(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    # of the natural time, 0.0614 s, 5e-4 are 30.7 microseconds and 1e-9 are 0.0614 nanoseconds:
    # the powers of two below them are 2^-15 and 2^-34
    shown: list[Schedule] = []

    def show(_self: object, _world: object, schedule: Schedule, _size: int) -> Iterator[Chunk]:
        shown.append(schedule)
        raise SeenError

    chosen = engine(name)
    monkeypatch.setattr(type(chosen), "chunks", show)
    with pytest.raises(SeenError):
        chosen.simulate(Case(scene=load("paper-release"), engine=name, profile="adaptive"))
    (schedule,) = shown
    still, hardest = rocking(0.0), rocking(1e15)
    for state, exponent in ((still, -15), (hardest, -34)):
        found = schedule.next(*state)
        assert found is not None
        assert found.timestep == 2.0**exponent


class Floor:
    """A world of one step that gives the touching point a velocity by its depth below zero."""

    def __init__(self, scene: Scene, rise: object) -> None:
        self.scene, self.rise = scene, rise
        self.timestep, self.placed = 1e-4, 0

    def place(self, pose: Pose, twist: Twist) -> None:
        self.placed += 1
        self._pose, self._twist = pose, twist

    def signed_distance(self) -> float:
        return float(contact_point(self.scene.can, self._pose.position, self._pose.quaternion)[2])

    def step(self) -> None:
        upward = self.rise(-self.signed_distance())  # type: ignore[operator]
        self._twist = Twist(velocity=np.array((0.0, 0.0, upward)), angular_velocity=np.zeros(3))

    def twist(self) -> Twist:
        return self._twist


def settled(scene: Scene, rise: object, twist: Twist | None = None) -> float:
    pose, own = release_state(scene.can, scene.release)
    depth, _ = settle(Floor(scene, rise), scene, pose, twist or own)  # type: ignore[arg-type]
    return depth


@pytest.fixture
def at_rest(gentle: Scene) -> Scene:
    return replace(gentle, release=replace(gentle.release, psi_dot=0.0, theta_dot=0.0))


@pytest.mark.parametrize(("share", "soft"), [(0.9, False), (1.1, True)])
def test_a_billionth_of_what_a_step_falls_is_rest(
    at_rest: Scene, share: float, *, soft: bool
) -> None:
    sinking = share * 1e-9 * at_rest.gravity * 1e-4  # m/s
    depth = settled(at_rest, lambda depth: -sinking if depth < 1e-9 else sinking)
    assert (depth > 0.0) is soft


@pytest.mark.parametrize(("share", "soft"), [(0.9, False), (1.1, True)])
def test_round_off_of_a_release_is_rest(at_rest: Scene, share: float, *, soft: bool) -> None:
    fast = Twist(velocity=np.array((3e3, 4e3, 0.0)), angular_velocity=np.zeros(3))
    sinking = share * (1e-12 * 5e3 + 1e-9 * at_rest.gravity * 1e-4)  # m/s
    depth = settled(at_rest, lambda depth: -sinking if depth < 1e-9 else sinking, fast)
    assert (depth > 0.0) is soft


def test_a_contact_that_pushes_away_at_once_is_not_settled(at_rest: Scene) -> None:
    assert settled(at_rest, lambda depth: 1.0 + depth) == 0.0


@pytest.mark.parametrize(("share", "found"), [(0.099, True), (0.101, False)])
def test_no_depth_is_sought_beyond_a_tenth_of_the_radius(
    at_rest: Scene, share: float, *, found: bool
) -> None:
    wanted = share * at_rest.can.radius
    depth = settled(at_rest, lambda depth: depth - wanted)
    assert depth == (pytest.approx(wanted, rel=4e-6) if found else 0.0)


def test_a_release_off_the_plane_is_left_where_it_is(gentle: Scene) -> None:
    above = replace(gentle, release=replace(gentle.release, height=1e-3))
    pose, twist = release_state(above.can, above.release)
    world = Floor(above, lambda depth: depth - 1e-6)
    depth, same = settle(world, above, pose, twist)  # type: ignore[arg-type]
    assert (depth, same, world.placed) == (0.0, pose, 0)
