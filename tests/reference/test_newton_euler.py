"""The general can: each effect against what is known of it in closed form, or in the limit."""

import math
from dataclasses import replace

import numpy as np
import pytest

from reference import (
    PAPER_CAN,
    Effects,
    Gravity,
    Mass,
    Outcome,
    Parameters,
    Problem,
    Solution,
    divergence,
    solve,
)
from reference.equations.contact_laws import Mode
from reference.equations.newton_euler import GeneralEquations
from reference.equations.state_vector import DISSIPATED, SUPPLIED
from reference.nonsmooth.segments import SegmentsPath

UNIT = math.sqrt(0.037 / 9.81)
GENTLE = Problem(parameters=PAPER_CAN, phi=0.4, psi_dot=2 * UNIT, theta_dot=-UNIT, bounces=1)
LOCUS = frozenset({"contact_locus"})
NAMES = ("phi", "psi", "theta", "spin", "x", "y")
TILT = Gravity(constant=(0.05 * 0.6, 0.05 * 0.8, -math.sqrt(1 - 0.05**2)))
SHAKE = Gravity(amplitude=(0.1, 0.05, 0.2), rate=3.0, phase=0.4)
MASS = Mass(share=0.05, x=0.4, y=0.2, z=0.3)


def general(effects: Effects, problem: Problem = GENTLE) -> Solution:
    return solve(replace(problem, effects=effects), model="general", outputs=LOCUS)


def apart(one: Solution, other: Solution, names: tuple[str, ...] = NAMES) -> float:
    times = np.linspace(0, 0.999 * min(one.t_end, other.t_end), 200)
    own, seen = one.at(times), other.at(times)
    return max(float(np.abs(getattr(own, n) - getattr(seen, n)).max()) for n in names)


def test_without_effects_it_is_rolling() -> None:
    # two integrators, each at round-off, of a motion that amplifies it tenfold
    assert apart(general(Effects()), solve(GENTLE, model="rolling", outputs=LOCUS)) < 1e-12


@pytest.mark.parametrize("mu", [0.1, 0.3, 0.4])
def test_with_friction_alone_it_is_coulomb(mu: float) -> None:
    """Two tellings: closed formulas of an axisymmetric can, and a linear system of six rows."""
    effects = Effects(mu=mu)
    closed = solve(replace(GENTLE, effects=effects), model="coulomb", outputs=LOCUS)
    found = general(effects)
    assert apart(found, closed) < 1e-12
    assert [p.kind for p in found.phases] == [p.kind for p in closed.phases]
    assert [p.end for p in found.phases] == pytest.approx([p.end for p in closed.phases], rel=1e-12)


VANISHING = {
    "damping": lambda e: Effects(linear_damping=e, angular_damping=0.5 * e),
    "tilt": lambda e: Effects(gravity=Gravity(constant=(e, 0.0, -math.sqrt(1 - e * e)))),
    "shake": lambda e: Effects(gravity=Gravity(amplitude=(e, 0.0, e), rate=3.0)),
    "mass": lambda e: Effects(mass=Mass(share=e, x=0.4, y=0.2, z=0.3)),
    "rim": lambda e: Effects(rim=e),
    "drilling": lambda e: Effects(drilling=e),
    "rolling_resistance": lambda e: Effects(rolling_resistance=e),
}


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=() if name in {"mass", "tilt", "drilling"} else pytest.mark.slow)
        for name in VANISHING
    ],
)
def test_each_effect_vanishes_with_its_size(name: str) -> None:
    ideal = solve(GENTLE, model="rolling", outputs=LOCUS)
    sizes = np.array([1e-4, 1e-5])
    errors = [apart(general(VANISHING[name](size)), ideal) for size in sizes]
    order = np.diff(np.log(errors))[0] / np.diff(np.log(sizes))[0]
    assert order == pytest.approx(1.0, abs=0.02)


