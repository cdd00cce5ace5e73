"""Steps that follow the motion: the rule itself."""

import math
from collections.abc import Callable

import numpy as np
import pytest

from harness.engines.stepping.schedule import ETA, Adaptive, Fixed, power_of_two
from models import load
from models.kinematics import angular_velocity, quaternion

CAN = load("paper-release").can
UNIT = 0.0614  # s, the can's natural time
PHI_DOT = 2.0  # rad/s, about that of the paper's release before its bounce


def adaptive(*, limit: float = 1.0, eta: float = ETA) -> Adaptive:
    return Adaptive(CAN, largest=1e-4, smallest=1e-10, limit=limit, eta=eta, unit=UNIT)


def state(phi: float, phi_dot: float, psi_dot: float) -> tuple[list[float], list[float]]:
    omega = angular_velocity(phi, 0.3, phi_dot, psi_dot, -psi_dot)
    return quaternion(phi, 0.3, 0.0).tolist(), omega.tolist()


@pytest.mark.parametrize("phi", [0.03, 1e-3, 1e-5])
def test_the_rate_is_that_of_the_tilt_along_its_line(phi: float) -> None:
    psi_dot = 3.0 / phi
    rate = adaptive().rate(*state(phi, -PHI_DOT, psi_dot))
    # the axis' horizontal part is sin phi, not phi: a difference of phi^2, and the spin is smaller
    expected = math.hypot(PHI_DOT / phi, CAN.slowness * psi_dot)
    assert rate == pytest.approx(expected, rel=max(phi**2, 1e-9))


@pytest.mark.parametrize("psi", [0.3, 2.0, -2.5])
def test_the_rate_of_a_can_far_from_flat_heeds_each_direction(psi: float) -> None:
    phi, phi_dot, psi_dot = 0.6, -PHI_DOT, 3.0
    theta_dot = -psi_dot * math.cos(phi)  # no spin about the axis, which would hide the tilt's rate
    omega = angular_velocity(phi, psi, phi_dot, psi_dot, theta_dot)
    rate = adaptive().rate(quaternion(phi, psi, 0.4).tolist(), omega.tolist())
    expected = math.hypot(phi_dot / math.tan(phi), CAN.slowness * psi_dot)
    assert rate == pytest.approx(expected, rel=1e-12)


def test_a_step_moves_the_tilt_by_eta_at_most_and_by_half_of_it_at_least() -> None:
    for phi in np.geomspace(1e-6, 1e-3, 40):
        schedule = adaptive()
        moving = state(float(phi), -PHI_DOT, 0.0)
        stage = schedule.next(*moving)
        assert stage is not None
        share = stage.timestep * schedule.rate(*moving)
        assert ETA / 2.0 < share <= ETA  # down to the next power of two, no further


def test_the_bounds_hold() -> None:
    still = adaptive().next(*state(0.3, 0.0, 0.0))
    hard = adaptive().next(*state(1e-12, -PHI_DOT, 0.0))
    assert still is not None
    assert hard is not None
    assert still.timestep == power_of_two(1e-4)
    assert hard.timestep == power_of_two(1e-10)


def test_times_are_exact_sums_and_end_at_the_limit() -> None:
    schedule, limit = adaptive(limit=0.01), 0.01
    phis = iter(np.geomspace(1e-2, 1e-4, 10_000))
    last, step = -1.0, 0.0
    while (stage := schedule.next(*state(float(next(phis)), -PHI_DOT, 0.0))) is not None:
        assert stage.times[0] == (last + step if last >= 0.0 else 0.0)  # to the bit
        last, step = float(stage.times[-1]), stage.timestep
    assert limit - step <= last <= limit + step


def test_fixed_times_are_multiples() -> None:
    schedule = Fixed(1e-3, 0.01, 4)
    times: list[float] = []
    while (stage := schedule.next((1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0))) is not None:
        times += stage.times.tolist()
    assert times == [n * 1e-3 for n in range(11)]


def steps_to_the_first_look(phi: Callable[[float], float]) -> int:
    """Return the steps of a millisecond that are taken of a fall and a rise before a look."""

    def at(time: float) -> tuple[list[float], list[float]]:
        rate = (phi(time + 1e-6) - phi(time - 1e-6)) / 2e-6
        spin = angular_velocity(phi(time), 0.0, rate, 0.0, 0.0)
        return quaternion(phi(time), 0.0, 0.0).tolist(), spin.tolist()

    schedule, done, on = Fixed(1e-3, 100.0, 64, 64, 16384), 0, True
    while on:
        stage = schedule.next(*at(done * 1e-3))
        assert stage is not None
        done += len(stage.times)
        on = schedule.falls(*at(done * 1e-3))
    return done


def test_a_rise_is_stepped_to_its_end_without_a_look() -> None:
    # it falls for a second, rises for one, and shows in a tenth that it has risen
    end = steps_to_the_first_look(lambda time: 0.2 - 0.19 * (1.0 - abs(1.0 - time)) ** 2)
    assert 2100 < end < 1.02 * 2100


def test_a_can_that_lay_down_is_seen_although_it_still_falls() -> None:
    end = steps_to_the_first_look(lambda time: max(0.2 - 0.4 * time**2, 0.02 - 0.001 * time))
    assert end == 1024


def test_stages_may_grow_to_their_size_without_a_change_of_the_times() -> None:
    schedule = Fixed(1e-3, 0.1, 16, first=3)
    stages = []
    while (stage := schedule.next((1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0))) is not None:
        stages.append(stage.times.tolist())
    assert [len(times) for times in stages] == [3, 12, 16, 16, 16, 16, 16, 6]
    assert [time for times in stages for time in times] == [n * 1e-3 for n in range(101)]
