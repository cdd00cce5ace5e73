"""A contact that gives way: drops in closed form, the rigid limit, and another formulation.

The can balanced on its rim has its centre above the contact point, so that a drop of it is that of
a mass on a spring, along a line.
"""

import math
from dataclasses import replace

import numpy as np
import pytest
import scipy

from reference import (
    PAPER_CAN,
    Compliance,
    EffectError,
    Effects,
    Gravity,
    Kind,
    Mass,
    Outcome,
    Problem,
    ProblemError,
    Solution,
    SolverError,
    solve,
)
from reference.equations.contact_laws import Phase
from reference.equations.reaction_force import centre_position
from reference.nonsmooth import hybrid_integrator
from tests.support.soft_contact import energies, random_problem, six_degrees_of_freedom

EPS = float(np.finfo(float).eps)
HEIGHT = 0.01
SPEED = math.sqrt(2 * HEIGHT)
ROCKING = Problem(parameters=PAPER_CAN, phi=0.3, psi_dot=0.2, bounces=1)
TILTED = Gravity(constant=(0.03, 0.04, -math.sqrt(1 - 0.05**2)))
TUMBLING = Problem(
    parameters=PAPER_CAN,
    phi=0.35,
    psi=0.2,
    psi_dot=0.4,
    theta_dot=-0.3,
    phi_dot=-0.1,
    duration=0.9,
)
LOCUS = frozenset({"contact_locus"})


def soft(problem: Problem, law: Compliance, height: float = 0.0) -> Solution:
    effects = replace(problem.effects, compliance=law)
    return solve(replace(problem, effects=effects, height=height), outputs=LOCUS)


def dropped(law: Compliance) -> tuple[Solution, Phase]:
    """Return the drop of a balanced can, and its first contact."""
    upright = Problem(parameters=PAPER_CAN, phi=PAPER_CAN.balancing_angle, duration=0.3)
    found = soft(upright, law, HEIGHT)
    fall, contact = found.phases[:2]
    assert (fall.kind, contact.kind) == (Kind.FLIGHT, Kind.STICK)
    assert fall.end == pytest.approx(SPEED, rel=4 * EPS)
    return found, contact


def deepest(found: Solution, contact: Phase) -> float:
    gap = found.at(np.linspace(contact.start, contact.end, 4001)).gap
    assert gap is not None
    return float(-gap.min())


@pytest.mark.parametrize("stiffness", [1e3, 1e5, 1e8])
def test_a_drop_on_a_linear_spring_is_a_half_swing_about_its_rest(stiffness: float) -> None:
    found, contact = dropped(Compliance(stiffness=stiffness))
    rate, rest = math.sqrt(stiffness), 1 / stiffness
    # d = rest (1 - cos rate t) + SPEED/rate sin rate t, zero again where tan(rate t/2) < 0
    lasts = 2 * (math.pi - math.atan(SPEED * rate)) / rate
    assert contact.end - contact.start == pytest.approx(lasts, rel=1e-12, abs=8 * EPS)
    amplitude = math.hypot(rest, SPEED / rate)
    assert deepest(found, contact) == pytest.approx(rest + amplitude, rel=1e-6)
    rise = found.at(contact.end).rise
    assert rise is not None
    assert rise[0] == pytest.approx(SPEED, rel=1e-12)


def test_a_damper_takes_what_a_damped_swing_loses() -> None:
    stiffness, damping = 1e5, 60.0
    found, contact = dropped(Compliance(stiffness=stiffness, damping=damping))
    loss = damping / 2
    rate, rest = math.sqrt(stiffness - loss**2), 1 / stiffness

    def depth(t: float) -> float:
        swing = -rest * math.cos(rate * t) + (SPEED - loss * rest) / rate * math.sin(rate * t)
        return rest + math.exp(-loss * t) * swing

    def force(t: float) -> float:
        swing = (SPEED - loss * rest) * math.cos(rate * t) + rest * rate * math.sin(rate * t)
        back = math.exp(-loss * t) * swing - loss * (depth(t) - rest)
        return stiffness * depth(t) + damping * back

    # the contact ends where its force does, which is before the rim is out of the plane
    ends = scipy.optimize.brentq(force, 1.0 / rate, math.pi / rate, xtol=1e-16)
    assert contact.end - contact.start == pytest.approx(ends, rel=1e-11)
    at_end = found.at(contact.end).gap
    assert at_end is not None
    assert -at_end[0] == pytest.approx(depth(ends), rel=1e-10)
    assert at_end[0] < 0


