"""A sample of the hostile campaign (`python -m tests.reference.hostile`), fixed seed."""

from typing import Any

import numpy as np
import pytest

from reference import Outcome, Parameters, Problem, exact_bounces, solve
from tests.reference.hostile.campaign import (
    AGREED,
    in_a_batch,
    integrated_answer,
    moved_by_roundings,
    problem_of,
)
from tests.reference.hostile.made import CLOSEST, made

NUMBERS, SEED = range(150), 7


@pytest.mark.slow
def test_constructed_releases_are_solved_as_the_integrator_solves_them() -> None:
    """Outcome, period and phi_min of the batch, to what the numbers given allow."""
    releases = [one for one in made(NUMBERS, SEED) if one.family != CLOSEST]
    refused = bounced = 0
    compiled = in_a_batch(releases, compiled=True)
    for one, answer, kernel in zip(releases, in_a_batch(releases), compiled, strict=True):
        # held to the arrays, which are held to the integration
        assert kernel.parts(answer) <= AGREED, one
        refused += answer.outcome is Outcome.UNRESOLVED
        bounced += answer.outcome is Outcome.FINISHED
        if answer.outcome is Outcome.UNRESOLVED:
            continue
        problem = problem_of(one)
        integrated = integrated_answer(problem)
        apart = answer.parts(integrated)
        if apart > AGREED:
            assert apart <= AGREED + moved_by_roundings(problem, integrated, apart), one
    assert bounced >= len(releases) / 2
    # the campaign's limit
    assert refused <= 0.01 * len(releases)


# Sixty digits of `tests.reference.hostile.truth`.
OSCILLATIONS = (
    (
        Parameters(a=0.15947293348237318, c=0.11659139373591411, h=0.5762731701138756),
        {
            "phi": 1.2702932339221178,
            "phi_dot": 2.2308743623308443e-08,
            "psi_dot": 1.2076588816276375,
            "theta_dot": 0.4617697015324338,
        },
        8.69060804788113,
    ),
    (
        Parameters(a=4.339557789471864, c=8.679115578943728, h=5.279106703307725),
        {
            "phi": 0.8087415733951503,
            "phi_dot": 1.1568065983231015e-08,
            "psi_dot": 0.5365907710909475,
            "theta_dot": 1.1271612315486816,
        },
        57.49885019329466,
    ),
)


@pytest.mark.parametrize(("can", "release", "period"), OSCILLATIONS)
def test_small_oscillations_about_steady_rolling_keep_their_digits(
    can: Parameters, release: dict[str, Any], period: float
) -> None:
    """With amplitudes of 1e-8 the terms of the energy cancel to less than a double resolves."""
    found = exact_bounces(a=can.a, c=can.c, h=can.h, **release)
    assert found.period == pytest.approx(period, rel=1e-13, abs=0)
    swing = np.abs(found.phi_max / found.phi_min - 1)
    assert (swing < 1e-6).all()
    motion = solve(Problem(parameters=can, **release, bounces=2), model="exact")
    assert motion.model == "exact"
    states = motion.at(np.linspace(0.0, motion.t_end, 200))
    # a harmonic oscillation: its greatest speed, of half the swing and the period
    fastest = np.pi * (found.phi_max - found.phi_min)[0] / period
    assert np.abs(states.phi_dot).max() == pytest.approx(fastest, rel=1e-3)


@pytest.mark.slow
def test_a_slow_passage_over_a_barrier_keeps_its_digits() -> None:
    """Released 1e-15 from the barrier, with all but 3e-17 of the energy that it takes to pass."""
    can = Parameters(a=6.751948587671912, c=7.5542583265216114, h=6.325856466979378)
    release: dict[str, Any] = {
        "phi": 1.0733273642165597,
        "phi_dot": -1.0962645419971048e-09,
        "psi_dot": 0.26186293254124354,
        "theta_dot": 2.3258372210578564,
    }
    batch = exact_bounces(a=can.a, c=can.c, h=can.h, **release)
    # sixty digits of `tests.reference.hostile.truth`
    assert batch.period[0] == pytest.approx(1056.72387955304, rel=1e-12)
    solution = solve(Problem(parameters=can, **release, bounces=2))
    period = float(np.diff(solution.maxima)[-1])
    assert solution.agreement is not None
    assert solution.agreement.sentence
    assert abs(period / 1056.72387955304 - 1) <= solution.agreement.discrepancy
