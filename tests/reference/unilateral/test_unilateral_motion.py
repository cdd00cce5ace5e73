"""Motions through contact and flight, against closed forms and against another integrator."""

from dataclasses import replace
from math import hypot, sqrt

import numpy as np
import pytest
import scipy
from scipy.spatial.transform import Rotation

from reference import (
    PAPER_CAN,
    Effects,
    Gravity,
    Kind,
    Mass,
    Outcome,
    Parameters,
    Problem,
    Restitution,
    Solution,
    centre_position,
    solve,
)
from reference.problem.effects import IMPACT_LAWS
from reference.problem.states import Floats
from reference.smooth.extrema import prominent
from tests.support.compiled import needs_numba
from tests.support.unilateral_energy import energy

LOCUS = frozenset({"contact_locus"})
BEYOND_KERNELS = ("contour", "film", "contour_damping", "patch", "mu_static")


def sliding(effects: Effects) -> Problem:
    """Return a can that rolls, slides at a friction of 0.2, and does not leave the plane."""
    return Problem(
        parameters=PAPER_CAN,
        phi=0.4,
        psi_dot=0.6,
        theta_dot=-0.3,
        duration=3.0,
        effects=effects,
    )


def balanced(e: float, height: float, duration: float) -> Problem:
    """Return a can dropped with its centre above the rim's lowest point: it never turns."""
    return Problem(
        parameters=PAPER_CAN,
        phi=PAPER_CAN.balancing_angle,
        height=height,
        effects=Effects(restitution=Restitution(coefficient=e)),
        duration=duration,
    )


@pytest.mark.parametrize("e", [0.2, 0.5, 0.7])
def test_drop_on_a_balanced_rim_bounces_like_a_ball(e: float) -> None:
    height = 0.3
    fall = sqrt(2 * height)
    ends = fall * (1 + e) / (1 - e)
    solution = solve(balanced(e, height, ends + 0.1), outputs=LOCUS)
    times = [impact.time for impact in solution.impacts]
    expected, then = [], fall
    for number in range(len(times)):
        expected.append(then)
        then += 2 * fall * e ** (number + 1)
    assert times == pytest.approx(expected, abs=1e-13)
    tops = [solution.at(t + fall * e ** (k + 1)).gap for k, t in enumerate(times[:5])]
    for number, top in enumerate(tops):
        assert top is not None
        assert top[0] == pytest.approx(height * e ** (2 * number + 2), rel=1e-12)
    # the infinite sequence has an end, and the can then stands
    assert solution.impacts[-1].ends_at == pytest.approx(ends, abs=1e-14 / (1 - e))
    assert solution.phases[-1].kind is Kind.STICK
    # just before and just after an impact, at the same height but for the way of a billionth
    for impact in solution.impacts[:5]:
        before, after = energy(solution, impact.time + np.array([-1e-9, 0.0]))
        assert before - after == pytest.approx(impact.energy_lost, abs=1e-12)
        assert after < before


def test_can_rocks_on_its_face_as_housners_block_does() -> None:
    effects = Effects(restitution=Restitution(coefficient=0.0))
    solution = solve(
        Problem(parameters=PAPER_CAN, phi=0.3, duration=9.0, effects=effects), outputs=LOCUS
    )
    a_p = PAPER_CAN.a_p
    ratio = (a_p - 1) / (a_p + 1)
    lost = np.array([impact.energy_lost for impact in solution.impacts])
    assert lost[1:] / lost[:-1] == pytest.approx(ratio**2, rel=1e-9)
    height = np.sin(0.3) + PAPER_CAN.h * (np.cos(0.3) - 1)
    assert lost[0] == pytest.approx(height * (1 - ratio**2), rel=1e-12)
    assert solution.outcome is Outcome.CAME_TO_REST
    gaps = np.diff([impact.time for impact in solution.impacts])
    assert gaps[-1] / gaps[-2] == pytest.approx(ratio, rel=1e-5)
    ends = solution.impacts[-1].time + gaps[-1] * ratio / (1 - ratio)
    assert solution.t_end == pytest.approx(ends, abs=1e-9)


