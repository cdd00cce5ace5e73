"""The full equations solved: the paper's release, conservation, reversal, endings, bad input."""

import math
from typing import Any

import numpy as np
import pytest

from reference import (
    PAPER_CAN,
    Outcome,
    ParameterError,
    Parameters,
    Problem,
    ProblemError,
    RefusedError,
    Solution,
    SolverError,
    solve,
)
from reference.equations.energy import energy
from reference.equations.reaction_force import centre_position, centre_velocity, locus_velocity

UNIT = math.sqrt(0.037 / 9.81)  # sqrt(R/g) in s: the paper's rates are per second
SCIPY: dict[str, Any] = {"model": "rolling", "method": "DOP853"}


def paper_release(**horizon: Any) -> Problem:
    return Problem(
        parameters=PAPER_CAN,
        phi=math.pi / 100,
        psi_dot=0.1001 * UNIT,
        theta_dot=-0.1 * UNIT,
        **horizon,
    )


@pytest.fixture(scope="module")
def paper() -> Solution:
    return solve(paper_release(bounces=2), outputs={"contact_locus"}, **SCIPY)


def test_papers_release(paper: Solution) -> None:
    """Fifteen digits known beforehand; rtol 1e-12 over 500 steps keeps 1e-10 of them."""
    assert paper.outcome is Outcome.FINISHED
    assert len(paper.bounces) == 2
    for bounce in paper.bounces:
        assert math.degrees(bounce.angle_of_turn) == pytest.approx(209.363400462452, rel=1e-10)
        assert bounce.phi_min == pytest.approx(4.21737156919165646e-5, rel=1e-10, abs=0)
        assert bounce.peak_psi_dot == pytest.approx(3448.76206574298, rel=1e-10)
        # printed to three digits
        assert bounce.peak_friction_ratio == pytest.approx(0.508, abs=5e-4)
    assert paper.t_end == pytest.approx(2 * 1.00948780968203677, rel=1e-10)


def test_grid_is_dense_by_angle_and_holds_the_extrema(paper: Solution) -> None:
    times = paper.grid()
    states = paper.at(times)
    for angle in (states.phi, states.psi, states.theta):
        assert np.abs(np.diff(angle)).max() <= 0.02
    landmarks = [0.0, paper.t_end, *paper.maxima, *paper.minima]
    assert set(landmarks) <= set(times.tolist())
    assert (np.diff(times) > 0).all()


def test_energy_is_conserved(paper: Solution) -> None:
    states = paper.at(paper.grid())
    # rtol 1e-12 a step, 500 steps, energy 1.5 of which rates up to 3.4e3 cancel
    assert np.ptp(energy(states, PAPER_CAN)) < 1e-10


def test_locus_and_centre_move_together(paper: Solution) -> None:
    """Central differences of positions against velocities, where the motion is slow."""
    step = 1e-4
    times = np.linspace(0.1, 0.35, 20)
    before, now, after = (paper.at(times + d) for d in (-step, 0.0, step))
    assert before.x is not None
    assert before.y is not None
    assert after.x is not None
    assert after.y is not None
    locus = np.stack([after.x - before.x, after.y - before.y], axis=1) / (2 * step)
    centre = (centre_position(after, PAPER_CAN) - centre_position(before, PAPER_CAN)) / (2 * step)
    # a central difference errs by step^2/6 of a third derivative of order one, and rounding/step
    assert np.abs(locus - locus_velocity(now)).max() < 1e-7
    assert np.abs(centre - centre_velocity(now, PAPER_CAN)).max() < 1e-7
    start = centre_position(paper.at(0.0), PAPER_CAN)[0]
    assert np.abs(start[:2]).max() < 1e-15


