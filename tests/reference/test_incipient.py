"""How slip begins: every admissible direction, and what it means that there is none, or several.

The directions are compared with a rigid body in vectors of space, derived here on its own: no frame
that leans, no time of the rim, nothing of `reference`.
"""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from reference import (
    PAPER_CAN,
    Effects,
    FindingKind,
    Gravity,
    Kind,
    Outcome,
    Parameters,
    Problem,
    examine,
    solve,
)
from reference.equations.contact_laws import Mode
from reference.equations.coulomb import CoulombEquations
from reference.equations.newton_euler import GeneralEquations
from reference.equations.state_vector import released
from reference.nonsmooth.slip_onset import SlipOnset, admissible, slack
from reference.problem.states import Floats
from tests.onsets.__main__ import page
from tests.onsets.campaign import Tally, campaign, drawn

UP = np.array([0.0, 0.0, 1.0])
PULLED = Problem(
    parameters=PAPER_CAN,
    phi=0.0786,
    phi_dot=-2.2,
    psi_dot=6.3,
    theta_dot=-8.85,
    duration=0.05,
    effects=Effects(mu=0.256),
)
"""Once followed with N = -1.64 at the release."""
SLIDING = Problem(
    parameters=PAPER_CAN, phi=0.3, slip=(-0.5, 0.0), duration=0.3, effects=Effects(mu=3.0)
)
"""Slipping towards the far rim, so that the friction presses the rim into the plane."""
NEEDLE = Problem(
    parameters=Parameters(a=0.005, c=0.01, h=9.8),
    phi=0.0655,
    phi_dot=-0.1,
    psi_dot=4.2,
    theta_dot=2.16,
    duration=0.3,
    effects=Effects(mu=0.0373),
)
"""Found by drawing cans with a of 0.003 to 1 and a friction a little less than they need to stick:
of 14,000 such onsets 65 have three directions, one 0.3 % below what NEEDLE needs."""
RISING = Problem(
    parameters=Parameters(a=0.024, c=0.048, h=0.46),
    phi=1.1,
    phi_dot=0.39,
    psi_dot=5.1,
    theta_dot=0.95,
    duration=0.3,
    effects=Effects(mu=0.5667),
)
"""Found likewise: none is admissible, but two have N > 0, and the free rim rises."""


class RigidBody:
    """The can in vectors of space, its lean towards -x: how its rim answers to a force.

    The material at the contact, at p from the centre, has the velocity u = v + w x p, so that
    u' = free + mobility F.
    """

    def __init__(self, problem: Problem) -> None:
        can, S, C = problem.parameters, math.sin(problem.phi), math.cos(problem.phi)
        axis = np.array([-S, 0.0, C])
        # psi turns about the vertical, phi about the level direction across, theta about the axis
        turning = (
            problem.psi_dot * UP
            - problem.phi_dot * np.array([0.0, 1.0, 0.0])
            + problem.theta_dot * axis
        )
        inertia = can.a * np.eye(3) + (can.c - can.a) * np.outer(axis, axis)

        def contact(axis: Floats) -> Floats:
            inwards = UP - (UP @ axis) * axis
            return -inwards / np.linalg.norm(inwards) - can.h * axis

        step = 1e-5 * np.cross(turning, axis)
        point, moves = contact(axis), (contact(axis + step) - contact(axis - step)) / 2e-5
        inverse = np.linalg.inv(inertia)
        spins = inverse @ np.cross(inertia @ turning, turning)
        self.free = -UP + np.cross(spins, point) + np.cross(turning, moves)
        arms = np.cross(np.eye(3), point)  # rows e_i x p, so that arms F = p x F
        self.mobility = np.eye(3) - arms @ inverse @ arms

    def held(self) -> Floats:
        """Return the force that holds the rim."""
        return np.asarray(-np.linalg.solve(self.mobility, self.free))

    def sliding(self, mu: float, e: Floats) -> tuple[Floats, Floats, Floats]:
        """Return N, the normal mobility and the acceleration under -mu N e, e of shape (2, n)."""
        answer = self.mobility @ np.array([-mu * e[0], -mu * e[1], np.ones_like(e[0])])
        N = -self.free[2] / answer[2]
        return N, answer[2], self.free[:2, None] + N * answer[:2]

    def directions(self, mu: float) -> list[float]:
        """Return the admissible directions by trying twenty thousand: no root is a pole."""
        # beside 0, where a can that does not nod slips
        angles = np.linspace(-math.pi, math.pi, 20_001) + 1e-4
        e = np.array([np.cos(angles), np.sin(angles)])
        N, normal_mobility, a = self.sliding(mu, e)
        across = normal_mobility * (e[0] * a[1] - e[1] * a[0])
        turns = across * np.roll(across, 1) < 0
        turns[0] = False
        right = turns & (N > 0) & (normal_mobility > 0) & ((e * a).sum(axis=0) > 0)
        return [float(angle) for angle in angles[right]]