@pytest.mark.parametrize(
    "effects",
    [
        Effects(gravity=TILT),
        Effects(gravity=SHAKE),
        Effects(mass=MASS),
        Effects(rim=0.1),
        Effects(linear_damping=0.05, angular_damping=0.02),
        Effects(drilling=0.01),
        Effects(rolling_resistance=0.002),
        Effects(
            mu=0.3,
            linear_damping=0.05,
            angular_damping=0.02,
            rim=0.05,
            mass=MASS,
            drilling=0.01,
            rolling_resistance=0.002,
            gravity=Gravity(constant=TILT.constant, amplitude=SHAKE.amplitude, rate=3.0),
        ),
    ],
    ids=lambda effects: "+".join(effects.declared()),
)
def test_energy_is_what_was_there_less_what_was_lost_plus_what_was_supplied(
    effects: Effects,
) -> None:
    found = general(effects, replace(GENTLE, bounces=None, duration=4.0))
    assert isinstance(found.path, SegmentsPath)
    rows, _ = found.path.rows(np.linspace(0, found.t_end, 300))
    equations = GeneralEquations(parameters=PAPER_CAN, effects=effects)
    energy = equations.energy(rows, Mode(slips=effects.mu is not None))
    balance = energy + rows[DISSIPATED] - rows[SUPPLIED]
    # terms of size 1.5, a few hundred steps each rounded once
    assert np.ptp(balance) < 1e-13
    assert (np.diff(rows[DISSIPATED]) > -1e-15).all()
    assert (np.ptp(energy) > 1e-4) == bool(
        {"damping", "drilling", "rolling_resistance", "shake", "slip"} & set(effects.declared())
    )


BALL = Parameters(a=0.4, c=0.4, h=1.0)  # whose rim is rounded until nothing else is left


@pytest.mark.parametrize(("mu", "acceleration"), [(None, 5 / 7), (0.5, 5 / 7), (0.05, None)])
def test_a_ball_on_a_tilted_plane(mu: float | None, acceleration: float | None) -> None:
    """A rim rounded to its radius is a ball: 5/7 g sin a where it rolls, else g (sin a - mu cos a).

    The plane is tilted by 15 degrees; rolling asks for a friction of 2/7 tan a = 0.077.
    """
    tilt = math.radians(15)
    down = np.array([math.cos(0.3), math.sin(0.3)])
    gravity = Gravity(
        constant=(math.sin(tilt) * down[0], math.sin(tilt) * down[1], -math.cos(tilt))
    )
    problem = Problem(
        parameters=BALL,
        phi=0.7,
        duration=1.0,
        effects=Effects(mu=mu, gravity=gravity, rim=1.0),
    )
    found = solve(problem, model="general", outputs=LOCUS)
    expected = acceleration or 1.0
    expected *= math.sin(tilt)
    if acceleration is None:
        assert mu is not None
        expected = math.sin(tilt) - mu * math.cos(tilt)
    times = np.linspace(0, found.t_end, 50)
    states = found.at(times)
    assert states.x is not None
    assert states.y is not None
    moved = np.stack([states.x, states.y], axis=1)
    moved -= moved[0]
    # ten roundings of a path of a tenth
    assert np.abs(moved - expected / 2 * times[:, None] ** 2 * down).max() < 1e-13


def test_a_mass_on_the_axis_is_another_axisymmetric_can() -> None:
    """A share q at z on the axis moves the centre of mass by q z/(1 + q): a can of another h."""
    q, z = 0.2, 0.5
    shift = q * z / (1 + q)
    p = PAPER_CAN
    other = Parameters(a=(p.a + q / (1 + q) * z * z) / (1 + q), c=p.c / (1 + q), h=p.h + shift)
    found = general(Effects(mass=Mass(share=q, z=z)))
    closed = solve(replace(GENTLE, parameters=other), model="rolling", outputs=LOCUS)
    assert apart(found, closed, ("phi", "psi", "theta", "spin")) < 1e-12
    # the centre of the can is over the origin, which the shifted centre of mass is not
    lag = shift * math.sin(GENTLE.phi)
    times = np.linspace(0, closed.t_end, 50)
    own, seen = found.at(times), closed.at(times)
    assert own.x is not None
    assert seen.x is not None
    assert np.abs(own.x - seen.x + lag * math.cos(GENTLE.psi)).max() < 1e-12


def test_a_mass_turned_with_the_can_is_a_release_turned() -> None:
    """Where x points to is a matter of theta at the release."""
    angle = 0.8
    turned = Mass(share=0.1, x=0.5 * math.cos(angle), y=0.5 * math.sin(angle))
    one = general(Effects(mass=turned), replace(GENTLE, bounces=None, duration=4.0))
    other = general(
        Effects(mass=Mass(share=0.1, x=0.5)),
        replace(GENTLE, theta=angle, bounces=None, duration=4.0),
    )
    assert apart(one, other, ("phi", "psi", "spin", "x", "y")) < 1e-12


