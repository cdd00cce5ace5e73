"""Releases at which round-off would have the say: solved for exactly the doubles given, or said.

The forty-digit values are of golden/make_golden.py, as those of tests/reference/test_exact.py.
"""

import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import mpmath as mp
import numpy as np
import pytest

from reference import PAPER_CAN, Outcome, Parameters, Problem, solve
from reference.analysis.conditioning import Lost
from reference.equations import steady_motion
from reference.equations.balancing_angle import short_of_balance, sine_and_cosine
from reference.integrable.cycle import exact_bounces

HARD = json.loads((Path(__file__).parent / "golden" / "hard.json").read_text())
RELEASE = ("phi", "phi_dot", "psi_dot", "theta_dot")


def problem_of(row: dict[str, Any], bounces: int) -> Problem:
    can = Parameters(a=row["a"], c=row["c"], h=row["h"])
    return Problem(parameters=can, bounces=bounces, **{name: row[name] for name in RELEASE})


def test_sine_and_cosine_have_thirty_digits() -> None:
    x = np.random.default_rng(0).uniform(0.0, np.pi / 2, 40)
    for pair, truth in zip(sine_and_cosine(x), (mp.sin, mp.cos), strict=True):
        for high, low, at in zip(*pair, x, strict=True):
            with mp.workdps(50):
                # a few roundings of 2^-104
                assert abs(mp.mpf(high) + mp.mpf(low) - truth(mp.mpf(at))) < mp.mpf("2e-31")


def test_distance_from_balance_has_all_its_digits_down_to_one_ulp() -> None:
    h = 10.0 ** np.random.default_rng(1).uniform(-2.0, 1.0, 40)
    phi = np.nextafter(np.arctan2(1.0, h), 0.0)
    many = short_of_balance(h, phi)
    for found, height, at in zip(many, h, phi, strict=True):
        with mp.workdps(50):
            truth = mp.atan(1 / mp.mpf(height)) - mp.mpf(at)
            assert abs(mp.mpf(found) / truth - 1) < mp.mpf("5e-16")
        assert short_of_balance(np.asarray(height), np.array([at]))[0] == found


@pytest.mark.parametrize("row", HARD, ids=lambda row: f"{row['can']}, phi={row['phi']:.3g}")
def test_forty_digits_of_hard_releases(row: dict[str, Any]) -> None:
    """To 1e-9 as promised: the formula, the integrator, and the formula in a batch."""
    cycles = exact_bounces(**{name: row[name] for name in ("a", "c", "h", *RELEASE)})
    assert cycles.period[0] == pytest.approx(float(row["period"]), rel=1e-9)
    assert cycles.angle_of_turn[0] == pytest.approx(float(row["angle_of_turn"]), rel=1e-9, abs=0)
    for model in ("exact", "rolling"):
        solution = solve(problem_of(row, 2), model=model)
        assert solution.outcome is Outcome.FINISHED
        bounce = solution.bounces[1]
        period = solution.maxima[2] - solution.maxima[1]
        assert period == pytest.approx(float(row["period"]), rel=1e-9)
        for name in ("angle_of_turn", "rotation_turn", "phi_min", "peak_psi_dot"):
            assert getattr(bounce, name) == pytest.approx(float(row[name]), rel=1e-9, abs=0), name
        # the time from the release to the first maximum, which falls behind one that already falls
        first = solution.maxima[1 if row["phi_dot"] < 0 else 0]
        # a time is a difference of sums as large as the period
        ulps = 16 * float(np.finfo(float).eps) * float(row["period"])
        assert first == pytest.approx(float(row["first_maximum"]), rel=1e-9, abs=ulps)


@pytest.mark.parametrize("phi_dot", [1e-9, -1e-9, 1e-12, -1e-12])
def test_a_release_that_hardly_moves_is_a_moment_from_its_turning_point(phi_dot: float) -> None:
    """phi'/phi'' before or behind it, though phi has no digits for the way between."""
    release: dict[str, Any] = {
        "parameters": PAPER_CAN,
        "phi": 0.3,
        "psi_dot": 0.05,
        "theta_dot": 0.1,
    }
    still, moving = (
        solve(Problem(**release, phi_dot=rate, bounces=1), model="exact") for rate in (0.0, phi_dot)
    )
    pull = still.at(np.array([1e-4])).phi_dot[0] / 1e-4
    # phi'' changes by a share of 1e-8 in that time
    assert moving.minima[0] - still.minima[0] == pytest.approx(-phi_dot / pull, rel=1e-4, abs=0)


def test_a_release_that_falls_past_a_barrier_comes_back_over_it() -> None:
    """It starts 3e-24 of energy above the barrier, which round-off at the bottom would bury."""
    can = Parameters(a=0.3932274030684801, c=0.4248707810152624, h=0.04180944140173747)
    problem = Problem(
        parameters=can,
        phi=1.480526840722708,
        phi_dot=-1.931863527791174e-12,
        psi_dot=0.8414955978119175,
        theta_dot=-0.07087381865823705,
        bounces=2,
    )
    found = solve(problem)
    # sixty digits: there is no maximum below pi/2
    assert found.outcome is Outcome.OVERTURNED
    assert found.agreement is not None
    assert found.agreement.holds