def test_a_disk_that_falls_flat_stays_flat() -> None:
    # a + h^2 < 1: the impact of the far rim drives the near one into the plane
    disk = Parameters(a=0.25, c=0.5, h=0.05)
    effects = Effects(restitution=Restitution(coefficient=0.0))
    solution = solve(Problem(parameters=disk, phi=0.3, duration=9.0, effects=effects))
    assert solution.outcome is Outcome.CAME_TO_REST
    height = np.sin(0.3) + disk.h * (np.cos(0.3) - 1)
    assert sum(i.energy_lost for i in solution.impacts) == pytest.approx(height, rel=1e-12)


EVERYTHING = Effects(
    mu=0.4,
    linear_damping=0.03,
    angular_damping=0.02,
    rim=0.05,
    gravity=Gravity(
        constant=(0.06, 0.0, -sqrt(1 - 0.06**2)), amplitude=(0.1, 0.05, 0.3), rate=3.0, phase=0.4
    ),
    mass=Mass(share=0.2, x=0.3, y=-0.2, z=0.4),
    restitution=Restitution(coefficient=0.6),
)

# Laws of a rim on the plane: none acts in flight, nor in an impact.
ON_THE_PLANE = replace(
    EVERYTHING, mu_static=0.6, contour=0.01, contour_damping=0.02, film=0.005, boundary_layer=0.003
)


def two_bodies(problem: Problem) -> tuple[float, Floats, Floats]:
    """Return mass, centre and inertia of can and point mass, by Steiner's theorem for each."""
    p, added = problem.parameters, problem.effects.mass
    mass, centre, inertia = 1.0, np.zeros(3), np.diag([p.a, p.a, p.c])
    if added is not None:
        mass, place = 1 + added.share, np.array([added.x, added.y, added.z])
        centre = added.share * place / mass
        for share, r in ((1.0, -centre), (added.share, place - centre)):
            inertia = inertia + share * (np.eye(3) * (r @ r) - np.outer(r, r))
    return mass, centre, inertia


def rival(problem: Problem, impacts: int) -> tuple[list[float], list[float], Floats]:
    """Return times and normal impulses of the first impacts, and the last state before one.

    A quaternion, the centre of mass and their rates, by DOP853; the rim is a circle of points; the
    impact law is solved by iteration.
    """
    p, e = problem.parameters, problem.effects
    mass, centre, inertia = two_bodies(problem)
    inverse = np.linalg.inv(inertia)

    def lowest(frame: Floats) -> Floats:
        down = -frame[2, :2]
        ahead = down / hypot(*down)
        local = np.array([*((1 - e.rim) * ahead), -(p.h - e.rim)])
        return np.asarray(frame @ (local - centre) - np.array([0.0, 0.0, e.rim]))

    def rates(t: float, y: Floats) -> Floats:
        v, q, w = y[3:6], y[6:10], y[10:]
        shaking = np.array(e.gravity.amplitude) * np.sin(e.gravity.rate * t + e.gravity.phase)
        a = np.array(e.gravity.constant) + shaking - e.linear_damping * v
        turned = np.array(
            [
                -q[1] * w[0] - q[2] * w[1] - q[3] * w[2],
                q[0] * w[0] + q[2] * w[2] - q[3] * w[1],
                q[0] * w[1] + q[3] * w[0] - q[1] * w[2],
                q[0] * w[2] + q[1] * w[1] - q[2] * w[0],
            ]
        )
        momentum = inertia @ w
        slope = inverse @ (-np.cross(w, momentum) - e.angular_damping * momentum)
        return np.concatenate([v, a, turned / 2, slope])

    def frame_of(y: Floats) -> Floats:
        return np.asarray(Rotation.from_quat(y[[7, 8, 9, 6]]).as_matrix())

    def gap(_: float, y: Floats) -> float:
        return float(y[2] + lowest(frame_of(y))[2])

    gap.terminal, gap.direction = True, -1.0  # type: ignore[attr-defined]
    # the paper's angles: about z by psi, about the lowered axis by -phi, about the axis by theta
    turned = Rotation.from_euler("ZYZ", [problem.psi, -problem.phi, problem.theta])
    frame = turned.as_matrix()
    spun = np.array([problem.psi_dot, problem.phi_dot, problem.theta_dot])
    aside = np.array([-np.sin(problem.psi), np.cos(problem.psi), 0.0])
    w = spun[0] * np.eye(3)[2] - spun[1] * aside + spun[2] * frame[:, 2]
    arm = lowest(frame)
    x, y, z, s = turned.as_quat()
    state = np.array([0, 0, problem.height - arm[2], *np.cross(arm, w), s, x, y, z, *(frame.T @ w)])
    times, normal, t = [], [], 0.0
    mu, back = e.mu, e.restitution
    assert mu is not None
    assert back is not None
    for _ in range(impacts):
        found = scipy.integrate.solve_ivp(
            rates, (t, t + 20), state, method="DOP853", rtol=1e-13, atol=1e-14, events=gap
        )
        t, state = float(found.t[-1]), found.y[:, -1].copy()
        frame = frame_of(state)
        arm, turn = lowest(frame), np.linalg.inv(frame @ inertia @ frame.T)
        cross = np.array([[0, -arm[2], arm[1]], [arm[2], 0, -arm[0]], [-arm[1], arm[0], 0]])
        D = np.eye(3) / mass - cross @ turn @ cross
        u = state[3:6] + np.cross(frame @ state[10:], arm)
        after = np.array([0, 0, -back.coefficient * u[2]])
        J = np.linalg.solve(D, after - u)
        if hypot(J[0], J[1]) > mu * J[2]:
            way = u[:2] / hypot(u[0], u[1])
            for _ in range(2000):
                pushed = np.array([*(-mu * way), 1.0])
                J = pushed * (-(1 + back.coefficient) * u[2] / (D @ pushed)[2])
                slip = (u + D @ J)[:2]
                way = 0.5 * way + 0.5 * slip / hypot(*slip)
                way /= hypot(*way)
        times.append(t)
        normal.append(float(J[2]))
        state[3:6] += J / mass
        state[10:] += frame.T @ turn @ np.cross(arm, J)
    return times, normal, state


