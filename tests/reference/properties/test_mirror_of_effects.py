"""In a mirror a can with effects turns the other way, whether it slips, drills or is held."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from reference import PAPER_CAN, Effects, Gravity, Mass, Problem, solve
from tests.support.examples import examples

# A linear system is rounded otherwise with other signs, and a bounce amplifies that a hundredfold;
# where laws change it does so anew.
ALLOWED = 1e-10


def plane(across: float) -> Gravity:
    """Return a plane that is tilted along x and y, and shaken along both."""
    down = math.sqrt(1.0 - 0.03**2 - across**2)
    return Gravity(constant=(0.03, across, -down), amplitude=(0.02, across, 0.05), rate=3.0)


EVERYTHING = (
    (Effects(mu=0.2), Effects(mu=0.2)),
    (Effects(rolling_resistance=1e-3), Effects(rolling_resistance=1e-3)),
    (
        Effects(mu=0.3, drilling=0.01, rolling_resistance=2e-3, rim=0.05),
        Effects(mu=0.3, drilling=0.01, rolling_resistance=2e-3, rim=0.05),
    ),
    (Effects(mass=Mass(share=0.05, x=0.3, y=0.2)), Effects(mass=Mass(share=0.05, x=0.3, y=-0.2))),
    (
        Effects(mu=0.3, angular_damping=0.02, gravity=plane(0.04)),
        Effects(mu=0.3, angular_damping=0.02, gravity=plane(-0.04)),
    ),
)


@settings(max_examples=examples(1 / 8))
@given(
    pair=st.sampled_from(EVERYTHING),
    phi=st.floats(0.15, 0.5),
    phi_dot=st.floats(-0.2, 0.2),
    psi_dot=st.floats(0.03, 0.3),
    share=st.floats(-1.5, 1.5),
)
def test_in_a_mirror_everything_turns_the_other_way(
    pair: tuple[Effects, Effects], phi: float, phi_dot: float, psi_dot: float, share: float
) -> None:
    one, other = (
        Problem(
            parameters=PAPER_CAN,
            phi=phi,
            phi_dot=phi_dot,
            psi_dot=sign * psi_dot,
            theta_dot=sign * share * psi_dot,
            duration=2.5,
            effects=effects,
        )
        for sign, effects in zip((1.0, -1.0), pair, strict=True)
    )
    own, seen = solve(one), solve(other)
    assert seen.outcome is own.outcome
    assert seen.t_end == pytest.approx(own.t_end, rel=ALLOWED)
    times = np.linspace(0.0, 0.99 * own.t_end, 30)
    here, there = own.at(times), seen.at(times)
    assert np.abs(here.phi - there.phi).max() < ALLOWED
    assert np.abs(here.psi + there.psi).max() < ALLOWED
    assert np.abs(here.theta + there.theta).max() < ALLOWED
    assert [phase.kind for phase in own.phases] == [phase.kind for phase in seen.phases]


def test_a_can_held_at_rest_is_its_own_mirror_image() -> None:
    held = Problem(
        parameters=PAPER_CAN,
        phi=PAPER_CAN.balancing_angle,
        duration=1.0,
        effects=Effects(rolling_resistance=1e-3),
    )
    turned = solve(replace(held, psi=1.0, theta=2.0)).at(np.array([1.0]))
    assert (turned.psi[0], turned.theta[0], turned.phi[0]) == pytest.approx((1.0, 2.0, held.phi))
