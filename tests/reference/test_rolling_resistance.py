"""Rolling resistance where nothing rolls yet, or no more: it holds, or the can begins to roll."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from reference import PAPER_CAN, Effects, Gravity, Outcome, Problem, Solution, solve
from reference.equations.contact_laws import Kind, Mode
from reference.equations.newton_euler import GeneralEquations
from reference.equations.state_vector import DISSIPATED, SUPPLIED
from reference.nonsmooth.segments import SegmentsPath

ARM = 1e-3
RESISTED = Effects(rolling_resistance=ARM)
REST = Problem(parameters=PAPER_CAN, phi=0.2, duration=2.0, effects=RESISTED)
LOCUS = frozenset({"contact_locus"})
# Energies of size 1.5, a hundred steps each rounded once.
ROUNDED = 1e-13


def general(problem: Problem) -> Solution:
    return solve(problem, model="general", outputs=LOCUS)


def lost(found: Solution, times: np.ndarray) -> np.ndarray:
    """Return what was lost, the balance of energy being checked on the way."""
    assert isinstance(found.path, SegmentsPath)
    rows, _ = found.path.rows(times)
    effects = found.problem.effects
    equations = GeneralEquations(parameters=PAPER_CAN, effects=effects)
    energy = equations.energy(rows, Mode(slips=effects.mu is not None))
    assert np.ptp(energy + rows[DISSIPATED] - rows[SUPPLIED]) < ROUNDED
    force = found.at(times).force
    assert force is not None
    assert np.isfinite(force).all()
    return np.asarray(rows[DISSIPATED])


def planar(phi: float, phi_dot: float, sense: float, times: np.ndarray) -> np.ndarray:
    """Phi of a can that moves in a plane in one sense, by the equation of that alone.

    (a + 1 + h^2) phi'' = -(C - h S) - l N sense with N = 1 + (C - h S) phi'' - (S + h C) phi'^2.
    """
    p = PAPER_CAN

    def rate(_t: float, y: np.ndarray) -> list[float]:
        S, C = math.sin(y[0]), math.cos(y[0])
        reach, height = C - p.h * S, S + p.h * C
        drive = -reach - ARM * sense * (1.0 - height * y[1] ** 2)
        return [y[1], drive / (p.a + 1.0 + p.h**2 + ARM * sense * reach)]

    done = solve_ivp(
        rate, (0.0, times[-1]), [phi, phi_dot], "DOP853", t_eval=times, rtol=1e-13, atol=1e-15
    )
    return np.asarray(done.y[0])


def test_a_leaning_can_released_at_rest_falls_and_loses_the_work_of_the_moment() -> None:
    found = general(REST)
    assert found.outcome is Outcome.FELL_FLAT
    assert found.maxima.tolist() == [0.0]
    times = np.linspace(0.0, 0.9 * found.t_end, 2001)
    states = found.at(times)
    # what scipy's tolerance leaves after a second
    assert np.abs(states.phi - planar(0.2, 0.0, -1.0, times)).max() < 1e-12
    assert states.force is not None
    power = ARM * states.force[:, 2] * np.abs(states.phi_dot)
    # the trapezoidal rule's error, of the square of a two-thousandth
    assert lost(found, times)[-1] == pytest.approx(np.trapezoid(power, times), rel=1e-6)


def test_thrown_up_it_comes_to_rest_at_the_top_and_falls() -> None:
    found = general(replace(REST, phi=0.3, phi_dot=0.1, duration=5.0))
    (top,) = found.maxima
    assert found.outcome is Outcome.FELL_FLAT
    assert found.minima.size == 0
    assert found.at(np.array([top])).phi_dot[0] == 0.0
    up = np.linspace(0.0, top, 50)
    assert np.abs(found.at(up).phi - planar(0.3, 0.1, 1.0, up)).max() < 1e-12
    down = np.linspace(top, 0.9 * found.t_end, 50)
    highest = float(found.at(down[:1]).phi[0])
    assert np.abs(found.at(down).phi - planar(highest, 0.0, -1.0, down - top)).max() < 1e-12
    assert (np.diff(lost(found, np.linspace(0.0, found.t_end, 200))) > 0.0).all()


@pytest.mark.parametrize("side", [-1.0, 1.0])
@pytest.mark.parametrize(("share", "held"), [(0.0, True), (0.999, True), (1.001, False)])
def test_within_the_arm_of_balance_it_stands(share: float, side: float, *, held: bool) -> None:
    """The weight's arm about the contact is |C - h S| = sqrt(1 + h^2) |sin(phi_b - phi)|."""
    off = math.asin(share * ARM / math.hypot(1.0, PAPER_CAN.h))
    phi = PAPER_CAN.balancing_angle - side * off
    found = general(replace(REST, phi=phi, duration=6.0))
    assert found.outcome is Outcome.FINISHED
    times = np.linspace(0.0, 6.0, 30)
    states = found.at(times)
    moved = np.abs(states.phi - phi)
    if held:
        assert moved.max() < 1e-15
        assert lost(found, times)[-1] == 0.0
        assert states.force == pytest.approx(np.tile([0.0, 0.0, 1.0], (30, 1)), abs=1e-15)
    else:
        assert side * (states.phi[-1] - phi) < 0.0
        assert (np.diff(moved) > 0.0).all()


