"""Derivatives of phi at fixed times, against differences of whole motions."""

from dataclasses import replace

import numpy as np
import pytest

from reference import PAPER_CAN, Effects, Gravity, Kind, Mass, Problem, solve
from reference.analysis.nutation_tangents import nutation_tangents
from tests.support.varied import varied

TIMES = np.array([2.0, 6.0, 11.0])
ROCK = Problem(parameters=PAPER_CAN, phi=0.3, psi_dot=0.12, theta_dot=-0.06, duration=5.0)
SLIPPING = replace(ROCK, phi=0.4, slip=(0.1, 0.05), effects=Effects(mu=0.2), duration=0.6)


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


# an ulp beyond the end of the motion, on one machine or another
@pytest.mark.parametrize("end", [0.5, 0.531578947368421, 0.594])
def test_the_last_time_is_not_lost_to_rounding(end: float) -> None:
    _, rates, _ = nutation_tangents(ROCK, np.array([end]))
    assert np.isfinite(rates).all()


def test_a_motion_that_has_ended_has_none() -> None:
    # it falls over: all that is released beyond the balanced can
    over = replace(problem(0.0), phi=PAPER_CAN.balancing_angle + 0.3, theta_dot=0.0)
    _, rates, slopes = nutation_tangents(over, np.array([0.1, 60.0]))
    assert np.isfinite(rates[0])
    assert np.isnan(rates[1])
    assert np.isnan(slopes[1]).all()


@pytest.mark.parametrize(
    ("problem", "names"),
    [
        (replace(ROCK, effects=Effects(drilling=0.01)), ("psi_dot", "theta_dot", "c")),
        (SLIPPING, ("phi", "psi_dot", "slip.mu")),
        (
            replace(
                ROCK,
                effects=Effects(
                    mass=Mass(share=0.1, x=0.3, y=0.1, z=0.2), rim=0.1, linear_damping=0.05
                ),
            ),
            ("point_mass.x", "rim.radius", "damping.linear"),
        ),
    ],
    ids=["turning comes to rest", "slip comes to rest", "mass, rim and damping"],
)
def test_phi_has_the_derivatives_of_its_differences(
    problem: Problem, names: tuple[str, ...]
) -> None:
    """To 1e-8, before and after something comes to rest."""
    assert problem.duration is not None
    times = problem.duration * np.array([0.1, 0.5, 0.99])
    by, _, slopes = nutation_tangents(problem, times)
    step = 3e-5
    for name in names:
        one, two = (
            np.asarray(
                solve(varied(problem, name, k * step), model="general").at(times).phi
                - solve(varied(problem, name, -k * step), model="general").at(times).phi
            )
            for k in (1, 2)
        )
        differences = (8.0 * one - two) / (12.0 * step)
        # one that is nothing yet has the round-off of phi over the step
        known = slopes[:, by.index(name)]
        assert known == pytest.approx(differences, rel=1e-8, abs=1e-9), name


def test_a_rim_that_is_held_beside_a_patch_that_turns() -> None:
    """To 1e-4: a rim that is released with a rate is held the later for it, and so differences."""
    held = replace(
        ROCK,
        phi=0.4,
        psi_dot=0.3,
        theta_dot=0.0,
        effects=Effects(mu=0.3, patch=0.02, contour=0.3),
        duration=0.4,
    )
    times = np.array([0.1, 0.2, 0.4])
    by, _, slopes = nutation_tangents(held, times)
    for name in ("theta_dot", "psi_dot", "slip.patch"):
        ahead, behind = (solve(varied(held, name, h), model="general") for h in (1e-5, -1e-5))
        differences = (ahead.at(times).phi - behind.at(times).phi) / 2e-5
        assert slopes[:, by.index(name)] == pytest.approx(differences, rel=1e-4, abs=1e-9), name


def test_where_a_slip_is_at_its_end_there_are_none() -> None:
    first = solve(SLIPPING, model="general").phases[0]
    assert first.kind is Kind.SLIP
    times = np.array([first.end - 1e-6, first.end - 1e-12, first.end + 1e-6])
    _, rates, slopes = nutation_tangents(SLIPPING, times)
    assert np.isfinite(rates).tolist() == [True, False, True]
    assert np.isfinite(slopes).all(axis=1).tolist() == [True, False, True]