def test_a_drop_on_hertz_is_what_its_energy_says() -> None:
    stiffness = 1e7
    found, contact = dropped(Compliance(stiffness=stiffness, exponent=1.5))

    def kinetic(depth: float) -> float:
        return HEIGHT + depth - stiffness * math.pow(depth, 2.5) / 2.5

    top = scipy.optimize.brentq(kinetic, 1e-9, 1e-2, xtol=1e-18)
    assert deepest(found, contact) == pytest.approx(top, rel=1e-6)

    def slowness(u: float) -> float:
        # depth = top (1 - u^2), without the root's pole at the deepest point
        return float(2 * top * u / math.sqrt(2 * kinetic(top * (1 - u * u))))

    half, _ = scipy.integrate.quad(slowness, 0, 1, epsrel=1e-11)
    assert contact.end - contact.start == pytest.approx(2 * half, rel=1e-10)


@pytest.mark.parametrize(
    "effects",
    [
        Effects(),
        Effects(mu=0.3, rim=0.1, drilling=1e-3),
        Effects(mu=0.4, rolling_resistance=1e-3, linear_damping=0.02),
        Effects(
            mu=0.5,
            mass=Mass(share=0.1, x=0.4, y=0.2, z=0.3),
            gravity=Gravity(amplitude=(0.1, 0.05, 0.2), rate=3.0, phase=0.4),
        ),
        Effects(contour=0.01, contour_damping=2e-3, film=2e-4, boundary_layer=1e-3),
        Effects(mu=0.4, mu_static=0.5, contour=0.01, film=2e-4, rim=0.1),
        Effects(mu=0.3, mu_static=0.35, patch=0.03, boundary_layer=1e-3, rolling_resistance=1e-3),
    ],
)
@pytest.mark.parametrize("exponent", [1.0, 1.5])
def test_what_is_there_and_what_is_lost_sum_to_what_was_there(
    effects: Effects, exponent: float
) -> None:
    law = Compliance(stiffness=1e3**exponent, damping=3 * 1e2 ** (exponent - 1), exponent=exponent)
    falling = replace(ROCKING, bounces=None, duration=0.7, effects=effects)
    found = soft(falling, law, 0.02)
    assert found.outcome is Outcome.FINISHED
    assert {Kind.FLIGHT} < {phase.kind for phase in found.phases}
    whole = energies(found)
    assert np.ptp(whole) < 1e-12 * np.abs(whole).max()


@pytest.mark.parametrize("exponent", [1.0, 1.5])
def test_the_rigid_can_is_the_limit_at_the_rate_of_the_depth_at_rest(exponent: float) -> None:
    """What is softer sinks by its depth at rest, k^(-1/n): the bounce differs by a multiple of it.

    Damped at half the critical rate, so that vibrations of the release are over at the bounce.
    """
    rigid = solve(ROCKING).bounces[0]
    depths = np.array([1e-4, 1e-5, 1e-6, 1e-7])
    differences = []
    for depth in depths:
        stiffness = depth**-exponent
        damping = math.sqrt(exponent / depth) / (1 if exponent == 1 else depth**exponent)
        law = Compliance(stiffness=stiffness, damping=damping, exponent=exponent)
        own = soft(ROCKING, law).bounces[0]
        differences.append((own.angle_of_turn - rigid.angle_of_turn, own.phi_min - rigid.phi_min))
    slopes = np.diff(np.log(np.abs(differences)), axis=0) / np.diff(np.log(depths))[:, None]
    # the next order is the square root of the depth, the time of a vibration
    assert slopes[-1] == pytest.approx(1.0, abs=0.01)
    assert slopes == pytest.approx(1.0, abs=0.06)


