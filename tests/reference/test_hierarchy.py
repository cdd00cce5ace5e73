"""Each model against the one above it: how fast the difference goes with its small parameter.

Rolling (exact) -> reduced equation -> matched asymptotics -> pendulum. Differences are measured at
several sizes of the small parameter and their observed order is held between bounds.
"""

import math

import numpy as np
import pytest

from reference import PAPER_CAN, Problem, solve
from reference.asymptotic.matched import friction_bound, matched_of
from reference.asymptotic.small_nutation import reduced_of
from reference.equations.pendulum import planar_motion
from reference.integrable.cycle import exact_bounces

SIZES = np.array([0.04, 0.02, 0.01])


def order(sizes: np.ndarray, differences: list[float]) -> float:
    """Slope of the logarithms."""
    return float(np.polyfit(np.log(sizes), np.log(differences), 1)[0])


def release(phi: float, rate: float) -> Problem:
    return Problem(parameters=PAPER_CAN, phi=phi, psi_dot=rate, theta_dot=-0.9 * rate, bounces=1)


def test_reduced_period_is_right_to_first_order_in_the_height() -> None:
    """Dropping h phi beside 1 costs a relative error of the order of phi."""
    differences = []
    for phi in SIZES.tolist():
        problem = release(phi, 1e-3)
        exact = solve(problem).t_end
        reduced = reduced_of(problem).period(phi) * math.sqrt(PAPER_CAN.pendulum_inertia)
        differences.append(abs(reduced / exact - 1))
    assert order(SIZES, differences) == pytest.approx(1.0, abs=0.1)


def test_matched_phi_min_approaches_the_reduced_one() -> None:
    """phi_min = sqrt(epsilon a_p/I) up to the logarithmic terms of the order sqrt(epsilon)."""
    rates = np.array([1e-2, 1e-3, 1e-4])
    differences = []
    for rate in rates.tolist():
        problem = release(0.02, rate)
        bottom = reduced_of(problem).turning_point(0.02)
        differences.append(abs(matched_of(problem).phi_min / bottom - 1))
    # the constant and logarithmic parts of the first correction: order 1, less a logarithm
    assert 0.7 < order(rates, differences) < 1.3


def test_angle_of_turn_approaches_its_limit() -> None:
    """The exact turn tends to pi sqrt((a_p + 1)/a_p) like sqrt(epsilon) log(epsilon)."""
    rates = np.array([1e-3, 1e-5, 1e-7])
    cycles = exact_bounces(
        a=PAPER_CAN.a, c=PAPER_CAN.c, h=PAPER_CAN.h, phi=0.02, psi_dot=rates, theta_dot=-0.9 * rates
    )
    differences = np.abs(cycles.angle_of_turn / (np.pi * PAPER_CAN.turn_ratio) - 1)
    assert 0.7 < order(rates, differences.tolist()) < 1.1


def test_peak_friction_approaches_its_bound() -> None:
    """h/a_p in the limit of a hard bounce, to the order of sqrt(epsilon)."""
    rates = np.array([1e-2, 1e-3, 1e-4])
    differences = []
    for rate in rates.tolist():
        peak = solve(release(0.02, rate)).bounces[0].peak_friction_ratio
        differences.append(abs(peak / friction_bound(PAPER_CAN) - 1))
    assert order(rates, differences) == pytest.approx(1.0, abs=0.2)


def test_period_approaches_two_falls_of_a_pendulum() -> None:
    """Out of the bounce the can is a pendulum; the bounce itself is worth sqrt(epsilon)."""
    rates = np.array([1e-3, 1e-4, 1e-5])
    fall = planar_motion(PAPER_CAN, 0.3).time_at(0.0)
    cycles = exact_bounces(
        a=PAPER_CAN.a, c=PAPER_CAN.c, h=PAPER_CAN.h, phi=0.3, psi_dot=rates, theta_dot=-0.9 * rates
    )
    differences = np.abs(cycles.period / (2 * fall) - 1)
    # nutation lags by the order of epsilon log epsilon, coupled to the spin by sqrt(epsilon)
    assert order(rates, differences.tolist()) > 0.9


def test_composite_solution_is_uniformly_close() -> None:
    """Over a period the composite errs by O(epsilon) + O(phi^2) against the exact motion."""
    differences = []
    for phi in SIZES.tolist():
        problem = release(phi, 1e-3 * phi)
        exact, composite = solve(problem), solve(problem, model="asymptotic")
        share = np.linspace(0, 1, 200)
        here = exact.at(share * exact.t_end).phi
        there = composite.at(share * composite.t_end).phi
        differences.append(float(np.abs(here - there).max() / phi))
    # h phi against 1, once the period is scaled out
    assert order(SIZES, differences) == pytest.approx(1.0, abs=0.15)


@pytest.mark.slow
def test_outer_correction_improves_the_fall() -> None:
    """With its first correction the outer solution errs by epsilon^2 instead of epsilon."""
    errors: dict[bool, list[float]] = {False: [], True: []}
    sizes = np.array([4e-3, 1e-3])
    for rate in sizes.tolist():
        problem = release(0.02, rate)
        matched, reduced = matched_of(problem), solve(problem, model="reduced")
        t = 0.5 * matched.bounce_time
        truth = reduced.at(t * math.sqrt(PAPER_CAN.pendulum_inertia)).phi[0]
        for corrected, out in errors.items():
            out.append(abs(float(matched.outer(np.array([t]), corrected=corrected)[0]) - truth))
    assert order(sizes**2, errors[False]) == pytest.approx(1.0, abs=0.1)
    # the second is of the order epsilon^2 until it meets the integrator's 1e-14
    assert max(errors[True]) < 1e-3 * max(errors[False])
