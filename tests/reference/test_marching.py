"""The default integrator: its equations, conservation, cost, and scipy beside it."""

import math

import numpy as np
import pytest

from reference import PAPER_CAN, Outcome, Problem, solve
from reference.equations.energy import energy
from reference.equations.nonholonomic import accelerations
from reference.equations.regularised import regular_equations, vector_field
from reference.integrable.frobenius import can_constants, first_integrals, series_of
from reference.numerics.chebyshev import (
    clenshaw,
    integrator,
    points,
    to_coefficients,
)
from reference.problem.states import States
from reference.smooth.scipy_ivp import SCIPY_METHODS, step_in_time
from reference.smooth.stepping import integrate

UNIT = math.sqrt(0.037 / 9.81)


def paper_release(bounces: int) -> Problem:
    return Problem(
        parameters=PAPER_CAN,
        phi=math.pi / 100,
        psi_dot=0.1001 * UNIT,
        theta_dot=-0.1 * UNIT,
        bounces=bounces,
    )


def test_regular_equations_are_the_rolling_equations() -> None:
    """The chain rule from (phi, Phi, Psi, s) in t to (T, Phi, b, s) in sigma, to a few eps."""
    rng = np.random.default_rng(0)
    phi = rng.uniform(0.01, 1.5, 100)
    Phi, Psi, Theta = rng.normal(size=(3, 100))
    T, S, C = np.tan(phi / 2), np.sin(phi), np.cos(phi)
    state = States(
        phi=phi, phi_dot=Phi, psi=phi, psi_dot=Psi, theta=phi, theta_dot=Theta, spin=Psi + Theta
    )
    phi_dd, psi_dd, theta_dd = accelerations(state, PAPER_CAN)
    rise = phi - 0.7
    rate = vector_field(
        regular_equations(PAPER_CAN, 0.7), np.stack([T, Phi, S**2 * Psi, Psi + Theta, rise])
    )
    expected = np.stack(
        [
            S * Phi * (1 + T**2) / 2,
            S * phi_dd,
            S * (2 * S * C * Phi * Psi + S**2 * psi_dd),
            S * (psi_dd + theta_dd),
            S * Phi,
        ]
    )
    size = 1 + np.abs(Psi) + np.abs(Theta) + np.abs(Phi)
    assert (np.abs(rate - expected) <= 32 * np.finfo(float).eps * size**2).all()


def test_chebyshev_matrices() -> None:
    x = points(24)
    c = to_coefficients(24) @ np.exp(x)
    eps = np.finfo(float).eps
    assert np.abs(integrator(24) @ np.exp(x) - (np.exp(x) - np.exp(-1))).max() < 16 * eps
    at = np.array([-0.7, 0.3])
    assert np.abs(clenshaw(c, at) - np.exp(at)).max() < 16 * eps


@pytest.mark.parametrize("method", ["half-period", "picard-chebyshev"])
@pytest.mark.parametrize("count", [0, 1, 40, 129, 2_100, 20_000])
def test_a_state_is_the_same_whatever_the_others_are(method: str, count: int) -> None:
    # some instants go by cosines, many by a recurrence, block after block
    solution = solve(paper_release(2), model="rolling", method=method)
    times = np.random.default_rng(count).uniform(0.0, solution.t_end, count)
    together = solution.at(times)
    assert together.psi.shape == (count,)
    for place in range(0, count, max(count // 40, 1)):
        alone = solution.at(times[place])
        assert together.psi[place] == pytest.approx(alone.psi[0], rel=0.0, abs=1e-12)
        assert together.phi[place] == pytest.approx(alone.phi[0], rel=1e-12)


@pytest.mark.slow
def test_a_thousand_bounces_conserve() -> None:
    """Energy and both first integrals, each relative to its own size."""
    run = integrate(paper_release(1000), locus=False)
    assert run.track.minima.size == 1000
    _, states = run.path.nodes()
    E = energy(states, PAPER_CAN)
    assert np.ptp(E) < 1e-12
    K, B = first_integrals(
        can_constants(PAPER_CAN), series_of(PAPER_CAN), states.phi, states.psi_dot, states.spin
    )
    assert np.ptp(B) < 1e-12 * np.abs(B).max()
    assert np.ptp(K) < 1e-12 * np.abs(K).max()


def test_work_does_not_grow_with_the_hardness() -> None:
    """A bounce 1e9 times harder takes only the logarithm of that longer."""
    soft, hard = (
        integrate(Problem(parameters=PAPER_CAN, phi=0.3, psi_dot=rate, bounces=1), locus=False)
        for rate in (1e-3, 1e-12)
    )
    # down and up again through ln(1e9) e-folds of nutation, 2.7 of them a step
    assert hard.steps <= soft.steps + 2 * math.log(1e9) / 2.7 + 2
    assert hard.track.extrema.phi[1] < 1e-11


def test_later_bounces_cost_less_than_the_first() -> None:
    """The steps of one bounce guess those of the next: a handful of evaluations each."""
    once, often = (
        integrate(paper_release(1), locus=False),
        integrate(paper_release(21), locus=False),
    )
    assert (often.evaluations - once.evaluations) / 20 < once.evaluations / 2


@pytest.mark.parametrize("method", sorted(SCIPY_METHODS))
def test_scipy_methods_agree(method: str) -> None:
    """Each to what its tolerance promises, with room for the steps it takes."""
    problem = Problem(parameters=PAPER_CAN, phi=0.4, psi_dot=0.3, theta_dot=-0.1, bounces=1)
    rtol = {"RK23": 1e-6, "BDF": 1e-6, "Radau": 1e-7}.get(method, 1e-9)
    ours, theirs = solve(problem), solve(problem, model="rolling", method=method, rtol=rtol)
    assert theirs.method == method
    assert theirs.bounces[0].angle_of_turn == pytest.approx(
        ours.bounces[0].angle_of_turn, rel=2000 * rtol
    )


def test_tolerance_is_what_was_asked_for() -> None:
    """A hundred times tighter, at least ten times closer."""
    problem = paper_release(1)
    truth = solve(problem, model="exact").bounces[0].angle_of_turn
    errors = []
    for rtol in (1e-6, 1e-8, 1e-10):
        run = step_in_time(problem, method="DOP853", rtol=rtol, locus=False)
        turn = run.track.extrema.psi[-1] - run.track.extrema.psi[0]
        errors.append(abs(turn - truth))
    assert errors[1] < errors[0] / 10
    assert errors[2] < errors[1] / 10


@pytest.mark.parametrize("duration", [0.01, 0.5, 0.504743, 3.3])
def test_duration_is_met_exactly(duration: float) -> None:
    problem = Problem(
        parameters=PAPER_CAN, phi=math.pi / 100, psi_dot=6e-3, theta_dot=-5.9e-3, duration=duration
    )
    for model in ("exact", "rolling"):
        solution = solve(problem, model=model)
        assert solution.outcome is Outcome.FINISHED
        assert solution.t_end == pytest.approx(duration, rel=1e-15, abs=0)
        assert np.isfinite(solution.at(duration).psi).all()