@pytest.mark.parametrize("exponent", [1.0, 1.5])
@pytest.mark.parametrize(
    "laws",
    [
        Effects(),
        Effects(mu=0.0),
        Effects(mu=0.3),
        Effects(contour=0.01, contour_damping=2e-3, film=2e-4, boundary_layer=1e-3),
        Effects(mu=0.3, contour_damping=2e-3, film=1e-3),
        Effects(mu=0.3, patch=0.1, contour_damping=2e-3),
    ],
)
def test_a_body_of_six_degrees_of_freedom_moves_likewise(exponent: float, laws: Effects) -> None:
    """The same law by another route: a quaternion, forces in the world, an explicit method."""
    law = Compliance(stiffness=300.0**exponent, damping=2.0, exponent=exponent)
    effects = replace(laws, gravity=TILTED, compliance=law, angular_damping=0.05)
    mu = laws.mu
    slip = (0.9, 0.6) if mu is not None else (0.0, 0.0)
    problem = replace(TUMBLING, effects=effects, slip=slip)
    found = solve(problem, outputs=LOCUS)
    expected = Kind.STICK if mu is None else Kind.SLIP
    assert [phase.kind for phase in found.phases] == [expected]
    moves_likewise(found, problem, 0.0, 0.9)


def test_static_friction_holds_a_soft_contact_up_to_its_limit_and_then_kinetic_acts() -> None:
    law = Compliance(stiffness=300.0, damping=2.0)
    laws = Effects(mu=0.18, mu_static=0.21, contour_damping=1e-3)
    problem = replace(TUMBLING, phi_dot=0.0, effects=replace(laws, compliance=law))
    found = solve(problem, outputs=LOCUS)
    stick, slip = found.phases[:2]
    assert (stick.kind, slip.kind) == (Kind.STICK, Kind.SLIP)
    held = replace(problem, effects=replace(problem.effects, mu=None, mu_static=None))
    moves_likewise(found, held, 0.0, stick.end)
    force = found.at(np.array([stick.end * (1 - 1e-12)])).force
    assert force is not None
    assert np.hypot(*force[0, :2]) / force[0, 2] == pytest.approx(0.21, rel=1e-7)
    moves_likewise(found, problem, slip.start + 0.1 * (slip.end - slip.start), slip.end)


def moves_likewise(found: Solution, problem: Problem, first: float, last: float) -> None:
    times = np.linspace(first, last, 7)
    own = found.at(times)
    centre, turned = six_degrees_of_freedom(problem, own, times - first)
    np.testing.assert_allclose(
        centre_position(own, PAPER_CAN, problem.effects), centre, rtol=0, atol=2e-12
    )
    S, C = np.sin(own.phi), np.cos(own.phi)
    axis = np.stack([-S * np.cos(own.psi), -S * np.sin(own.psi), C], axis=-1)
    np.testing.assert_allclose(axis, turned, rtol=0, atol=2e-12)


def test_the_release_is_as_deep_as_bears_the_force_of_a_rigid_contact() -> None:
    law = Compliance(stiffness=1e4, exponent=1.5, damping=1.0)
    own = soft(ROCKING, law).at(0.0)
    rigid = solve(ROCKING, model="general", outputs=LOCUS).at(0.0)
    assert own.force is not None
    assert own.rise is not None
    assert rigid.force is not None
    assert own.force[0] == pytest.approx(rigid.force[0], rel=1e-12)
    assert own.rise[0] == 0.0


@pytest.mark.parametrize(
    ("law", "key"),
    [
        ({"stiffness": 0.0}, "stiffness"),
        ({"stiffness": 1.0, "damping": -1.0}, "damping"),
        ({"stiffness": 1.0, "exponent": 2.5}, "exponent"),
        ({"stiffness": 1.0, "exponent": 0.5}, "exponent"),
    ],
)
def test_a_law_that_is_no_spring_is_refused(law: dict[str, float], key: str) -> None:
    with pytest.raises(EffectError) as caught:
        Compliance(**law)
    assert caught.value.key == key


def test_what_does_not_go_together_is_refused() -> None:
    with pytest.raises(ProblemError, match="height"):
        replace(ROCKING, height=0.1)
    with pytest.raises(SolverError, match="too small"):
        solve(
            replace(ROCKING, effects=Effects(compliance=Compliance(stiffness=1e3))), model="general"
        )
    with pytest.raises(SolverError, match=r"needs `effects\.compliance`"):
        solve(ROCKING, model="compliant")


