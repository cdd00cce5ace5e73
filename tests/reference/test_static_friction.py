"""Static above kinetic friction: the rim sticks up to one coefficient, and slips with the other."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from reference import PAPER_CAN, Effects, Parameters, Problem, examine, solve
from reference.equations.contact_laws import Kind
from tests.support import free_body

STUCK, SLIPS = 0.35, 0.3
ROCK = Problem(
    parameters=PAPER_CAN,
    phi=0.3,
    psi_dot=0.25,
    theta_dot=-0.1,
    duration=4.0,
    effects=Effects(mu=SLIPS, mu_static=STUCK),
)


@pytest.mark.parametrize("model", ["coulomb", "general"])
def test_it_sticks_up_to_one_coefficient_and_slips_with_the_other(model: str) -> None:
    found = solve(ROCK, model=model)
    kinds = [phase.kind for phase in found.phases]
    assert kinds[:2] == [Kind.STICK, Kind.SLIP]
    onset = found.phases[0].end
    before = found.at(np.append(np.linspace(0.0, onset, 200)[:-1], onset - 1e-9)).force
    assert before is not None
    ratio = np.hypot(before[:, 0], before[:, 1]) / before[:, 2]
    # a nanosecond before, and held up to 2e-9 beyond the cone
    assert ratio.max() == pytest.approx(STUCK, rel=1e-7)
    for phase in found.phases:
        inside = np.linspace(phase.start, phase.end, 12)[1:-1]
        force = found.at(inside).force
        assert force is not None
        ratio = np.hypot(force[:, 0], force[:, 1]) / force[:, 2]
        if phase.kind is Kind.SLIP:
            assert ratio == pytest.approx(SLIPS, rel=1e-12)
        else:
            assert ratio.max() <= STUCK * (1 + 1e-8)
    assert not [f for f in examine(found, found.grid()).findings if "sticks" in f.sentence]


def test_both_models_move_the_same() -> None:
    one, other = solve(ROCK, model="coulomb"), solve(ROCK, model="general")
    assert one.t_end == pytest.approx(other.t_end, rel=1e-12)
    times = np.linspace(0.0, one.t_end, 50)
    assert np.abs(one.at(times).phi - other.at(times).phi).max() < 1e-11


def test_it_is_later_to_slip_than_with_one_coefficient() -> None:
    one = solve(replace(ROCK, effects=Effects(mu=SLIPS)))
    assert one.phases[0].end < solve(ROCK).phases[0].end


def test_equal_coefficients_are_one_to_the_bit_and_near_ones_near() -> None:
    times = np.linspace(0.0, 2.0, 20)
    plain = solve(replace(ROCK, effects=Effects(mu=SLIPS))).at(times).phi
    same = solve(replace(ROCK, effects=Effects(mu=SLIPS, mu_static=SLIPS))).at(times).phi
    assert (plain == same).all()

    def change(by: float) -> float:
        effects = Effects(mu=SLIPS, mu_static=SLIPS * (1 + by))
        moved = solve(replace(ROCK, effects=effects)).at(times).phi
        return float(np.abs(moved - plain).max())

    # the first order or better: slip begins later by that share, at next to no speed
    assert change(1e-4) < 0.6 * change(2e-4)


def test_a_body_of_six_degrees_of_freedom_lets_go_and_slips_the_same() -> None:
    """It sticks by three constraints up to one cone, and slips on the height alone with another."""
    ours = solve(ROCK)
    stick, slip = ours.phases[:2]
    tolerance = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-14}

    stuck = solve_ivp(
        lambda _t, y: free_body.accelerated(y, ROCK, None)[0],
        (0.0, stick.end),
        free_body.released(ROCK),
        **tolerance,
    )

    def law(u: np.ndarray, _turning: float) -> tuple[np.ndarray, float]:
        return -SLIPS * u[:2] / np.hypot(*u[:2]), 0.0

    # the direction in which it begins is that of its own acceleration
    start, short = stuck.y[:, -1], 1e-5
    here = free_body.posed(start, PAPER_CAN.h)
    _, plane = free_body.accelerated(start, ROCK, None)
    # held up to 2e-9 beyond the cone
    assert np.hypot(plane[0], plane[1]) == pytest.approx(STUCK * plane[2], rel=1e-8)

    def toward(angle: float) -> np.ndarray:
        return np.array([np.cos(angle), np.sin(angle), 0.0])

    def aside(angle: float) -> float:
        rates, _ = free_body.accelerated(start, ROCK, law, toward(angle))
        gained = rates[7:10] + np.cross(rates[10:13], here.arm)
        gained = gained + np.cross(start[10:13], here.arm_rate)
        return float(np.cross(toward(angle), gained)[2])

    likely = float(np.arctan2(-plane[1], -plane[0]))
    angle = brentq(aside, likely - 0.1, likely + 0.1, xtol=1e-15)
    rates, _ = free_body.accelerated(start, ROCK, law, toward(angle))
    # by a step of the first order, whose error is of the second order in it
    slipped = solve_ivp(
        lambda _t, y: free_body.accelerated(y, ROCK, law)[0],
        (stick.end + short, slip.end - 0.05),
        start + short * rates,
        **tolerance,
    )
    there = ours.at(slipped.t)
    phi, psi = free_body.angles(slipped.y)
    assert there.slip is not None
    speeds = [np.hypot(*free_body.slip_of(y, PAPER_CAN.h)[:2]) for y in slipped.y.T]
    assert np.abs(phi - there.phi).max() < 1e-9
    assert np.abs(psi - there.psi).max() < 1e-8
    assert np.abs(speeds - np.hypot(*there.slip.T)).max() < 1e-9


def test_a_rim_that_sticks_without_kinetic_friction_is_no_frictionless_one() -> None:
    declared = Effects(mu=0.0, mu_static=0.5)
    found = solve(replace(ROCK, duration=3.0, effects=declared))
    assert found.model == "coulomb"
    assert [phase.kind for phase in found.phases] == [Kind.STICK]
    assert solve(replace(ROCK, duration=3.0)).at(0.5).phi == pytest.approx(found.at(0.5).phi)


def test_the_peak_of_friction_is_where_it_lets_go() -> None:
    """Within a step, and far above all that the rim needed before: it was missed there."""
    can = Parameters(a=0.684, c=0.312, h=1.404)
    effects = Effects(mu=0.0, mu_static=0.443, drilling=0.011, linear_damping=0.00775)
    release = Problem(parameters=can, phi=0.2768, phi_dot=-0.0592, psi_dot=0.2196, bounces=1)
    found = solve(replace(release, theta_dot=1.2106, effects=effects))
    assert [phase.kind for phase in found.phases] == [Kind.STICK, Kind.SLIP]
    times = np.linspace(0.0, found.phases[0].end - 1e-2, 100)
    force = found.at(times).force
    assert force is not None
    assert (np.hypot(force[:, 0], force[:, 1]) / force[:, 2]).max() < 0.3
    assert found.bounces[0].peak_friction_ratio == pytest.approx(0.443, rel=1e-8)
