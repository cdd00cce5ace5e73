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
    # `energy_lost` is never negative by its definition, the change of energy by the laws
    assert before - after >= -1e-12 * before
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


def newtons(D: Floats, u: Floats, mu: float, e: float) -> list[tuple[float, Floats]]:
    """Return the slips that end Newton's impact, and its impulses, found among many directions."""
    angle = np.linspace(-np.pi, np.pi, 40001)
    way = np.array([-mu * np.cos(angle), -mu * np.sin(angle), np.ones_like(angle)])
    impulse = way * (-(1 + e) * u[2] / (D @ way)[2])
    v = u[:, None] + D @ impulse
    along = v[0] * np.cos(angle) + v[1] * np.sin(angle)
    across = v[1] * np.cos(angle) - v[0] * np.sin(angle)
    good = (impulse[2] > 0) & (along > 0)
    changes = (across[1:] * across[:-1] < 0) & good[1:] & good[:-1]
    return [(float(angle[k]), impulse[:, k]) for k in np.flatnonzero(changes)]


def test_newton_slides_against_its_last_slip() -> None:
    slid = gave_way = 0
    for seed in range(150):
        D, u, mu, e = drawn(seed)
        struck = collide(D, u, mu, e, "newton")
        if struck.law == "energetic":
            # every answer of Newton's law that turns the slip least makes energy
            gave_way += 1
            held = np.linalg.solve(D, np.array([0.0, 0.0, -e * u[2]]) - u)
            sticks = np.hypot(*held[:2]) <= mu * held[2]
            start = np.arctan2(u[1], u[0])
            answers = newtons(D, u, mu, e)
            assert sticks or answers, seed
            turned = [abs((angle - start + np.pi) % (2 * np.pi) - np.pi) for angle, _ in answers]
            J = held if sticks else answers[int(np.argmin(turned))][1]
            assert energy(D, u + D @ J) > energy(D, u), seed
            assert struck.made_energy
            continue
        assert struck.velocity[2] == pytest.approx(-e * u[2], rel=1e-10)
        speed = np.hypot(*struck.velocity[:2])
        if speed > 0:
            slid += 1
            against = -mu * struck.impulse[2] * struck.velocity[:2] / speed
            assert struck.impulse[:2] == pytest.approx(against, rel=1e-7, abs=1e-10)
    assert slid > 10
    assert gave_way > 0


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
            left = energy(D, np.array([slip, 0.0, -1.0]) + D @ struck.impulse)
            assert left <= energy(D, np.array([slip, 0.0, -1.0])) * (1 + 1e-12)
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


def test_the_plane_lets_go_of_a_rim_whose_slip_turns_out_of_a_jam() -> None:
    # sliding along the first axis its mobility is -1e-8; friction turns it to where that rises
    D = np.array([[2.0, 0.8, 1.0], [0.8, 1.5, 0.2], [1.0, 0.2, 1.2 - 1e-8]])
    struck = collide(D, np.array([1.0, 0.0, 0.0]), 1.2, 0.0, "newton", jams=True)
    assert struck.law == "energetic"
    assert not struck.made_energy
    assert 0 < struck.impulse[2] < 1e-4
    assert 0 <= struck.velocity[2] < 1e-9
    assert struck.velocity[0] == pytest.approx(1.0, abs=1e-3)
