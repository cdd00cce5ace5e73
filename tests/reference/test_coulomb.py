"""Rolling and slipping with Coulomb friction: limits with their rates, laws, switches."""

import math
from dataclasses import replace

import numpy as np
import pytest

from reference import (
    PAPER_CAN,
    Effects,
    Gravity,
    Kind,
    Outcome,
    Parameters,
    Problem,
    ProblemError,
    Solution,
    solve,
)
from reference.equations.contact_laws import Mode
from reference.equations.newton_euler import GeneralEquations
from reference.equations.reaction_force import centre_position, centre_velocity
from reference.equations.state_vector import DISSIPATED
from reference.nonsmooth.segments import SegmentsPath
from reference.problem.states import Floats

UNIT = math.sqrt(0.037 / 9.81)
GENTLE = Problem(parameters=PAPER_CAN, phi=0.4, psi_dot=2 * UNIT, theta_dot=-UNIT, bounces=1)
# What the bounce of GENTLE needs, from the exact motion.
NEEDED = 0.43265716425626
LOCUS = frozenset({"contact_locus"})


def with_friction(mu: float, problem: Problem = GENTLE) -> Solution:
    return solve(replace(problem, effects=Effects(mu=mu)), model="coulomb", outputs=LOCUS)


@pytest.mark.parametrize("mu", [1.0001 * NEEDED, 0.5, 1.0, 1e3])
def test_with_enough_friction_it_is_rolling(mu: float) -> None:
    found, rolling = with_friction(mu), solve(GENTLE, model="rolling", outputs=LOCUS)
    assert [phase.kind for phase in found.phases] == [Kind.STICK]
    for name in ("time", "phi_min", "angle_of_turn", "rotation_turn", "peak_psi_dot"):
        # two integrators, each at round-off, of a motion that amplifies it tenfold
        assert getattr(found.bounces[0], name) == pytest.approx(
            getattr(rolling.bounces[0], name), rel=1e-12, abs=0
        )
    times = np.linspace(0, 0.999 * rolling.t_end, 300)
    own, other = found.at(times), rolling.at(times)
    for name in ("phi", "psi", "theta", "spin", "x", "y"):
        assert np.abs(getattr(own, name) - getattr(other, name)).max() < 1e-11, name


def test_friction_just_short_of_what_rolling_needs_slips_ever_less() -> None:
    """A lack d of friction is met for a time of sqrt(d); what is slipped away goes as d^2."""
    lacks = np.array([1e-2, 1e-3, 1e-4])
    work, lengths = [], []
    for lack in lacks:
        found = with_friction(NEEDED * (1 - lack))
        stick, slip, again = found.phases
        assert (stick.kind, slip.kind, again.kind) == (Kind.STICK, Kind.SLIP, Kind.STICK)
        lengths.append(slip.end - slip.start)
        work.append(dissipated(found)[-1])
    orders = np.diff(np.log(lengths)) / np.diff(np.log(lacks))
    assert orders == pytest.approx([0.5, 0.5], abs=0.1)
    assert (np.diff(np.log(work)) / np.diff(np.log(lacks)))[-1] == pytest.approx(2.0, abs=0.1)


def test_with_vanishing_friction_it_is_frictionless_with_an_error_of_first_order() -> None:
    sliding = solve(GENTLE, model="frictionless").bounces[0]
    mus = np.array([1e-4, 1e-5, 1e-6])
    errors = [with_friction(mu).bounces[0].angle_of_turn - sliding.angle_of_turn for mu in mus]
    assert np.diff(np.log(errors)) / np.diff(np.log(mus)) == pytest.approx([1.0, 1.0], abs=0.01)


def rows_of(found: Solution, samples: int = 400) -> Floats:
    assert isinstance(found.path, SegmentsPath)
    rows, _ = found.path.rows(np.linspace(0, found.t_end, samples))
    return rows


def dissipated(found: Solution) -> Floats:
    return np.asarray(rows_of(found)[DISSIPATED])


@pytest.mark.parametrize("mu", [0.05, 0.2, 0.3, 0.4, 0.43])
def test_what_friction_takes_is_what_the_energy_loses(mu: float) -> None:
    found = with_friction(mu)
    rows = rows_of(found)
    equations = GeneralEquations(parameters=PAPER_CAN, effects=Effects(mu=mu))
    balance = equations.energy(rows, Mode(slips=True)) + rows[DISSIPATED]
    # terms of size 1.5, a few hundred steps each rounded once
    assert np.ptp(balance) < 1e-13
    assert rows[DISSIPATED, -1] > 0
    assert (np.diff(rows[DISSIPATED]) > -1e-15).all()


