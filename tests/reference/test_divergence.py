"""What is called chaotic, and what is not: regular motions, however they end."""

import math
from dataclasses import replace

import numpy as np
import pytest

import reference.analysis.lyapunov
from reference import PAPER_CAN, Effects, Gravity, Mass, Problem, divergence, solve

ROCKING = Problem(parameters=PAPER_CAN, phi=0.3, psi_dot=0.06, bounces=1)


def tilted(angle: float) -> Effects:
    return Effects(gravity=Gravity(constant=(math.sin(angle), 0.0, -math.cos(angle))))


SHAKEN = Effects(gravity=Gravity(amplitude=(3.6e-3, 0.0, 3.6e-3), rate=11.6))


@pytest.mark.parametrize(
    "problem",
    [
        replace(ROCKING, effects=Effects(mass=Mass(share=1e-3, z=1.0))),
        replace(ROCKING, effects=tilted(1e-3)),
        replace(ROCKING, phi=0.2, effects=tilted(1.5)),
        replace(ROCKING, phi=0.2, psi_dot=0.0, effects=SHAKEN),
        replace(ROCKING, phi=0.2, psi_dot=0.0, phi_dot=-0.3, effects=SHAKEN),
    ],
    ids=["mass on the axis", "tilted", "overturned", "shaken flat", "thrown flat"],
)
def test_a_regular_motion_is_not_called_chaotic_where_its_horizon_is_rounded(
    problem: Problem,
) -> None:
    found = divergence(problem)
    assert not found.chaotic
    # like time, and as a bounce turns
    assert found.growth < reference.analysis.lyapunov.CHAOTIC


def test_a_motion_that_is_known_is_not_solved_again() -> None:
    """And what is followed ends where the motion does."""
    problem = replace(ROCKING, effects=tilted(1e-3))
    own = solve(problem)
    found = divergence(problem, own)
    # one polynomial, asked for one instant and for many
    assert found.times[-1] == pytest.approx(own.t_end, rel=1e-15, abs=0)
    np.testing.assert_array_equal(found.distance, divergence(problem).distance)


def test_closed_motions_are_followed_as_well() -> None:
    """Of an ideal can: what is closed has no pieces, and the general can the same motion."""
    own = solve(ROCKING)
    found = divergence(ROCKING, own)
    assert own.model == "exact"
    assert found.times[-1] == pytest.approx(own.t_end, rel=1e-15, abs=0)
    assert 0.1 < found.growth < 10
    assert not found.chaotic