@pytest.mark.parametrize(
    "effects", [EVERYTHING, ON_THE_PLANE, Effects(mu=0.2, restitution=EVERYTHING.restitution)]
)
def test_flights_and_impacts_are_those_of_a_quaternion_model(effects: Effects) -> None:
    problem = Problem(
        parameters=PAPER_CAN,
        phi=0.5,
        psi=0.3,
        theta=-0.8,
        phi_dot=0.1,
        psi_dot=0.4,
        theta_dot=-0.6,
        height=0.1,
        duration=8.0,
        effects=effects,
    )
    times, normal, state = rival(problem, 4)
    solution = solve(problem, outputs=LOCUS)
    own = solution.impacts[: len(times)]
    assert [impact.time for impact in own] == pytest.approx(times, abs=1e-10)
    assert [impact.normal_impulse for impact in own] == pytest.approx(normal, abs=1e-10)
    there = solution.at(times[-1])
    place = centre_position(there, problem.parameters, effects)[0]
    start = centre_position(solution.at(0.0), problem.parameters, effects)[0]
    assert (place - start)[:2] == pytest.approx(state[:2], abs=1e-9)


@pytest.mark.parametrize("more", [EVERYTHING, ON_THE_PLANE, replace(EVERYTHING, patch=0.1)])
@pytest.mark.parametrize("number", [0, 1])
def test_energy_balances_through_contact_flight_and_impact(number: int, more: Effects) -> None:
    # a parameter that is the word "newton" would ask for the engine of that name
    law = IMPACT_LAWS[number]
    effects = replace(more, restitution=Restitution(coefficient=0.5, law=law))
    problem = Problem(
        parameters=PAPER_CAN,
        phi=0.4,
        psi_dot=0.3,
        theta_dot=-0.2,
        height=0.2,
        duration=3.0,
        effects=effects,
    )
    solution = solve(problem, outputs=LOCUS)
    times = np.linspace(0, solution.t_end, 400)
    seen = energy(solution, times) + solution.lost(times)
    assert np.abs(seen - seen[0]).max() < 1e-12 * max(1.0, float(np.abs(seen).max()))
    kinds = {phase.kind for phase in solution.phases}
    assert kinds & {Kind.STICK, Kind.SLIP}
    assert Kind.FLIGHT in kinds
    assert solution.at(times).force is not None


def test_small_restitution_is_none_at_second_order() -> None:
    # bounces of a duration e move the rim by e^2: why a sequence of Zeno's may be cut where it is
    def end(e: float) -> Floats:
        effects = Effects(mu=0.5, restitution=Restitution(coefficient=e))
        solution = solve(
            Problem(
                parameters=PAPER_CAN,
                phi=0.4,
                psi_dot=0.3,
                theta_dot=-0.2,
                height=0.1,
                duration=1.5,
                effects=effects,
            ),
            outputs=LOCUS,
        )
        there = solution.at(1.5)
        return np.array([there.phi[0], there.psi[0], there.theta[0], there.phi_dot[0]])

    none, one, two = end(0.0), end(1e-4), end(2e-4)
    assert (two - none) / (one - none) == pytest.approx(4.0, rel=1e-2)


