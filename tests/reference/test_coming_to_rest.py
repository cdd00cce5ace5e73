"""How a disk that spins down comes to lie flat: exponents from theory, fitted to exact motions."""

import math
from dataclasses import replace

import numpy as np
import pytest
import sympy

from reference import (
    PAPER_CAN,
    Effects,
    Outcome,
    Problem,
    Solution,
    coming_to_rest,
    is_regular,
    solve,
)
from reference.analysis.coming_to_rest import _limit, powers
from reference.equations.nonholonomic import nutation_acceleration
from reference.equations.steady_motion import steady_rotation
from reference.nonsmooth import hybrid_integrator
from reference.problem.can import Parameters
from tests.support.compiled import needs_numba

DISK = Parameters(a=0.25 + 0.01**2 / 3, c=0.5, h=0.01)


def spun(effects: Effects, phi: float = 0.05) -> Solution:
    """Solve a disk from steady rolling about a centre at rest."""
    still = math.cos(phi) - DISK.h * math.sin(phi)

    def pull(psi_dot: float) -> float:
        spin = psi_dot * (1 - still)
        return float(
            nutation_acceleration(np.array([phi]), np.array([psi_dot]), np.array([spin]), DISK)[0]
        )

    # phi'' is a constant plus a multiple of psi'^2 where the centre rests
    psi_dot = math.sqrt(pull(0.0) / (pull(0.0) - pull(1.0)))
    return solve(
        Problem(
            parameters=DISK,
            phi=phi,
            psi_dot=psi_dot,
            theta_dot=-psi_dot * still,
            duration=500.0,
            effects=effects,
        )
    )


def derived(power: sympy.Expr, phi: sympy.Symbol) -> sympy.Expr:
    """Return p of phi = A (t_s - t)^p, from 3/2 phi' = -power at leading order; 0 if none."""
    q = sympy.limit(phi * sympy.diff(sympy.log(power), phi), phi, 0, "+")
    return 1 / (1 - q) if q < 1 else sympy.Integer(0)


def test_exponents_follow_from_steady_rolling() -> None:
    phi, h, a = sympy.symbols("phi h a", positive=True)
    S, C = sympy.sin(phi), sympy.cos(phi)
    # centre at rest: w along the line from the contact to it, w3 = h w1 with w1 = psi' S
    psi = sympy.Symbol("psi", positive=True)
    theta = -psi * (C - h * S)
    c = 2 * a
    # Euler about e2 with the weight's moment: (a w1^2 C/S - c w1 w3) = C - h S
    w1 = psi * S
    steady = sympy.solve(a * w1**2 * C / S - c * w1 * h * w1 - (C - h * S), psi**2)[0]
    energy = (a * w1**2 + c * (h * w1) ** 2) / 2 + S + h * C - h
    energy = energy.subs(psi, sympy.sqrt(steady))
    assert sympy.simplify(sympy.limit(energy / phi, phi, 0)) == sympy.Rational(3, 2) + h**2
    rate = sympy.Abs(theta).subs(psi, sympy.sqrt(steady)).subs({a: sympy.Rational(1, 4)})
    rate = rate.subs(h, sympy.Rational(1, 100))
    assert sympy.limit(rate * sympy.sqrt(phi), phi, 0, "+") == 2
    theta_dot = 2 / sympy.sqrt(phi)
    laws = {
        "dry contour friction": theta_dot,
        "viscous contour friction": theta_dot**2,
        "film of air": theta_dot**2 / S,
        "boundary layers of air": theta_dot ** sympy.Rational(5, 2),
        "rolling resistance": theta_dot * S,
    }
    expected = {
        "dry contour friction": sympy.Rational(2, 3),
        "viscous contour friction": sympy.Rational(1, 2),
        "film of air": sympy.Rational(1, 3),
        "boundary layers of air": sympy.Rational(4, 9),
        "rolling resistance": sympy.Integer(2),
    }
    everything = Effects(contour_damping=1.0, film=1.0, boundary_layer=1.0, rolling_resistance=1.0)
    ours = powers(everything) | powers(Effects(contour=1.0))
    assert set(ours) == set(laws)
    for name, power in laws.items():
        assert derived(power, phi) == expected[name]
        assert 1 / (1 - ours[name]) == pytest.approx(float(expected[name]))
    # what takes w or its part about the normal, w_z = psi' + theta' C, takes less and less
    about = sympy.series(theta_dot * (1 - (C - h * S) * C), phi, 0, 1).removeO()
    assert derived(about, phi) == 2  # drilling of a disk with a height
    assert derived(about.subs(h, 0) + theta_dot * phi**2, phi) == 0  # of one without: no end
    assert derived((theta_dot * S) ** 2, phi) == 0  # damping: no end


