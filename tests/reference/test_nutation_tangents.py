"""Derivatives of phi at fixed times, against differences of whole motions."""

from dataclasses import replace

import numpy as np
import pytest

from reference import PAPER_CAN, Effects, Gravity, Problem, solve
from reference.analysis.nutation_tangents import nutation_tangents

TIMES = np.array([2.0, 6.0, 11.0])


def problem(psi_dot: float) -> Problem:
    """Return a can on a tilted plane, through two bounces."""
    gravity = Gravity(constant=(np.sin(0.05), 0.0, -np.cos(0.05)))
    return Problem(
        parameters=PAPER_CAN,
        phi=0.3,
        psi_dot=psi_dot,
        theta_dot=-0.06,
        effects=Effects(gravity=gravity),
        duration=float(TIMES[-1]) + 1.0,
    )


def test_phi_at_a_time_has_the_derivative_of_its_differences() -> None:
    by, rates, slopes = nutation_tangents(problem(0.12), TIMES)

    def phi(steps: int) -> np.ndarray:
        return np.asarray(solve(problem(0.12 + 1e-5 * steps), model="general").at(TIMES).phi)

    differences = (8.0 * (phi(1) - phi(-1)) - (phi(2) - phi(-2))) / 12e-5
    assert slopes[:, by.index("psi_dot")] == pytest.approx(differences, rel=1e-6)
    at = solve(problem(0.12), model="general").at(TIMES)
    assert rates == pytest.approx(at.phi_dot, rel=1e-9)


def test_a_motion_that_has_ended_has_none() -> None:
    # it falls over: all that is released beyond the balanced can
    over = replace(problem(0.0), phi=PAPER_CAN.balancing_angle + 0.3, theta_dot=0.0)
    _, rates, slopes = nutation_tangents(over, np.array([0.1, 60.0]))
    assert np.isfinite(rates[0])
    assert np.isnan(rates[1])
    assert np.isnan(slopes[1]).all()