def test_too_stiff_a_vibration_is_said_to_be_too_much_work(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(hybrid_integrator, "MOST_WORK", 4000)
    hard = Compliance(stiffness=1e9)
    found = soft(replace(ROCKING, bounces=None, duration=3.0), hard, 1e-3)
    assert found.outcome is Outcome.VIBRATES
    assert 0 < found.t_end < 3.0


@pytest.mark.parametrize("exponent", [1.0, 1.5, 2.0])
@pytest.mark.parametrize("mu", [None, 0.3])
def test_a_rim_that_is_pulled_out_faster_than_the_surface_follows_stays_where_it_is(
    exponent: float, mu: float | None
) -> None:
    """Contact ends and begins at a depth: neither the depth nor its energy jumps."""
    law = Compliance(stiffness=100.0, damping=1000.0 if exponent > 1 else 30.0, exponent=exponent)
    effects = Effects(mu=mu, gravity=Gravity(amplitude=(0.0, 0.0, 3.0), rate=6.0))
    found = soft(replace(ROCKING, bounces=None, duration=2.5, effects=effects), law)
    lifts = [phase.start for phase in found.phases if phase.kind is Kind.FLIGHT]
    gap = found.at(np.array(lifts)).gap
    assert gap is not None
    assert gap.min() < -0.01
    whole = energies(found)
    assert np.ptp(whole) < 1e-12 * np.abs(whole).max()


def test_friction_that_stops_the_rim_may_throw_it_up_again() -> None:
    """A rim that cannot slip lands turning: the impulse along the plane lifts what it stops."""
    rod = replace(PAPER_CAN, a=1.2, c=1.8, h=1.9)
    falls = Problem(
        parameters=rod, phi=0.72, phi_dot=0.8, psi_dot=0.16, theta_dot=0.6, duration=0.3
    )
    found = soft(falls, Compliance(stiffness=1e4, exponent=1.5), 1e-3)
    assert found.outcome is Outcome.FINISHED
    assert found.phases[0].kind is Kind.FLIGHT
    whole = energies(found)
    assert np.ptp(whole) < 1e-12 * np.abs(whole).max()


def test_a_rim_that_never_slips_may_have_no_one_way_to_leave_a_damper() -> None:
    """Its friction does not vanish with the normal force; that of a large coefficient does."""
    problem = random_problem(38)
    found = solve(problem)
    assert problem.effects.mu is None
    assert found.outcome is Outcome.INDETERMINATE
    late = []
    for mu in (1e2, 1e3, 1e4):
        slips = solve(replace(problem, effects=replace(problem.effects, mu=mu)))
        stick, slip = slips.phases
        assert (stick.kind, slip.kind) == (Kind.STICK, Kind.SLIP)
        assert slips.outcome is Outcome.FELL_FLAT
        late.append(found.t_end - slip.start)
    # the limit of large coefficients slips from that instant on: it is no rim that never slips
    assert late[0] / late[1] == pytest.approx(10, rel=0.05)
    assert late[1] / late[2] == pytest.approx(10, rel=0.05)


def test_a_first_maximum_after_a_small_rise_counts() -> None:
    """Before phi has left the release, a minimum, by a hundredth; on either side of a rate of 0."""
    release = Problem(parameters=PAPER_CAN, phi=0.4, psi_dot=0.123, theta_dot=-0.0614, bounces=1)
    law = Compliance(stiffness=100.0, damping=8.0)
    slow, still, fast = (
        soft(replace(release, phi_dot=rate), law, HEIGHT) for rate in (-1e-5, 0.0, 1e-5)
    )
    assert slow.maxima == pytest.approx((still.maxima + (still.maxima - fast.maxima)), rel=1e-6)
    assert 0.14 < still.maxima[0] < 0.15
    assert still.minima.size == 1


def test_a_contact_point_that_friction_holds_is_free_in_the_air() -> None:
    law, release = Compliance(stiffness=1e4), replace(ROCKING, bounces=None, duration=0.3)
    flown = soft(replace(release, effects=Effects(contour=0.01)), law, 0.05).at(0.25)
    alone = soft(release, law, 0.05).at(0.25)
    assert flown.theta_dot[0] == alone.theta_dot[0]
    assert flown.psi[0] == alone.psi[0]