@pytest.mark.parametrize(
    ("effects", "exponent"),
    [
        (Effects(contour=1e-4), 2 / 3),
        (Effects(contour_damping=1e-5), 1 / 2),
        (Effects(boundary_layer=3e-6), 4 / 9),
        (Effects(film=3e-7), 1 / 3),
    ],
)
def test_the_exact_motion_has_the_exponent_of_its_law(effects: Effects, exponent: float) -> None:
    found = spun(effects)
    assert found.outcome is Outcome.FELL_FLAT
    assert is_regular(found)
    rest = coming_to_rest(found)
    assert rest is not None
    assert rest.time == found.t_end
    assert rest.predicted == pytest.approx(exponent)
    assert rest.exponent is not None
    # the window begins at 0.05 rad, where steady rolling has corrections of that order
    assert rest.exponent == pytest.approx(exponent, rel=2e-3)
    # it ends in a fall, faster than the steady law has it
    assert found.at(found.t_end).phi_dot[0] < -0.01
    # to round-off: at the end phi is 1e-26
    assert found.at(found.t_end).phi[0] < 1e-25


def test_rolling_resistance_brings_phi_and_its_rate_to_zero_together() -> None:
    found = spun(Effects(rolling_resistance=0.03), phi=0.02)
    assert found.outcome is Outcome.CAME_TO_REST
    rest = coming_to_rest(found)
    assert rest is not None
    assert rest.law == "rolling resistance"
    # an arm of 0.03 is a share of 0.03 of the adiabatic limit
    assert rest.exponent == pytest.approx(2.0, rel=0.03)
    end = found.at(found.t_end)
    assert abs(end.phi_dot[0]) < 1e-11
    assert found.evaluations < 100_000


@pytest.mark.slow
@pytest.mark.parametrize("arm", [0.03, 0.005])
def test_eulers_disk_ends_where_the_law_of_its_rolling_resistance_has_it(arm: float) -> None:
    """The arm takes the power 2 arm phi^(1/2) of an energy 3/2 phi: phi = (2/3 arm (t_f - t))^2."""
    found = spun(Effects(rolling_resistance=arm), phi=0.1)
    assert found.outcome is Outcome.CAME_TO_REST
    rest = coming_to_rest(found)
    assert rest is not None
    # steady rolling at 0.1 rad has corrections of that order
    assert rest.time == pytest.approx(1.5 * math.sqrt(0.1) / arm, rel=0.01)
    assert rest.exponent == pytest.approx(2.0, abs=0.02)


@pytest.mark.slow
def test_a_disk_that_slips_on_its_way_is_followed_to_the_end() -> None:
    """Stick and slip alternate ever faster: a geometric sequence, whose limit is the end."""
    found = spun(Effects(rolling_resistance=0.03, mu=0.3), phi=0.1)
    assert found.outcome is Outcome.CAME_TO_REST
    rest = coming_to_rest(found)
    assert rest is not None
    phi = found.at(found.t_end).phi[0]
    assert 0.0 < phi < 1e-9
    # phi = A (t_f - t)^2 with sqrt(A) = 2/3 of the arm
    assert rest.time - found.t_end == pytest.approx(math.sqrt(phi) / 0.02, rel=0.1)


TALL = Parameters(a=0.25 + 0.17**2 / 3, c=0.5, h=0.17)


def rolled(effects: Effects, *, compiled: bool = False) -> Solution:
    """Solve a disk that rolls steadily, but for the friction that stops it."""
    phi, psi_dot = 0.05, 2.0
    return solve(
        Problem(
            parameters=TALL,
            phi=phi,
            psi_dot=psi_dot,
            theta_dot=steady_rotation(TALL, phi, psi_dot),
            duration=500.0,
            effects=effects,
        ),
        compiled=compiled,
    )


def at(solution: Solution, phi: float) -> Solution:
    """Return a motion up to where its maxima have sunk to phi, as if it had come to rest there."""
    maxima = solution.maxima
    last = int(np.flatnonzero(solution.at(maxima).phi > phi)[-1])
    end = float(maxima[last])
    phases = tuple(phase for phase in solution.phases if phase.start <= end)
    return replace(solution, maxima=maxima[: last + 1], t_end=end, phases=phases)