def test_contact_that_is_not_lost_is_the_motion_without_restitution() -> None:
    def motion(effects: Effects) -> Solution:
        release = Problem(
            parameters=PAPER_CAN,
            phi=0.4,
            psi_dot=0.5,
            theta_dot=-0.2,
            duration=4.0,
            effects=effects,
        )
        return solve(release, outputs=LOCUS)

    plain = motion(Effects(mu=0.6))
    other = motion(Effects(mu=0.6, restitution=Restitution(coefficient=0.5)))
    times = np.linspace(0, 4, 50)
    assert plain.outcome is other.outcome is Outcome.FINISHED
    assert np.array_equal(plain.at(times).psi, other.at(times).psi)
    assert other.impacts == ()


@needs_numba
@pytest.mark.parametrize(
    "law",
    [
        Effects(mu=0.3, contour=0.02),
        Effects(mu=0.3, film=0.01),
        Effects(mu=0.3, contour_damping=0.05),
        Effects(mu=0.3, patch=0.1),
        Effects(mu=0.2, mu_static=0.5),
    ],
)
def test_a_law_without_a_kernel_goes_by_numpy_also_beside_restitution(law: Effects) -> None:
    effects = replace(law, restitution=Restitution(coefficient=0.5))
    plain = solve(sliding(effects))
    asked = solve(sliding(effects), compiled=True)
    assert "compiled" not in asked.method
    assert np.array_equal(asked.at(3.0).psi, plain.at(3.0).psi)
    without = replace(effects, **{name: getattr(Effects(), name) for name in BEYOND_KERNELS})
    assert "compiled" in solve(sliding(without), compiled=True).method
    # the law is not dropped: without it the motion is another
    assert abs(solve(sliding(without)).at(3.0).psi[0] - plain.at(3.0).psi[0]) > 1e-6


def test_static_friction_beside_restitution_holds_the_rim_as_it_does_without() -> None:
    held = Effects(mu=0.2, mu_static=0.5)
    both = solve(sliding(replace(held, restitution=Restitution(coefficient=0.5))), outputs=LOCUS)
    assert both.model == "unilateral"
    assert np.array_equal(both.at(3.0).psi, solve(sliding(held), outputs=LOCUS).at(3.0).psi)


@pytest.mark.parametrize("beside", [1e-3, -1e-3, 1e-5, -1e-6])
def test_turns_are_counted_where_a_flight_passes_the_vertical_closely(beside: float) -> None:
    # psi changes by more than half a turn, within a time of the least tilt
    release = Problem(
        parameters=PAPER_CAN,
        phi=0.3,
        phi_dot=-1.0,
        psi_dot=2.21224 + beside,
        theta_dot=3.0,
        height=2.0,
        duration=0.6,
        effects=Effects(restitution=Restitution(coefficient=0.0)),
    )
    solution = solve(release)
    least = solution.minima[0]
    phi = solution.at(least).phi[0]
    width = np.arcsinh(0.1 / phi)
    times = least + np.sinh(np.linspace(-width, width, 200001)) * phi
    there = solution.at(times)
    assert phi < 1e-4
    for angle, rate in ((there.psi, there.psi_dot), (there.theta, there.theta_dot)):
        assert angle[-1] - angle[0] == pytest.approx(np.trapezoid(rate, times), abs=1e-7)
        assert np.abs(np.diff(angle)).max() < 1e-3


def test_bounces_stand_out_by_a_hundredth_of_the_largest_phi() -> None:
    assert prominent([1.0, 0.2, 0.205, 0.1, 0.8, 0.795], 0.01) == [0, 3, 4]
    assert prominent([0.5, 0.496, 1.0, 0.0], 0.01) == [1, 2, 3]
    assert prominent([1.0, 0.5, 1.0], 0.0) == [0, 1, 2]
    assert prominent([], 0.01) == []


def test_bounces_without_end_need_no_recursion() -> None:
    # an impact every 0.0028, of a balanced can that loses nothing
    solution = solve(balanced(1.0, 1e-6, 3.0))
    assert len(solution.impacts) > 1000