def test_reversed_motion_returns() -> None:
    forward = solve(paper_release(duration=0.7), **SCIPY)
    last = forward.at(0.7)
    back = solve(
        Problem(
            parameters=PAPER_CAN,
            phi=float(last.phi[0]),
            psi=float(last.psi[0]),
            theta=float(last.theta[0]),
            phi_dot=-float(last.phi_dot[0]),
            psi_dot=-float(last.psi_dot[0]),
            theta_dot=-float(last.theta_dot[0]),
            duration=0.7,
        ),
        **SCIPY,
    )
    end = back.at(0.7)
    # through the bounce, where the period depends on rates that are sums of large numbers
    assert end.phi[0] == pytest.approx(math.pi / 100, abs=1e-10)
    assert end.psi[0] == pytest.approx(0.0, abs=1e-8)


def test_release_still_rising_has_its_first_maximum_later() -> None:
    problem = Problem(parameters=PAPER_CAN, phi=0.3, phi_dot=0.1, psi_dot=0.05, bounces=1)
    solution = solve(problem, **SCIPY)
    assert solution.maxima.size == 2
    assert solution.maxima[0] > 0
    falling = solve(
        Problem(parameters=PAPER_CAN, phi=0.3, phi_dot=-0.1, psi_dot=0.05, bounces=1), **SCIPY
    )
    assert falling.maxima[0] == 0


@pytest.mark.parametrize(
    ("release", "outcome"),
    [
        ({"phi": 0.4}, Outcome.FELL_FLAT),
        ({"phi": 0.8}, Outcome.OVERTURNED),
        ({"phi": 0.3, "phi_dot": 3.0}, Outcome.OVERTURNED),
        ({"phi": PAPER_CAN.balancing_angle, "theta_dot": 4.0}, Outcome.STEADY),
    ],
)
def test_releases_that_never_bounce(release: dict[str, Any], outcome: Outcome) -> None:
    solution = solve(Problem(parameters=PAPER_CAN, bounces=1, **release), **SCIPY)
    assert solution.outcome is outcome
    assert solution.bounces == ()
    states = solution.at(solution.grid())
    assert np.isfinite(np.stack([states.phi, states.psi, states.theta, states.psi_dot])).all()


@pytest.mark.parametrize(("key", "value"), [("a", -1), ("c", math.nan), ("c", 2.1), ("h", 0)])
def test_impossible_cans(key: str, value: float) -> None:
    with pytest.raises(ParameterError) as refused:
        Parameters(**{"a": 1.0, "c": 1.0, "h": 1.0, key: value})
    assert refused.value.key == key
    assert refused.value.value is value


@pytest.mark.parametrize(
    ("change", "key", "value"),
    [
        ({"phi": 0.0}, "phi", 0.0),
        ({"phi": 1.6}, "phi", 1.6),
        ({"psi_dot": math.inf}, "psi_dot", math.inf),
        ({"bounces": 1, "duration": 1.0}, "horizon", (1, 1.0)),
        ({"bounces": None}, "horizon", (None, None)),
        ({"bounces": 0}, "bounces", 0),
        ({"bounces": None, "duration": -1.0}, "duration", -1.0),
    ],
)
def test_impossible_problems(change: dict[str, Any], key: str, value: object) -> None:
    with pytest.raises(ProblemError) as refused:
        Problem(**{"parameters": PAPER_CAN, "phi": 0.3, "bounces": 1, **change})
    assert (refused.value.key, refused.value.value) == (key, value)


@pytest.mark.parametrize(
    ("choice", "value"),
    [
        ({"model": "x"}, "x"),
        ({"method": "x"}, "x"),
        ({"rtol": 0.0}, 0.0),
        ({"outputs": {"x"}}, ["x"]),
    ],
)
def test_unknown_choices(choice: dict[str, Any], value: object) -> None:
    with pytest.raises(SolverError) as refused:
        solve(paper_release(bounces=1), **choice)
    assert [refused.value.key] == list(choice)
    assert refused.value.value == value


def test_times_outside_are_refused(paper: Solution) -> None:
    with pytest.raises(RefusedError) as refused:
        paper.at(paper.t_end + 1)
    assert refused.value.key == "times"
