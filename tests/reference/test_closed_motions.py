"""Motions with a closed form: the pendulum, steady rolling, the frictionless can."""

import math
from typing import Any

import numpy as np
import pytest

from reference import PAPER_CAN, Outcome, ParameterError, Parameters, Problem, solve
from reference.asymptotic.expansions import paper_constants
from reference.equations import steady_motion
from reference.equations.energy import energy
from reference.equations.frictionless import (
    axial_momentum,
    leading_turn_without_friction,
    vertical_momentum,
)
from reference.equations.nonholonomic import nutation_acceleration
from reference.equations.pendulum import planar_motion
from reference.equations.reaction_force import friction_ratio
from reference.integrable.frobenius import (
    can_constants,
    first_integrals,
    precession_and_spin,
    series_of,
)
from reference.problem.states import States, initial_states

CANS = [
    PAPER_CAN,
    Parameters(a=0.25, c=0.5, h=0.05),
    Parameters(a=5.6, c=0.5, h=4.0),
    Parameters(a=0.6, c=1.0, h=0.5),
]
UNIT = math.sqrt(0.037 / 9.81)
PAPER = Problem(
    parameters=PAPER_CAN,
    phi=math.pi / 100,
    psi_dot=0.1001 * UNIT,
    theta_dot=-0.1 * UNIT,
    bounces=2,
)


def one_state(phi: float, psi_dot: float, theta_dot: float) -> States:
    return initial_states(
        Problem(parameters=PAPER_CAN, phi=phi, psi_dot=psi_dot, theta_dot=theta_dot, bounces=1)
    )


@pytest.mark.parametrize(
    "release",
    [
        {"phi": 0.3},
        {"phi": 0.8},
        {"phi": 0.3, "phi_dot": 1.0},
        {"phi": 0.3, "phi_dot": 0.1},
        {"phi": 0.8, "phi_dot": -0.05},
        {"phi": 0.8, "phi_dot": -1.0},
    ],
)
def test_pendulum_is_rolling_without_turning(release: dict[str, Any]) -> None:
    """The closed form against the integrator, all the way to the plane."""
    problem = Problem(parameters=PAPER_CAN, bounces=1, **release)
    closed, rolling = solve(problem, model="pendulum"), solve(problem, model="rolling")
    assert closed.outcome is rolling.outcome
    assert closed.t_end == pytest.approx(rolling.t_end, rel=1e-13, abs=0)
    times = np.linspace(0, 0.999 * closed.t_end, 50)
    # elliptic functions and an integration, each good to a few tens of eps
    assert np.abs(closed.at(times).phi - rolling.at(times).phi).max() < 1e-13
    assert np.abs(closed.at(times).phi_dot - rolling.at(times).phi_dot).max() < 1e-13


def test_pendulum_times_scale_with_the_fourth_root() -> None:
    """The paper prints sqrt((h^2 + 1)/(a_p + 1)); near balance the can falls like exp(w t)."""
    motion = planar_motion(PAPER_CAN, PAPER_CAN.balancing_angle - 1e-6)
    phi, phi_dot = motion.nutation(np.array([8.0]))
    rate = phi_dot[0] / (phi[0] - PAPER_CAN.balancing_angle)
    expected = (1 + PAPER_CAN.h**2) ** 0.25 / math.sqrt(PAPER_CAN.pendulum_inertia)
    # tanh(w t) and the third order of the sine
    assert rate == pytest.approx(expected, rel=1e-4)


@pytest.mark.parametrize("can", CANS)
def test_steady_motions_stay(can: Parameters) -> None:
    """The force vanishes on every steady motion; its slope along the branch is the eigenvalue."""
    series = series_of(can)
    for phi in (0.3 * can.balancing_angle, 0.9 * can.balancing_angle):
        Psi = 0.7
        Theta = steady_motion.steady_rotation(can, phi, Psi)
        at = np.array([phi])
        spin = np.array([Psi + Theta])
        assert abs(nutation_acceleration(at, np.array([Psi]), spin, can)[0]) < 1e-14
        b = np.sin(phi) ** 2 * Psi
        step = 1e-5

        def force(x: float, b: float = b, spin: float = Psi + Theta, phi: float = phi) -> float:
            K, B = first_integrals(
                can_constants(can),
                series,
                np.array([phi]),
                np.array([b / np.sin(phi) ** 2]),
                np.array([spin]),
            )
            rates = precession_and_spin(can_constants(can), series, np.array([x]), K, B)
            return float(nutation_acceleration(np.array([x]), *rates, can)[0])

        slope = (force(phi + step) - force(phi - step)) / (2 * step)
        # a central difference: step^2 over phi^2, and eps over step
        assert steady_motion.squared_eigenvalue(can, phi, Psi, Theta) == pytest.approx(
            slope, rel=1e-6
        )