@pytest.mark.parametrize("mu", [0.1, 0.3, 0.4])
def test_force_is_in_the_cone_and_against_the_slip_on_its_edge(mu: float) -> None:
    found = with_friction(mu)
    states = found.at(np.linspace(0, found.t_end, 1000)[1:-1])
    assert states.force is not None
    assert states.slip is not None
    friction, normal = states.force[:, :2], states.force[:, 2]
    speed = np.hypot(*states.slip.T)
    slips = speed > 0
    assert slips.any()
    assert (normal > 0).all()
    assert (np.hypot(*friction.T)[~slips] < mu * normal[~slips] * (1 + 1e-12)).all()
    against = -mu * normal[slips, None] * states.slip[slips] / speed[slips, None]
    # where slip is slow its direction is round-off over its speed
    sharp = speed[slips] > 1e-6
    assert np.abs(friction[slips] - against)[sharp].max() < 1e-9


def test_the_force_goes_on_through_the_beginning_of_slip_and_breaks_at_its_end() -> None:
    found = with_friction(0.4)
    _, slip, _ = found.phases

    def jump(time: float) -> float:
        force = found.at(np.array([time - 1e-7, time + 1e-7])).force
        assert force is not None
        return float(np.hypot(*np.diff(force[:, :2], axis=0)[0]))

    assert jump(slip.start) < 1e-5
    assert jump(slip.end) > 1e-2


def test_the_slip_is_the_velocity_of_the_material_at_the_contact() -> None:
    """The velocity of the centre, by differences of its place, less what rolling would make it."""
    found = with_friction(0.2)
    t, dt = np.linspace(0.2, 0.95, 40) * found.t_end, 1e-5
    before, here, after = (found.at(t + shift) for shift in (-dt, 0.0, dt))
    e = found.problem.effects
    places = [centre_position(states, PAPER_CAN, e)[:, :2] for states in (before, after)]
    moved = (places[1] - places[0]) / (2 * dt)
    assert here.slip is not None
    slip = moved - centre_velocity(replace(here, slip=0 * here.slip), PAPER_CAN, e)[:, :2]
    # differences of second order over the third derivative in the bounce, some 1e4
    assert np.abs(slip - here.slip).max() < 1e-5


def test_sliding_turns_into_rolling_as_on_paper() -> None:
    """A wheel that stands upright and is pushed along rolls after u/(mu g (1 + 1/c)), by hand.

    Friction takes mu g from the speed of its centre and gives mu g/c to that of its rim.
    """
    wheel = Parameters(a=0.5, c=0.9, h=1e-6)
    problem = Problem(
        parameters=wheel,
        phi=wheel.balancing_angle,
        theta_dot=0.5,
        slip=(0.0, 0.3),
        duration=2.0,
        effects=Effects(mu=0.1),
    )
    for model in ("coulomb", "general"):
        found = solve(problem, model=model, outputs=LOCUS)
        slip, roll = found.phases
        assert (slip.kind, roll.kind) == (Kind.SLIP, Kind.STICK)
        # the lean of 1e-6 makes it no better
        assert slip.end == pytest.approx(0.3 / (0.1 * (1 + 1 / 0.9)), rel=1e-10)
        after = found.at(np.array([slip.end, 2.0]))
        assert after.theta_dot == pytest.approx(0.5 + 0.1 * slip.end / 0.9, rel=1e-9)


def test_a_release_slips_only_where_friction_is_declared() -> None:
    with pytest.raises(ProblemError) as refused:
        replace(GENTLE, slip=(0.1, 0.0))
    assert (refused.value.key, refused.value.value) == ("slip", (0.1, 0.0))


def test_a_can_that_would_have_to_be_pulled_leaves_the_plane() -> None:
    """A plane that falls away faster than the can: up to 1.5 g."""
    shaken = Effects(mu=0.8, gravity=Gravity(amplitude=(0.0, 0.0, 1.5), rate=2.0))
    found = solve(replace(GENTLE, effects=shaken), outputs=LOCUS)
    assert found.outcome is Outcome.LIFTED
    # when its weight in the plane's frame is about to vanish, a little before if it turns
    assert found.t_end == pytest.approx(math.asin(1 / 1.5) / 2, rel=0.1)
    force = found.at(np.array([0.0, found.t_end])).force
    assert force is not None
    # a root found to round-off
    assert abs(force[1, 2]) < 1e-13 * force[0, 2]


def test_a_can_that_is_thrown_up_does_not_begin_to_roll() -> None:
    for effects in (Effects(mu=0.0), Effects(mu=0.5)):
        thrown = replace(GENTLE, phi_dot=3.0, effects=effects)
        found = solve(thrown, outputs=LOCUS)
        assert found.outcome is Outcome.LIFTED
        assert found.t_end == 0


@pytest.mark.slow
def test_cusps_do_not_lift_but_slip_whatever_the_friction() -> None:
    """Rolling asks for N of -3000 m g there, and before N vanishes for infinite friction."""
    fast = replace(GENTLE, phi=math.pi / 100, psi_dot=1.7267 * UNIT, theta_dot=7 * UNIT)
    for mu in (0.6, 100.0):
        found = with_friction(mu, fast)
        assert found.outcome is Outcome.FINISHED
        assert [phase.kind for phase in found.phases][:2] == [Kind.STICK, Kind.SLIP]
