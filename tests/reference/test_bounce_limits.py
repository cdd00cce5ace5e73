"""Numbers that prose cites of bounces, flat cans, divergence and samples, just inside and outside.

They are written out here as prose has them, and not imported: whoever changes one in the code is
told which sentence no longer holds.
"""

# ruff: noqa: D102 - the methods of a toy are described where its role is

import math
from dataclasses import dataclass

import numpy as np
import pytest

from reference import PAPER_CAN, Effects, Outcome, Problem, divergence, solve
from reference.analysis.lyapunov import Divergence, _read
from reference.analysis.sampling import grid_by_angle
from reference.problem.states import Floats, Snapshot, States
from reference.smooth.extrema import ExtremumRecorder

# --- what counts as a bounce, and as no motion ----------------------------------------------------

PENDULUM = math.sqrt(PAPER_CAN.a + PAPER_CAN.h**2 + 1.0)
"""The pendulum time of the can, in sqrt(R/g)."""


def watch(
    fall: float | None = -0.5, *, phi: float = 0.4, until: float | None = None
) -> ExtremumRecorder:
    """Return a recorder of a release at rest, which falls."""
    bounces = 1 if until is None else None
    release = Problem(parameters=PAPER_CAN, phi=phi, bounces=bounces, duration=until)
    return ExtremumRecorder(release, fall)


def see(recorder: ExtremumRecorder, time: float, phi: float, *, maximum: bool) -> None:
    release = Problem(parameters=PAPER_CAN, phi=phi, bounces=1)
    recorder.extremum(time, Snapshot.of(release), maximum=maximum)


@pytest.mark.parametrize(("share", "bounced"), [(1.01e-9, True), (0.99e-9, False)])
def test_a_bounce_falls_by_a_billionth_of_its_height(share: float, *, bounced: bool) -> None:
    recorder = watch()
    see(recorder, 1.0, 0.4 * (1.0 - share), maximum=False)
    see(recorder, 2.0, 0.4, maximum=True)
    assert recorder.ended() is bounced
    if bounced:
        assert recorder.track().outcome is Outcome.FINISHED
        assert recorder.track().times.tolist() == [0.0, 1.0, 2.0]


def test_the_fourth_ripple_in_a_row_is_steady() -> None:
    recorder = watch()
    for number in range(1, 5):
        assert not recorder.ended()
        see(recorder, float(number), 0.4 * (1.0 - 1e-10 * (number % 2)), maximum=number % 2 == 0)
    assert recorder.track().outcome is Outcome.STEADY
    assert recorder.t_end == 4.0


def test_ripples_are_counted_in_a_row() -> None:
    recorder = watch(until=100.0)
    time, low = 0.0, 0.4
    for number in range(1, 8):
        time += 1.0
        # the fourth is none
        low = 0.3 if number == 4 else low
        see(recorder, time, low * (1.0 - 1e-10 * (number % 2)), maximum=number % 2 == 0)
    recorder.end(100.0, Outcome.FINISHED)
    assert recorder.track().times.size == 8


@pytest.mark.parametrize(("share", "steady"), [(0.999, False), (1.001, True)])
def test_what_does_not_move_for_400_pendulum_times_is_steady(share: float, *, steady: bool) -> None:
    recorder = watch()
    recorder.advance(share * 400.0 * PENDULUM, 0.4 * (1.0 - 0.99e-9))
    assert recorder.ended() is steady
    # and one whose time alone ends it is followed
    timed = watch(until=1e6)
    timed.advance(1e5, 0.4)
    assert not timed.ended()


def test_what_moves_by_a_billionth_is_waited_for_again() -> None:
    recorder = watch()
    recorder.advance(399.0 * PENDULUM, 0.4 * (1.0 - 1.01e-9))
    recorder.advance(798.0 * PENDULUM, 0.4 * (1.0 - 1.01e-9))
    assert not recorder.ended()
    recorder.advance(800.0 * PENDULUM, 0.4 * (1.0 - 1.01e-9))
    assert recorder.track().outcome is Outcome.STEADY


@pytest.mark.parametrize(("share", "steady"), [(0.999, False), (1.001, True)])
def test_a_weak_pull_has_four_times_in_which_it_alone_moves_phi_by_a_billionth(
    share: float, *, steady: bool
) -> None:
    pull = 1e-14
    recorder = watch(-pull)
    # phi moves by pull t^2/2
    alone = math.sqrt(2.0 * 1e-9 * 0.4 / pull)
    assert 4.0 * alone > 400.0 * PENDULUM
    recorder.advance(share * 4.0 * alone, 0.4)
    assert recorder.ended() is steady


@pytest.mark.parametrize(("share", "steady"), [(0.999, False), (1.001, True)])
def test_what_rests_is_followed_for_2_pi(share: float, *, steady: bool) -> None:
    recorder = watch(None, phi=PAPER_CAN.balancing_angle)
    recorder.advance(share * 2.0 * math.pi, PAPER_CAN.balancing_angle)
    assert recorder.ended() is steady