@pytest.mark.parametrize("phi_dot", [-2.0, -0.9])
def test_a_motion_with_one_extremum_goes_back_on_its_own_way(phi_dot: float) -> None:
    problem = Problem(
        parameters=Parameters(a=0.3, c=0.5, h=1.0),
        phi=0.7,
        phi_dot=phi_dot,
        psi=0.4,
        theta=0.3,
        psi_dot=0.3,
        theta_dot=-0.2,
        bounces=1,
    )
    whole, marched = (
        solve(problem, model="rolling", method=method, outputs={"contact_locus"})
        for method in ("half-period", "picard-chebyshev")
    )
    assert whole.outcome is marched.outcome is Outcome.OVERTURNED
    assert whole.t_end == pytest.approx(marched.t_end, rel=1e-13, abs=0)
    assert whole.minima == pytest.approx(marched.minima, rel=1e-13, abs=0)
    short = replace(problem, bounces=None, duration=0.9 * whole.t_end)
    cut = solve(short, model="rolling", outputs={"contact_locus"})
    assert (cut.outcome, cut.t_end) == (Outcome.FINISHED, short.duration)
    times = np.linspace(0.0, cut.t_end, 100)
    here, there, part = (solution.at(times) for solution in (whole, marched, cut))
    for name in ("phi", "phi_dot", "psi", "theta", "x", "y"):
        for other in (there, part):
            # round-off of rates of order ten
            assert np.abs(getattr(here, name) - getattr(other, name)).max() < 1e-12, name


def test_marching_comes_back_without_the_mirror() -> None:
    """The symmetry the default integrator uses is a property of the equations, not assumed."""
    problem = Problem(parameters=PAPER_CAN, phi=0.3, psi_dot=0.3, theta_dot=-0.1, bounces=3)
    mirrored, marched = (
        solve(problem, model="rolling", method=method, outputs={"contact_locus"})
        for method in ("half-period", "picard-chebyshev")
    )
    times = np.linspace(0.0, min(mirrored.t_end, marched.t_end), 200)
    here, there = mirrored.at(times), marched.at(times)
    for name in ("phi", "phi_dot", "psi", "theta", "x", "y"):
        # round-off of three bounces, times rates of order ten
        assert np.abs(getattr(here, name) - getattr(there, name)).max() < 1e-12, name


@pytest.mark.parametrize("phi_dot", [0.3, -0.3])
def test_a_moving_release_is_followed_both_ways(phi_dot: float) -> None:
    problem = Problem(
        parameters=PAPER_CAN,
        phi=0.2,
        phi_dot=phi_dot,
        psi=0.4,
        theta=1.0,
        psi_dot=0.5,
        duration=7.0,
    )
    mirrored, marched = (
        solve(problem, model="rolling", method=method, outputs={"contact_locus"})
        for method in ("half-period", "picard-chebyshev")
    )
    times = np.linspace(0.0, 7.0, 200)
    here, there = mirrored.at(times), marched.at(times)
    for name in ("phi", "phi_dot", "psi", "theta", "x", "y"):
        assert np.abs(getattr(here, name) - getattr(there, name)).max() < 1e-11, name
    assert mirrored.maxima == pytest.approx(marched.maxima, rel=1e-12)
    assert mirrored.minima == pytest.approx(marched.minima, rel=1e-12, abs=0)
    times, _ = mirrored.path.nodes()
    assert (np.diff(times) >= 0).all()
    assert times[0] >= 0
    assert times[-1] == mirrored.t_end == 7.0


def test_what_round_off_takes_is_said() -> None:
    def lost(**release: Any) -> Lost | None:
        found = solve(Problem(parameters=PAPER_CAN, bounces=1, **release), model="exact").round_off
        return None if found is None else found.lost

    balance = PAPER_CAN.balancing_angle
    assert lost(phi=balance - 1e-12, theta_dot=0.1) is Lost.NEIGHBOURS
    assert lost(phi=balance - 1e-5, theta_dot=0.1) is None
    rotation = steady_motion.steady_rotation(PAPER_CAN, 0.3, 0.5)
    assert lost(phi=0.3 * (1 - 1e-8), psi_dot=0.5, theta_dot=rotation) is Lost.FORCE
    assert lost(phi=0.3, psi_dot=0.5, theta_dot=0.1) is None


@pytest.mark.slow
def test_beside_steady_rolling_no_more_is_lost_than_is_said() -> None:
    """Formula and integrator differ by less than the number in the sentence, or than 1e-9."""
    random, said = np.random.default_rng(5), 0
    for _ in range(60):
        a = 10.0 ** random.uniform(-1.0, 1.0)
        h = 10.0 ** random.uniform(-1.5, 0.8)
        can = Parameters(a=a, c=a * random.uniform(0.05, 1.9), h=h)
        phi = can.balancing_angle * random.uniform(0.2, 0.99)
        psi_dot = 10.0 ** random.uniform(-3.0, 1.0)
        problem = Problem(
            parameters=can,
            phi=phi * (1 - 10.0 ** random.uniform(-9.0, -5.0)),
            psi_dot=psi_dot,
            theta_dot=steady_motion.steady_rotation(can, phi, psi_dot),
            bounces=1,
        )
        formula, integrated = (solve(problem, model=model) for model in ("exact", "rolling"))
        if not formula.bounces or not integrated.bounces:
            continue
        foretold = formula.round_off
        lost = foretold.share if foretold is not None else 1e-9
        said += foretold is not None
        one, other = formula.bounces[0], integrated.bounces[0]
        assert math.isclose(one.time, other.time, rel_tol=max(lost, 1e-9))
        assert math.isclose(one.phi_min, other.phi_min, rel_tol=max(lost, 1e-9))
    assert said >= 5