def admissible_of(problem: Problem) -> tuple[SlipOnset, ...]:
    assert problem.effects.mu is not None
    equations = CoulombEquations(parameters=problem.parameters, mu=problem.effects.mu)
    return admissible(equations, released(problem), Mode(slips=True))


@pytest.mark.parametrize("model", ["coulomb", "general"])
def test_a_rim_that_would_have_to_be_pulled_does_not_slip_but_lifts(model: str) -> None:
    body = RigidBody(PULLED)
    # holding takes more friction, sliding a pull whatever the direction; free it rises
    force = body.held()
    assert np.hypot(*force[:2]) > 0.256 * force[2]
    assert body.free[2] > 0
    assert body.directions(0.256) == []
    found = solve(PULLED, model=model)
    assert found.outcome is Outcome.LIFTED
    assert found.t_end == 0


def beginnings(count: int, seed: int) -> list[Problem]:
    """Random releases at rest whose rims cannot be held, half of them with a friction above 1."""
    chance = np.random.default_rng(seed)
    chosen: list[Problem] = []
    while len(chosen) < count:
        kind, problem = drawn(chance)
        assert problem.effects.mu is not None
        mu = problem.effects.mu if len(chosen) % 2 else 1.0 + problem.effects.mu
        held = RigidBody(problem).held()
        if kind == "at rest" and np.hypot(*held[:2]) > mu * held[2]:
            chosen.append(replace(problem, effects=Effects(mu=mu)))
    return chosen


def test_all_directions_are_found_and_no_pole_is_one() -> None:
    counts = set()
    for problem in (*beginnings(40, 2), NEEDLE, RISING):
        assert problem.effects.mu is not None
        body, found = RigidBody(problem), admissible_of(problem)
        tried = body.directions(problem.effects.mu)
        turned = [math.remainder(each.angle, 2 * math.pi) for each in found]
        # to the distance of the angles that were tried
        assert sorted(turned) == pytest.approx(tried, abs=4e-4)
        assert all(math.isfinite(each.size) and each.size > 0 for each in found)
        # theory: a rim that would fall has one at least, and one that would rise none
        assert bool(found) == (body.free[2] < 0)
        counts.add(len(found))
    assert counts == {0, 1, 3}


@pytest.mark.parametrize("problem", beginnings(200, 5)[::25])
def test_slip_begins_where_friction_that_is_never_quite_rigid_takes_it(problem: Problem) -> None:
    """Friction -mu N u/sqrt(u^2 + d^2) has no first direction: it finds one, here within 1e5 d."""
    assert problem.effects.mu is not None
    mu, body, small = problem.effects.mu, RigidBody(problem), 1e-10

    def rate(_t: float, u: Floats) -> Floats:
        return body.sliding(mu, (u / math.sqrt(u @ u + small**2))[:, None])[2][:, 0]

    found = admissible_of(problem)
    if body.free[2] > 0:
        assert found == ()
        return
    (only,) = found
    speed = only.size / math.sin(problem.phi)
    done = solve_ivp(rate, (0.0, 1e5 * small / speed), np.zeros(2), "Radau", rtol=1e-8, atol=1e-16)
    u = done.y[:, -1]
    # what is left of the time that it takes to find it: some logarithms over 1e5
    assert np.hypot(*u) == pytest.approx(1e5 * small, rel=2e-3)
    assert math.remainder(math.atan2(u[1], u[0]) - only.angle, 2 * math.pi) == pytest.approx(
        0, abs=2e-3
    )
    assert body.sliding(mu, (u / np.hypot(*u))[:, None])[0][0] > 0


@pytest.mark.parametrize("model", ["coulomb", "general"])
@pytest.mark.parametrize(
    ("problem", "outcome"),
    [
        # at rest but for the slip the rim falls: no force keeps it on the plane
        (SLIDING, Outcome.INCONSISTENT),
        # falling this fast its rim rises, or is held down by its own friction
        (replace(SLIDING, phi_dot=-2.0), Outcome.INDETERMINATE),
        (NEEDLE, Outcome.INDETERMINATE),
        (RISING, Outcome.INDETERMINATE),
        # a little less friction, and it just slips; or lifts
        (replace(SLIDING, effects=Effects(mu=0.5)), Outcome.FINISHED),
        (replace(RISING, effects=Effects(mu=0.54)), Outcome.LIFTED),
    ],
)
def test_none_or_several_are_named(problem: Problem, outcome: Outcome, model: str) -> None:
    found = solve(problem, model=model)
    assert found.outcome is outcome
    if outcome in {Outcome.INCONSISTENT, Outcome.INDETERMINATE}:
        assert found.t_end == 0
        (finding,) = examine(found, np.array([0.0])).findings
        assert finding.kind is FindingKind.ENDING
        # which law, and in which state
        assert f"mu {problem.effects.mu:g}" in finding.sentence
        assert f"phi = {problem.phi:.6g} rad" in finding.sentence


