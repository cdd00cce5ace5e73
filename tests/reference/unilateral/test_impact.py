"""Impacts of one point with friction, against other ways to compute them."""

from math import inf

import numpy as np
import pytest
import scipy
from hypothesis import given, settings
from hypothesis import strategies as st

from reference.problem.states import Floats
from reference.unilateral.impact import collide

SEEDS = st.integers(0, 2**32 - 1)


def drawn(seed: int) -> tuple[Floats, Floats, float, float]:
    """Return a mobility, a velocity that approaches, a friction and a restitution."""
    numbers = np.random.default_rng(seed)
    root = numbers.normal(size=(3, 3)) + np.eye(3)
    velocity = numbers.normal(size=3)
    velocity[2] = -abs(velocity[2]) - 0.01
    return root @ root.T, velocity, float(numbers.uniform(0, 1.5)), float(numbers.uniform(0, 1))


def energy(D: Floats, u: Floats) -> float:
    """Return the energy that an impact can take."""
    return float(u @ np.linalg.solve(D, u)) / 2


@given(seed=SEEDS, law=st.sampled_from(["newton", "poisson"]), rough=st.booleans())
@settings(max_examples=150, deadline=None)
def test_impact_stays_in_the_cone_parts_and_makes_no_energy(
    seed: int,
    law: str,
    rough: bool,  # noqa: FBT001 - hypothesis names it
) -> None:
    D, u, mu, e = drawn(seed)
    mu = inf if rough else mu
    struck = collide(D, u, mu, e, law)
    before, after = energy(D, u), energy(D, u + D @ struck.impulse)
    tangential = float(np.hypot(*struck.impulse[:2]))
    # the equation of the slip is solved to 1e-13; the stopping of it leaves the square root
    assert struck.impulse[2] >= 0
    assert rough or tangential <= mu * struck.impulse[2] * (1 + 1e-9)
    assert struck.velocity[2] >= -1e-9
    assert struck.energy_lost >= 0
    assert before - after == pytest.approx(struck.energy_lost, abs=1e-10 * (1 + before))


def slip_followed(D: Floats, u: Floats, mu: float, e: float) -> Floats:
    """Return the impulse of Poisson's law of a slip that does not stop, in the raw variables."""

    def rates(_: float, y: Floats) -> Floats:
        return np.asarray(D @ np.array([*(-mu * y[:2] / np.hypot(y[0], y[1])), 1.0]))

    def over(_: float, y: Floats) -> float:
        return float(y[2])

    over.terminal = True  # type: ignore[attr-defined]
    method = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-13}
    squeezed = scipy.integrate.solve_ivp(rates, (0, 1e3), u, events=over, **method)
    p = float(squeezed.t[-1])
    if e > 0:
        u_c = squeezed.y[:, -1]
        squeezed = scipy.integrate.solve_ivp(rates, (p, (1 + e) * p), u_c, **method)
    return np.asarray(np.linalg.solve(D, squeezed.y[:, -1] - u))


def test_poisson_is_the_slip_followed_in_raw_variables() -> None:
    compared = 0
    for seed in range(40):
        D, u, mu, e = drawn(seed)
        u, mu = u * np.array([8.0, 8.0, 1.0]), mu / 4
        struck = collide(D, u, mu, e, "poisson")
        if np.hypot(*struck.velocity[:2]) < 1.0 or struck.law != "poisson":
            continue
        compared += 1
        expected = slip_followed(D, u, mu, e)
        assert struck.impulse == pytest.approx(expected, rel=1e-8, abs=1e-9)
    assert compared > 10


def test_newton_slides_against_its_last_slip() -> None:
    slid = 0
    for seed in range(60):
        D, u, mu, e = drawn(seed)
        struck = collide(D, u, mu, e, "newton")
        if struck.law != "newton":
            continue
        assert struck.velocity[2] == pytest.approx(-e * u[2], rel=1e-10)
        speed = np.hypot(*struck.velocity[:2])
        if speed > 0:
            slid += 1
            against = -mu * struck.impulse[2] * struck.velocity[:2] / speed
            assert struck.impulse[:2] == pytest.approx(against, rel=1e-7, abs=1e-10)
    assert slid > 10


def test_without_friction_the_three_laws_are_one() -> None:
    for seed in range(20):
        D, u, _, e = drawn(seed)
        found = [collide(D, u, 0.0, e, law).impulse for law in ("newton", "poisson", "energetic")]
        expected = np.array([0, 0, -(1 + e) * u[2] / D[2, 2]])
        for impulse in found:
            assert impulse == pytest.approx(expected, rel=1e-12, abs=1e-15)


def test_newtons_law_that_would_make_energy_gives_way_and_says_so() -> None:
    D = np.array([[2.5, 0.0, -1.5], [0.0, 1.0, 0.0], [-1.5, 0.0, 2.5]])
    made = []
    for slip in np.linspace(-3, 3, 61):
        for e in (0.5, 0.9, 1.0):
            struck = collide(D, np.array([slip, 0.0, -1.0]), 0.8, e, "newton")
            made.append(struck.made_energy)
            assert (struck.law == "energetic") == struck.made_energy
            assert struck.energy_lost >= 0
    assert any(made)
    assert not all(made)


def test_a_rim_that_jams_is_stopped_by_an_impulse() -> None:
    # sliding this way, friction drives the rim into the plane: the normal mobility is negative
    D = np.array([[3.0, 0.0, 2.0], [0.0, 1.0, 0.0], [2.0, 0.0, 2.0]])
    struck = collide(D, np.array([1.0, 0.0, 0.0]), 1.2, 0.5, "newton", jams=True)
    assert struck.law == "energetic"
    assert struck.impulse[2] > 0
    assert struck.velocity[0] == 0.0
    assert struck.energy_lost > 0