@pytest.mark.slow
def test_it_stands_for_as_long_as_it_is_watched() -> None:
    found = general(replace(REST, phi=PAPER_CAN.balancing_angle, duration=None, bounces=1))
    assert found.outcome is Outcome.STEADY


@pytest.mark.slow
@pytest.mark.parametrize("phi", np.arange(0.05, 0.6, 0.09).round(2).tolist())
def test_what_only_precesses_begins_to_roll(phi: float) -> None:
    """Theta' = 0 turns the can about the vertical, of which round-off leaves a little level."""
    found = general(replace(REST, phi=phi, psi_dot=0.06, duration=None, bounces=1))
    assert found.outcome is Outcome.FINISHED
    assert len(found.bounces) == 1
    assert (np.diff(lost(found, np.linspace(0.0, found.t_end, 100))) > 0.0).all()


def test_a_shaken_can_holds_until_the_push_exceeds_the_arm() -> None:
    """At balance a push A sin(w t) at the height Z of the centre is held while Z A sin(w t) < l."""
    phi, size, rate = PAPER_CAN.balancing_angle, 0.01, 0.3
    gravity = Gravity(amplitude=(size, 0.0, 0.0), rate=rate)
    found = general(
        replace(REST, phi=phi, duration=1.0, effects=replace(RESISTED, gravity=gravity))
    )
    height = math.sin(phi) + PAPER_CAN.h * math.cos(phi)
    begins = math.asin(ARM / (height * size)) / rate
    before, after = np.linspace(0.0, begins * (1 - 1e-9), 20), np.linspace(begins, 1.0, 20)
    assert np.abs(found.at(before).phi - phi).max() < 1e-15
    assert (np.abs(np.diff(found.at(after).phi)) > 0.0).all()
    # the cubic of a push that grows from the edge, over the inertia about the contact
    inertia, late = PAPER_CAN.a + 1.0 + PAPER_CAN.h**2, begins + 1e-2
    grown = height * size * rate * math.cos(rate * begins) * 1e-6 / 6 / inertia
    moved = abs(float(found.at(np.array([late])).phi[0]) - phi)
    assert moved == pytest.approx(grown, rel=0.01)
    # of a level turning of which round-off leaves 1e-30
    assert abs(lost(found, np.array([0.0, begins, 1.0]))[1]) < 1e-30


def test_slip_and_rolling_may_begin_together() -> None:
    found = general(replace(REST, effects=replace(RESISTED, mu=0.05)))
    assert found.outcome is Outcome.FELL_FLAT
    assert found.phases[0].kind is Kind.SLIP
    alone = general(replace(REST, effects=Effects(mu=0.05)))
    assert found.t_end > alone.t_end
    assert (np.diff(lost(found, np.linspace(0.0, found.t_end, 100))) > 0.0).all()


@pytest.mark.slow
@pytest.mark.parametrize("theta_dot", [0.0, 1e-15, 1e-13, 1e-10, 1e-6])
@pytest.mark.parametrize("phi_dot", [0.0, -1e-16, 1e-13, 1e-8])
def test_hardly_rolling_is_followed_too(phi_dot: float, theta_dot: float) -> None:
    effects = Effects(rolling_resistance=ARM, drilling=0.01, mu=0.4)
    release = replace(REST, phi_dot=phi_dot, psi_dot=0.1, theta_dot=theta_dot, duration=1.0)
    found = general(replace(release, effects=effects))
    assert found.outcome is Outcome.FINISHED
    lost(found, np.linspace(0.0, 1.0, 50))