def test_a_vertical_shake_that_is_slow_is_another_gravity() -> None:
    """At rate 0 and phase pi/2 the shaking is constant: gravity (1 - e) g, time scaled by it."""
    weaker = 0.3
    shaken = general(
        Effects(gravity=Gravity(amplitude=(0.0, 0.0, weaker), rate=0.0, phase=math.pi / 2))
    )
    unit = math.sqrt(1 - weaker)
    scaled = replace(GENTLE, psi_dot=GENTLE.psi_dot / unit, theta_dot=GENTLE.theta_dot / unit)
    closed = solve(scaled, model="rolling")
    assert shaken.bounces[0].angle_of_turn == pytest.approx(
        closed.bounces[0].angle_of_turn, rel=1e-13, abs=0
    )
    assert shaken.bounces[0].time * unit == pytest.approx(closed.bounces[0].time, rel=1e-13, abs=0)


def test_a_planar_fall_is_the_pendulum() -> None:
    """Nothing turns: the can falls flat, when the closed form says, and says so."""
    planar = Problem(parameters=PAPER_CAN, phi=0.3, duration=3.0)
    closed = solve(planar, model="pendulum", outputs=LOCUS)
    assert closed.outcome is Outcome.FELL_FLAT
    for model in ("coulomb", "general"):
        found = solve(planar, model=model, outputs=LOCUS)
        assert found.outcome is Outcome.FELL_FLAT
        # phi goes to zero steeply there
        assert found.t_end == pytest.approx(closed.t_end, rel=1e-13, abs=0)
        assert apart(found, closed) < 1e-13


def test_damping_decays_as_declared_where_nothing_else_acts() -> None:
    """A ball that slides without friction: v exp(-l t), w exp(-k t)."""
    problem = Problem(
        parameters=BALL,
        phi=0.7,
        psi_dot=0.5,
        slip=(0.3, 0.1),
        duration=2.0,
        effects=Effects(mu=1e-300, linear_damping=0.2, angular_damping=0.3, rim=1.0),
    )
    found = solve(problem, model="general", outputs=LOCUS)
    times = np.linspace(0, 2, 20)
    states = found.at(times)
    # of a ball that turns about the vertical phi stays: it is psi that turns
    assert states.psi_dot == pytest.approx(0.5 * np.exp(-0.3 * times), rel=1e-12, abs=0)
    assert states.slip is not None
    start = np.array([0.3, 0.1])
    assert states.slip == pytest.approx(start * np.exp(-0.2 * times)[:, None], abs=1e-13)


@pytest.mark.slow
def test_drilling_stops_a_spinning_ball_and_holds_it() -> None:
    """Moment l N against the turning: w falls at l/c, and stays at rest."""
    length, spin = 0.02, 0.04
    problem = Problem(
        parameters=BALL,
        phi=0.7,
        psi_dot=spin,
        duration=2.0,
        effects=Effects(drilling=length, rim=1.0),
    )
    found = solve(problem, model="general", outputs=LOCUS)
    stop = spin * 0.4 / length
    times = np.array([0.25 * stop, 0.75 * stop, 1.5 * stop, 2.0])
    expected = np.maximum(spin * (1 - times / stop), 0.0)
    assert found.at(times).psi_dot == pytest.approx(expected, abs=1e-15)


def test_copies_of_a_regular_motion_part_like_time() -> None:
    regular = divergence(replace(GENTLE, bounces=None, duration=10.0, effects=Effects(mass=MASS)))
    assert not regular.chaotic
    assert 1 < regular.growth < 1e4


@pytest.mark.slow
def test_copies_of_a_chaotic_motion_part_exponentially() -> None:
    """The release and the plane of the scene "chaotic-can", for five seconds."""
    rate = 2 * math.pi * 3.9
    push = rate * rate / 9.81
    chaotic = Problem(
        parameters=PAPER_CAN,
        phi=0.26,
        psi_dot=-0.4 * UNIT,
        duration=5.0 / UNIT,
        effects=Effects(
            mass=Mass(share=0.1, x=0.5),
            gravity=Gravity(amplitude=(0.001 * push, 0.0, 0.0032 * push), rate=rate * UNIT),
        ),
    )
    found = divergence(chaotic)
    assert found.chaotic
    # a Lyapunov time of 0.4 s in six seconds, less sharply known from five
    assert 0.2 < UNIT / found.rate < 0.7
    assert 4.0 < found.parted * UNIT < 15.0
    assert found.distance[-1] > 1e3 * found.distance[found.times.size // 4]