@pytest.mark.slow
def test_drilling_friction_brings_a_disk_to_rest_in_nutations_whose_limit_is_the_end(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """One that sticks: its nutations tend to a geometric sequence, and phi goes as its square."""
    # each fifth that it comes nearer to rest it is given so much again
    monkeypatch.setattr(hybrid_integrator, "MOST_WORK", 30_000)
    found = rolled(Effects(drilling=0.3, mu=0.3))
    assert found.outcome is Outcome.CAME_TO_REST
    assert found.evaluations > 3 * hybrid_integrator.MOST_WORK
    assert is_regular(found)
    early = at(found, 1e-7)
    rest, before = coming_to_rest(found), coming_to_rest(early)
    assert rest is not None
    assert before is not None
    assert rest.exponent is None
    phi = float(found.at(found.t_end).phi[0])
    assert 0.0 < phi < 1e-9
    left = rest.time - early.t_end
    assert (rest.time - found.t_end) / left == pytest.approx(math.sqrt(phi / 1e-7), rel=0.1)
    assert abs(before.time - rest.time) < 0.02 * left


@needs_numba
@pytest.mark.slow
@pytest.mark.parametrize("drilling", [0.3, 0.1])
def test_compiled_code_comes_to_rest_at_the_same_time(drilling: float) -> None:
    """To a millionth: of few nutations, whose ratio has not all of its limit."""
    own = rolled(Effects(drilling=drilling, mu=0.3), compiled=True)
    assert own.outcome is Outcome.CAME_TO_REST
    rest = coming_to_rest(own)
    assert rest is not None
    # found by numpy
    assert rest.time == pytest.approx({0.3: 11.48266, 0.1: 17.305449}[drilling], rel=1e-6)


def test_a_sequence_that_ends_before_the_motion_or_has_two_ratios_has_no_limit() -> None:
    assert _limit([0.9, 1.9, 2.89], 2.9) is None
    times = [20.0 - 10.0 * 0.9**n for n in range(20)]
    assert _limit(times, times[-1]) == pytest.approx(20.0, abs=1e-12)
    assert _limit(times, 19.99) is None
    twice = sorted([*times, *(20.0 - 9.9 * 0.9**n for n in range(20))])
    assert _limit(twice, twice[-1]) is None


@pytest.mark.slow
@pytest.mark.parametrize(
    "effects",
    [Effects(drilling=0.1, mu=0.3), Effects(mu=0.3, patch=0.2)],
    ids=["sticks and slips", "a patch"],
)
def test_infinitely_many_nutations_end_at_the_same_time(effects: Effects) -> None:
    """The limit from where phi is a hundred times larger is the same."""
    found = rolled(effects)
    assert found.outcome is Outcome.CAME_TO_REST
    rest, before = coming_to_rest(found), coming_to_rest(at(found, 1e-7))
    assert rest is not None
    assert before is not None
    assert rest.time > found.t_end
    assert abs(before.time - rest.time) < 1e-6 * rest.time
    # what is left as the square root of phi
    assert (rest.time - at(found, 1e-7).t_end) / (rest.time - found.t_end) == pytest.approx(
        10, rel=0.1
    )


def test_a_can_that_falls_flat_without_dissipation_has_no_law() -> None:
    fell = solve(Problem(parameters=DISK, phi=0.1, duration=10.0, effects=Effects(mu=0.5)))
    assert fell.outcome is Outcome.FELL_FLAT
    assert not is_regular(fell)
    rest = coming_to_rest(fell)
    assert rest is not None
    assert (rest.law, rest.exponent, rest.predicted) == ("", None, None)


def test_a_can_that_rocks_on_its_way_to_rest_has_no_exponent() -> None:
    """Its phi falls and rises, and the steady rolling that the exponents are of is none of it."""
    problem = Problem(
        parameters=PAPER_CAN,
        phi=0.4,
        psi_dot=0.12,
        theta_dot=-0.06,
        duration=100.0,
        effects=Effects(boundary_layer=2e-3),
    )
    rocked = solve(problem)
    assert rocked.bounces
    assert is_regular(rocked)
    rest = coming_to_rest(rocked)
    assert rest is not None
    assert rest.time == rocked.t_end
    assert (rest.law, rest.exponent, rest.predicted) == ("", None, None)


@pytest.mark.parametrize("effects", [Effects(contour=0.01), Effects(film=1e-6)])
def test_a_fall_in_a_plane_is_no_doing_of_a_law_along_the_rim(effects: Effects) -> None:
    fell = solve(Problem(parameters=DISK, phi=0.1, duration=10.0, effects=effects))
    assert fell.outcome is Outcome.FELL_FLAT
    assert not is_regular(fell)
    rest = coming_to_rest(fell)
    assert rest is not None
    assert (rest.law, rest.exponent) == ("", None)
