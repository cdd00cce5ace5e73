"""The closed form of planar falls: their times are no differences of near numbers."""

import numpy as np
import pytest
from mpmath import linspace, mp, mpf, quad, sqrt

from reference import PAPER_CAN, Outcome, Problem, solve
from reference.equations.pendulum import planar_motion


def height(phi: mpf) -> mpf:
    return mp.sin(phi) + PAPER_CAN.h * mp.cos(phi)


def fall(phi: mpf, rate: mpf) -> mpf:
    """Time of a fall to the flat state, by the energy; phi (1 - u^2) takes the root away."""
    inertia = mpf(PAPER_CAN.pendulum_inertia)

    def slowness(u: mpf) -> mpf:
        drop = height(phi) - height(phi * (1 - u * u))
        return 2 * u * phi * sqrt(inertia / (2 * drop + inertia * rate * rate))

    steps = [0, *(mpf(10) ** -n for n in range(8, 0, -1)), 1]
    return quad(slowness, steps, method="gauss-legendre")


@pytest.mark.slow
@pytest.mark.parametrize("phi", [1e-9, 1e-5, 1e-2])
@pytest.mark.parametrize("share", [0.0, 1e-3, 0.5])
def test_a_short_fall_takes_as_long_as_in_forty_digits(phi: float, share: float) -> None:
    with mp.workdps(60):
        whole = sqrt(2 * (height(mpf(phi)) - height(mpf(0))) / PAPER_CAN.pendulum_inertia)
        rate = -share * float(whole)  # downwards, a share of what the fall gives
        expected = fall(mpf(phi), mpf(rate))
    found = solve(Problem(parameters=PAPER_CAN, phi=phi, phi_dot=rate, bounces=1), model="pendulum")
    assert found.t_end == pytest.approx(float(expected), rel=1e-14, abs=0)


def passage(start: float, rate: float, end: float) -> mpf:
    """Time from release to `end` of a motion that does not stop, by the energy."""
    inertia = mpf(PAPER_CAN.pendulum_inertia)
    top = mp.atan(1 / mpf(PAPER_CAN.h))

    def slowness(phi: mpf) -> mpf:
        drop = height(mpf(start)) - height(phi)
        return 1 / sqrt(2 * drop / inertia + mpf(rate) ** 2)

    low, high = min(mpf(start), mpf(end)), max(mpf(start), mpf(end))
    # it lingers at the top, and nearer the slower
    near = [top + side * mpf(10) ** -n for side in (-1, 1) for n in range(1, 12)]
    steps = sorted({low, high, *linspace(low, high, 9), *(x for x in near if low < x < high)})
    return quad(slowness, steps, method="gauss-legendre")


@pytest.mark.slow
@pytest.mark.parametrize("start", [0.3, PAPER_CAN.balancing_angle - 1e-3, 1.2])
@pytest.mark.parametrize("margin", [1e-12, 1e-6, 0.3, 30.0])
def test_over_the_top_it_takes_as_long_as_in_forty_digits(start: float, margin: float) -> None:
    """Thrown just hard enough, or harder by more: what is left at the top is `margin` of it."""
    with mp.workdps(60):
        top = mp.atan(1 / mpf(PAPER_CAN.h))
        needed = sqrt(2 * (height(top) - height(mpf(start))) / PAPER_CAN.pendulum_inertia)
        rate = float(needed * sqrt(1 + mpf(margin))) * (1 if start < top else -1)
        end = mp.pi / 2 if start < top else mpf(0)
        expected = passage(start, rate, end)
        # what an ulp of the release does, which decides the time at the top
        near = ((start, np.nextafter(rate, np.inf)), (np.nextafter(start, np.inf), rate))
        felt = sum(abs(passage(phi, phi_dot, end) - expected) for phi, phi_dot in near)
    problem = Problem(parameters=PAPER_CAN, phi=start, phi_dot=rate, bounces=1)
    found = solve(problem, model="pendulum")
    assert found.outcome is (Outcome.OVERTURNED if start < top else Outcome.FELL_FLAT)
    assert found.t_end == pytest.approx(float(expected), rel=1e-14, abs=float(4 * felt))


@pytest.mark.parametrize("share", [0.02, 0.3, 0.9])
@pytest.mark.parametrize(
    ("rate", "start", "end"), [(1.0, PAPER_CAN.balancing_angle, 1.5), (-0.1, 0.3, 0.01)]
)
def test_the_nutation_at_the_time_of_a_nutation_is_that(
    share: float, rate: float, start: float, end: float
) -> None:
    """Over the top, and turning back on its own side."""
    motion = planar_motion(PAPER_CAN, 0.3, rate)
    assert (motion.constant < 0) is (rate > 0)
    phi = start + share * (end - start)
    found, found_rate = motion.nutation(np.array([motion.time_at(phi)]))
    assert found[0] == pytest.approx(phi, rel=1e-13, abs=0)
    assert found_rate[0] * rate > 0


def from_rest(start: float, end: mpf) -> mpf:
    """Time from rest beside the top, by the energy; lean = start cosh(x) takes its root away."""
    inertia = mpf(PAPER_CAN.pendulum_inertia)
    top = mp.atan(1 / mpf(PAPER_CAN.h))
    lean, size = mpf(start) - top, sqrt(1 + mpf(PAPER_CAN.h) ** 2)

    def slowness(x: mpf) -> mpf:
        reached = lean * mp.cosh(x)
        drop = size * 2 * mp.sin((reached - lean) / 2) * mp.sin((reached + lean) / 2)
        return lean * mp.sinh(x) / sqrt(2 * drop / inertia) * (1 if lean > 0 else -1)

    return quad(slowness, linspace(0, mp.acosh((end - top) / lean), 20), method="gauss-legendre")


@pytest.mark.parametrize("off", [1e-14, -1e-14, 1e-12, -1e-12, 1e-9, -1e-9, 1e-5, -1e-5, 0.1, -0.1])
def test_beside_balance_a_fall_takes_as_long_as_in_forty_digits(off: float) -> None:
    start = PAPER_CAN.balancing_angle + off
    with mp.workdps(60):
        expected = from_rest(start, mpf(0) if off < 0 else mp.pi / 2)
    problem = Problem(parameters=PAPER_CAN, phi=start, bounces=1)
    for model in ("pendulum", "rolling"):
        assert solve(problem, model=model).t_end == pytest.approx(float(expected), rel=1e-14, abs=0)


@pytest.mark.parametrize("model", ["pendulum", "rolling"])
def test_a_balanced_can_stands_as_long_as_its_last_digit_lets_it(model: str) -> None:
    balance = PAPER_CAN.balancing_angle
    asked = Problem(parameters=PAPER_CAN, phi=balance, bounces=1)
    assert solve(asked, model=model).outcome is Outcome.STEADY
    stands = Problem(parameters=PAPER_CAN, phi=balance, duration=50.0)
    assert solve(stands, model=model).outcome is Outcome.FINISHED
    with mp.workdps(60):
        falls = from_rest(balance, mpf(0))
    found = solve(Problem(parameters=PAPER_CAN, phi=balance, duration=60.0), model=model)
    assert found.outcome is Outcome.FELL_FLAT
    assert found.t_end == pytest.approx(float(falls), rel=1e-14, abs=0)
