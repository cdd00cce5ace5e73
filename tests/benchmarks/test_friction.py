"""The truth of the friction benchmark: an extrapolation whose steps and formulas are its own."""

import numpy as np
import pytest

from harness.engines.reference.to_reference_problem import problem as posed
from models.catalogue import load
from reference import solve
from tests.benchmarks import friction
from tests.benchmarks.extrapolation import Extrapolation
from tests.benchmarks.newton_euler import follow


@pytest.mark.parametrize(
    ("scene", "end"), [("tilted-plane", 3.0), ("off-centre-mass", 3.0), ("slipping-rock", 3.4)]
)
def test_the_integrator_is_within_round_off_of_the_truth(scene: str, end: float) -> None:
    solution = solve(posed(load(scene)))
    there = friction._raw(solution, end)  # noqa: SLF001
    for begun in (1e-2, 1e-3):
        # whichever share of a slip's beginning is given, the rest is the extrapolation's own
        truth = Extrapolation(solution.problem)
        follow(truth, end, friction.onsets(solution, begun), stopped=1e-10)
        assert np.abs(truth.y - there).max() < 1e-13


def test_dop853_comes_to_the_truth_through_a_slip_that_stops() -> None:
    solution = solve(posed(load("friction-below")))
    rival = friction.by_scipy(solution.problem, 5.0, (1e-12, 1e-3), friction.onsets(solution, 1e-2))
    # thousands of steps at that tolerance
    assert np.abs(rival - friction._raw(solution, 5.0)).max() < 1e-10  # noqa: SLF001