def test_what_a_slipping_rim_has_none_or_several_of_is_so_by_hand() -> None:
    """The normal mobility is 1 + R (R + mu u1 Z/|u|)/a, here of u1 = -|u|, as in `coulomb`."""
    S, C, p = math.sin(0.3), math.cos(0.3), PAPER_CAN
    reach, height = C - p.h * S, S + p.h * C
    for phi_dot in (0.0, -2.0):
        body = RigidBody(replace(SLIDING, phi_dot=phi_dot))
        (N,), (normal_mobility,), _ = body.sliding(3.0, np.array([[-1.0], [0.0]]))
        assert normal_mobility == pytest.approx(1 + reach * (reach - 3.0 * height) / p.a, rel=1e-9)
        assert normal_mobility < 0
        assert N * normal_mobility == pytest.approx(1 - height * phi_dot**2, rel=1e-9)
        assert (N > 0) == (phi_dot != 0)


def test_a_rim_whose_mobility_falls_to_zero_jams() -> None:
    """The force grows as the root of the time that is left: its square falls in a straight line."""
    turning = replace(SLIDING, psi_dot=1.0, theta_dot=-0.5, slip=(-0.1, 0.5))
    found = solve(replace(turning, effects=Effects(mu=2.0)))
    assert found.outcome is Outcome.JAMMED
    assert 0 < found.t_end < 0.3
    assert [phase.kind for phase in found.phases] == [Kind.SLIP]
    left = np.array([1e-6, 1e-7, 1e-8])
    force = found.at(found.t_end - left).force
    assert force is not None
    # of first order in the force over its limit, some 1e-2
    orders = np.diff(np.log(force[:, 2])) / np.diff(np.log(left))
    assert orders == pytest.approx([-0.5, -0.5], abs=0.05)


def test_at_the_edge_of_the_cone_a_rim_that_goes_on_sticking_is_held() -> None:
    """Friction of exactly what the release needs, where it needs less a little later."""
    problem = Problem(parameters=PAPER_CAN, phi=0.4, psi_dot=0.3, theta_dot=-0.4, duration=0.1)
    held = RigidBody(replace(problem, phi_dot=0.2)).held()
    exact = float(np.hypot(*held[:2]) / held[2])
    slips = set()
    for phi_dot in (0.2, -0.2):
        start = replace(problem, phi_dot=phi_dot)
        reaction = RigidBody(start).held()
        mu = float(np.hypot(*reaction[:2]) / reaction[2])
        assert mu == pytest.approx(exact, rel=0.5)
        equations = CoulombEquations(parameters=PAPER_CAN, mu=mu)
        y = released(start)
        assert abs(slack(equations, equations.contact(y[:, None], Mode()))[0]) < 1e-8
        # what the body of vectors needs is known to a difference quotient of its contact
        found = solve(replace(start, effects=Effects(mu=mu * (1 + 1e-8))))
        assert found.outcome is Outcome.FINISHED
        slips.add(found.phases[-1].kind)
    assert slips == {Kind.STICK, Kind.SLIP}


def test_the_arms_have_a_mobility_of_their_own() -> None:
    """What is held besides counts: that of a force which may be had, found by a difference."""
    can = replace(SLIDING, psi_dot=1.0, effects=Effects(mu=0.7, drilling=0.2))
    equations = GeneralEquations(parameters=can.parameters, effects=can.effects)
    y = released(can)[:, None]
    for mode in (Mode(slips=True), Mode(slips=True, turns=1), Mode(turns=1)):
        found = equations.contact(y, mode)
        # a plane that is lifted by one unit of acceleration asks for 1/normal_mobility more
        lifted = GeneralEquations(
            parameters=can.parameters,
            effects=replace(
                can.effects, gravity=Gravity(amplitude=(0.0, 0.0, -1.0), phase=math.pi / 2)
            ),
        ).contact(y, mode)
        more = (lifted.force[2] - found.force[2]) / math.sin(can.phi)
        assert more * found.normal_mobility == pytest.approx(1.0, rel=1e-12)


FEW = 200
"""Onsets: some seconds; `python -m tests.onsets` follows thousands."""


@pytest.mark.slow
def test_no_random_onset_crashes_and_in_none_does_the_plane_pull() -> None:
    tally: Tally = campaign(FEW, 1)
    assert tally.faults == []
    assert tally.onsets == FEW
    # many go on, and many lift: a campaign that ends at once would show nothing
    totals = {name: tally.outcomes["at rest", name] for name in ("FINISHED", "LIFTED")}
    assert min(totals.values()) > FEW // 20
    assert {directions for directions, falls in tally.directions if falls} == {1}
    assert {directions for directions, falls in tally.directions if not falls} == {0}
    assert f"| {FEW} |" in page(tally, [0], 1)