@pytest.mark.parametrize("can", CANS)
def test_critical_rolling(can: Parameters) -> None:
    """The eigenvalue vanishes at our critical rate; the paper's has h (h + c_p) for h^2 + c_p."""
    rate, balance = steady_motion.critical_rolling_rate(can), can.balancing_angle
    assert abs(steady_motion.squared_eigenvalue(can, balance, 0.0, rate)) < 1e-13
    printed = math.sqrt(math.sqrt(can.h**2 + 1) / (can.h * can.k * can.c_p * (can.h + can.c_p)))
    assert abs(steady_motion.squared_eigenvalue(can, balance, 0.0, printed)) > 1e-3
    Theta = steady_motion.balanced_rotation(can, 1.3)
    assert steady_motion.steady_rotation(can, balance, 1.3) == pytest.approx(
        Theta, rel=1e-12, abs=0
    )


def test_motion_about_a_centre_at_rest() -> None:
    """S_rest with its sign mended: steady, with the centre still. It exists past balance too."""
    p = PAPER_CAN
    for phi in (0.1, 0.5, 0.9):
        Psi, Theta = steady_motion.rest_rates(p, phi)
        assert steady_motion.steady_rotation(p, phi, Psi) == pytest.approx(Theta, rel=1e-12, abs=0)
        assert steady_motion.circle_radius(p, phi, Psi, Theta) < 1e-15
        assert friction_ratio(one_state(phi, Psi, Theta), p)[0] < 1e-14
    assert p.balancing_angle < 0.9
    with pytest.raises(ParameterError) as refused:
        steady_motion.rest_rates(p, 0.63)
    assert (refused.value.key, refused.value.value) == ("phi", 0.63)


def test_spinning_on_the_side() -> None:
    """The example at phi = pi/2, for a can with h < c_p."""
    rate = math.sqrt(PAPER_CAN.h / (PAPER_CAN.c_p - PAPER_CAN.h))
    assert steady_motion.steady_rotation(PAPER_CAN, math.pi / 2, rate) == pytest.approx(
        rate, rel=1e-13, abs=0
    )


def test_momenta_of_a_bounce() -> None:
    """Where the bounce is hardest a Psi S^2 is all that tells the two momenta apart."""
    solution = solve(PAPER, model="exact")
    bottom = solution.at(solution.minima[:1])
    _, B = paper_constants(bottom, PAPER_CAN)
    apart = vertical_momentum(bottom, PAPER_CAN) - axial_momentum(bottom, PAPER_CAN)
    # to the order of phi_min, times a logarithm
    assert apart[0] == pytest.approx(PAPER_CAN.a * B[0], rel=1e-3)


def test_without_friction() -> None:
    """Both momenta, the energy, and the leading turn of a can whose centre stays put."""
    solution = solve(PAPER, model="frictionless", outputs={"contact_locus"})
    states = solution.at(solution.grid())
    for momentum in (axial_momentum, vertical_momentum):
        values = momentum(states, PAPER_CAN)
        # eps of the terms a Psi S^2 and c (Psi C + Theta), the rates being up to 1e4
        assert np.ptp(values) < 1e-8 * np.abs(values).max()
    # the integrator's 1e-12 a step, over some six hundred steps
    assert np.ptp(energy(states, PAPER_CAN, solution.problem.effects)) < 1e-9
    bounce = solution.bounces[0]
    assert bounce.peak_friction_ratio == 0
    # corrected by the precession outside the bounce, of the order of psi_dot: 3e-3
    assert bounce.angle_of_turn == pytest.approx(leading_turn_without_friction(PAPER_CAN), rel=1e-2)


@pytest.mark.parametrize(
    "model",
    [
        "exact",
        "rolling",
        pytest.param("reduced", marks=pytest.mark.slow),
        "asymptotic",
        "frictionless",
    ],
)
def test_every_model_has_the_same_face(model: str) -> None:
    solution = solve(PAPER, model=model)
    assert solution.outcome is Outcome.FINISHED
    assert len(solution.bounces) == 2
    times = solution.grid()
    assert times[0] == 0
    assert times[-1] == solution.t_end
    states = solution.at(times)
    assert np.abs(np.diff(states.psi)).max() <= 0.02
    assert np.isfinite(energy(states, PAPER_CAN, solution.problem.effects)).all()
