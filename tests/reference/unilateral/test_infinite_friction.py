"""Infinite friction: the limit of Coulomb's law where a rim can neither stick nor fly."""

from dataclasses import replace
from math import inf

import numpy as np
import pytest

from reference import Effects, Kind, Outcome, Parameters, Problem, Restitution, Solution, solve
from reference.problem.effects import IMPACT_LAWS
from reference.problem.states import Floats
from reference.unilateral.impact import collide
from tests.reference.unilateral.test_impact import drawn
from tests.support.unilateral_energy import energy

RELEASE = Problem(
    parameters=Parameters(a=0.5, c=0.3, h=1.2),
    phi=0.35,
    phi_dot=-0.1,
    psi_dot=-0.89,
    theta_dot=-0.71,
    duration=2.0,
    effects=Effects(restitution=Restitution(coefficient=0.3)),
)


def motion(mu: float | None) -> Solution:
    """Return the motion of the release with a coefficient of friction."""
    problem = replace(RELEASE, effects=replace(RELEASE.effects, mu=mu))
    return solve(problem, outputs=frozenset({"contact_locus"}))


def end(solution: Solution) -> Floats:
    """Return angles at the end, and the energy that was lost."""
    there = solution.at(2.0)
    return np.array([there.phi[0], there.psi[0], there.theta[0], solution.lost(np.array([2.0]))[0]])


def test_a_rim_that_can_neither_stick_nor_fly_slides_as_under_a_large_friction() -> None:
    limit, one, two = motion(None), motion(1e4), motion(2e4)
    assert limit.outcome is Outcome.FINISHED
    kinds = [Kind.STICK, Kind.SLIP, Kind.STICK, Kind.SLIP, Kind.STICK]
    assert [phase.kind for phase in limit.phases] == kinds
    assert [phase.kind for phase in one.phases] == kinds
    assert (end(one) - end(limit)) / (end(two) - end(limit)) == pytest.approx(2.0, rel=1e-2)


def test_that_slide_has_friction_and_no_normal_force() -> None:
    solution = motion(None)
    slide = solution.phases[1]
    times = np.linspace(slide.start, slide.end, 30)[1:-1]
    there = solution.at(times)
    assert there.force is not None
    assert there.slip is not None
    assert np.array_equal(there.force[:, 2], np.zeros(28))
    along = (there.force[:, :2] * there.slip).sum(1)
    sizes = np.hypot(*there.force[:, :2].T) * np.hypot(*there.slip.T)
    assert along == pytest.approx(-sizes, rel=1e-12)
    seen = energy(solution, np.linspace(0, 2, 300)) + solution.lost(np.linspace(0, 2, 300))
    assert np.abs(seen - seen[0]).max() < 1e-12
    held = solution.at(np.linspace(0, 2, 300)).force
    assert held is not None
    assert held[:, 2].min() >= 0.0


@pytest.mark.parametrize("number", [0, 1])
def test_an_impact_under_infinite_friction_is_the_limit_of_those_under_a_large_one(
    number: int,
) -> None:
    # a parameter that is the word "newton" would ask for the engine of that name
    law, slid = IMPACT_LAWS[number], 0
    for seed in range(60):
        D, u, _, e = drawn(seed)
        limit = collide(D, u, inf, e, law)
        one, two = (collide(D, u, mu, e, law) for mu in (1e5, 2e5))
        slid += bool(limit.velocity[:2].any())
        size = 1.0 + float(np.abs(limit.impulse).max())
        apart = np.abs(one.impulse - limit.impulse).max(), np.abs(two.impulse - limit.impulse).max()
        # the fifth of a millionth of the size is round-off of 1/mu times mu
        assert apart[0] < 1e-2 * size, seed
        assert apart[1] < 0.6 * apart[0] + 2e-7 * size, seed
    assert slid > 3


def test_without_friction_an_impact_leaves_the_slip_as_it_comes() -> None:
    # the slip turns and passes beside zero: nothing stops it there
    D = np.array([[2.0, 0.3, -1.5], [0.3, 1.0, 0.4], [-1.5, 0.4, 2.5]])
    u = np.array([0.5, 0.1, -1.0])
    struck = collide(D, u, 0.0, 0.0, "poisson")
    assert struck.velocity == pytest.approx(u + D @ struck.impulse, abs=1e-15)
    assert struck.energy_lost == pytest.approx(1 / (2 * D[2, 2]), rel=1e-14)
