"""The closed form of a planar fall that is short: its time is no difference of near numbers."""

import pytest
from mpmath import mp, mpf, quad, sqrt

from reference import PAPER_CAN, Problem, solve


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


@pytest.mark.parametrize("phi", [1e-9, 1e-5, 1e-2])
@pytest.mark.parametrize("share", [0.0, 1e-3, 0.5])
def test_a_short_fall_takes_as_long_as_in_forty_digits(phi: float, share: float) -> None:
    with mp.workdps(60):
        whole = sqrt(2 * (height(mpf(phi)) - height(mpf(0))) / PAPER_CAN.pendulum_inertia)
        rate = -share * float(whole)  # downwards, a share of what the fall gives
        expected = fall(mpf(phi), mpf(rate))
    found = solve(Problem(parameters=PAPER_CAN, phi=phi, phi_dot=rate, bounces=1), model="pendulum")
    assert found.t_end == pytest.approx(float(expected), rel=1e-14)
