"""A motion that calls for too much work ends with a sentence, and always at the same place."""

import re

import numpy as np
import pytest

from reference import PAPER_CAN, Effects, Outcome, Problem, solve
from reference.nonsmooth import hybrid_integrator

SLIPPING = Problem(
    parameters=PAPER_CAN, phi=0.3, psi_dot=1.0, bounces=1, effects=Effects(mu=0.2), slip=(0.1, 0.0)
)


def test_the_sentence_states_the_limit() -> None:
    number = re.search(r"\d+", Outcome.OUTWORKED.value)
    assert number is not None
    assert int(number[0]) == hybrid_integrator.MOST_WORK


def test_a_motion_ends_where_its_work_does_and_is_known_up_to_there(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    whole = solve(SLIPPING)
    assert whole.outcome is Outcome.FINISHED
    monkeypatch.setattr(hybrid_integrator, "MOST_WORK", whole.evaluations // 2)
    first, again = solve(SLIPPING), solve(SLIPPING)
    assert first.outcome is again.outcome is Outcome.OUTWORKED
    # one step goes beyond, of at most 24 iterations at 16 points
    assert hybrid_integrator.MOST_WORK < first.evaluations <= hybrid_integrator.MOST_WORK + 24 * 16
    assert 0 < first.t_end == again.t_end < whole.t_end
    times = np.linspace(0.0, first.t_end, 50)
    np.testing.assert_array_equal(first.at(times).phi, whole.at(times).phi)


def test_a_slip_that_stops_does_not_shorten_the_steps_that_stick() -> None:
    """Steps grow by 2 at most: from the 1e-12 of an ending slip to 1 that would be forty."""
    found = solve(SLIPPING)
    kinds = [phase.kind.value for phase in found.phases]
    assert "stick" in kinds
    assert found.steps < 40 * len(kinds)


def test_a_fall_that_nothing_curves_is_one_long_step_after_the_other() -> None:
    """Fast rolling on a rim almost flat: it takes thousands of times the natural length, phi."""
    spins = Problem(
        parameters=PAPER_CAN, phi=1e-9, phi_dot=1e-9, psi_dot=1e-5, theta_dot=-8.0, bounces=1
    )
    by_friction, rolling = solve(spins, model="coulomb"), solve(spins, model="rolling")
    assert by_friction.outcome is rolling.outcome is Outcome.FINISHED
    assert by_friction.steps < 100
    assert by_friction.t_end == pytest.approx(rolling.t_end, rel=1e-12, abs=0.0)