@pytest.mark.parametrize(
    ("model", "effects", "least"),
    [
        ("rolling", Effects(), 1e-80),
        ("coulomb", Effects(), 1e-80),
        ("general", Effects(linear_damping=1e-6), 1e-26),
    ],
)
def test_a_can_is_flat_where_phi_is_1e_80_or_1e_26_of_one_that_is_only_pushed(
    model: str, effects: Effects, least: float
) -> None:
    falls = Problem(parameters=PAPER_CAN, phi=0.3, bounces=1, effects=effects)
    found = solve(falls, model=model)
    assert found.outcome is Outcome.FELL_FLAT
    # the limit is that of tan(phi/2), and its logarithm a round number
    assert 1.0 < found.at(np.array([found.t_end])).phi[0] / least < 30.0


# --- how fast motions part ------------------------------------------------------------------------


def grown(*distances: float) -> Divergence:
    """Return what distances at the times 0, 1, 2 and so on come to."""
    return _read(np.arange(len(distances), dtype=float), np.log(distances))


@pytest.mark.parametrize(("last", "time"), [(0.1001, 2.0), (0.0999, 2.000087)])
def test_motions_a_tenth_of_a_radian_apart_have_parted(last: float, time: float) -> None:
    found = grown(1e-12, 1e-6, last)
    assert found.parted == pytest.approx(time, rel=1e-6)
    assert (found.parted > 2.0) is (last < 0.1)


def test_a_rate_is_that_of_what_has_grown_tenfold() -> None:
    e = math.e
    # not of the two that have grown by less, which fall otherwise
    assert grown(1e-12, 0.99e-11, 1.01e-11, 1.01e-11 * e).rate == pytest.approx(1.0)
    assert grown(1e-12, 0.98e-11, 0.99e-11).rate == 0.0
    assert grown(1e-12, 0.98e-11, 0.99e-11).parted == math.inf


@pytest.mark.parametrize(("last", "chaotic"), [(0.99e-8, False), (1.01e-8, True)])
def test_it_takes_growth_by_ten_thousand_to_be_chaotic(last: float, *, chaotic: bool) -> None:
    found = grown(1e-12, 1e-10, last)
    assert found.growth == pytest.approx(last / 1e-12)
    assert found.chaotic is chaotic


def test_no_distance_beyond_exp_600_is_said() -> None:
    found = _read(np.array([0.0, 1.0, 2.0]), np.array([-20.0, 599.0, 1e4]))
    assert np.log(found.distance) == pytest.approx([-20.0, 599.0, 600.0])
    assert math.log(found.growth) == pytest.approx(600.0 + math.log(1e12))


@pytest.mark.parametrize(("phi", "first"), [(0.3, 3e-13), (1.1e-3, 1.1e-15), (5e-4, 1e-15)])
def test_releases_are_disturbed_by_one_part_in_1e12_of_a_thousandth_at_least(
    phi: float, first: float
) -> None:
    release = Problem(parameters=PAPER_CAN, phi=phi, psi_dot=1e-3, duration=1e-3)
    assert divergence(release).distance[0] == pytest.approx(first, rel=1e-6, abs=0)


# --- sampling, tolerances -------------------------------------------------------------------------


@dataclass(frozen=True)
class Turning:
    """A path on which one angle grows at a rate of 1."""

    angle: str

    def at(self, times: Floats) -> States:
        names = ("phi", "phi_dot", "psi", "psi_dot", "theta", "theta_dot", "spin")
        fields = dict.fromkeys(names, np.zeros_like(times))
        fields[self.angle] = times
        return States(**fields)


@pytest.mark.parametrize("angle", ["phi", "psi", "theta"])
def test_no_angle_changes_by_more_than_0_02_between_samples(angle: str) -> None:
    path = Turning(angle)
    assert grid_by_angle(path, np.array([0.0, 0.0199])).size == 2
    assert grid_by_angle(path, np.array([0.0, 0.0201])).size == 3
    steps = np.diff(grid_by_angle(path, np.array([0.0, 3.0])))
    assert 0.01 < steps.max() <= 0.02


def test_nor_is_a_step_longer_than_a_quarter_of_the_time_of_the_can() -> None:
    path = Turning("spin")
    assert grid_by_angle(path, np.array([0.0, 0.249])).size == 2
    assert grid_by_angle(path, np.array([0.0, 0.251])).size == 3


def test_the_tolerance_of_scipy_is_1e_12_unless_it_is_said() -> None:
    short = Problem(parameters=PAPER_CAN, phi=0.4, psi_dot=0.12, theta_dot=-0.06, duration=0.1)
    default = solve(short, model="rolling", method="DOP853")
    said = solve(short, model="rolling", method="DOP853", rtol=1e-12)
    assert (default.steps, default.evaluations) == (said.steps, said.evaluations)
    at = np.array([0.1])
    assert default.at(at).phi[0] == said.at(at).phi[0]
    assert (
        default.at(at).phi[0]
        != solve(short, model="rolling", method="DOP853", rtol=2e-12).at(at).phi[0]
    )
