"""The equations of the rivals against others: rotation matrices, and contact by geometry alone."""

from dataclasses import replace

import numpy as np
import pytest

from reference import PAPER_CAN, Effects, Gravity, Mass, Problem
from reference.problem.states import Floats
from tests.benchmarks.newton_euler import Motion
from tests.support.compiled import needs_numba

UP = np.array([0.0, 0.0, 1.0])
POINT_MASS = Mass(share=0.15, x=0.3, y=-0.2, z=0.25)
LEVEL = (0.06, 0.03)
GRAVITY = Gravity(
    constant=(*LEVEL, -float(np.sqrt(1 - LEVEL[0] ** 2 - LEVEL[1] ** 2))),
    amplitude=(0.05, -0.1, 0.07),
    rate=3.0,
    phase=0.7,
)
STILL = Problem(parameters=PAPER_CAN, phi=0.3, duration=1.0)


def cross_matrix(x: Floats) -> Floats:
    return np.array([[0, -x[2], x[1]], [x[2], 0, -x[0]], [-x[1], x[0], 0]])


def by_matrices(problem: Problem, t: float, y: Floats, *, slips: bool) -> tuple[Floats, ...]:
    """Return axes, angular acceleration, acceleration of the rim's material and force, in space.

    The contact is the lowest point of the rim, wherever it is: its velocity is the derivative of
    the direction of steepest descent in the can's end.
    """
    phi, w2, w1, w3, psi, theta, u1, u2 = y
    e, can = problem.effects, problem.parameters
    share = 0.0 if e.mass is None else e.mass.share
    place = np.zeros(3) if e.mass is None else np.array([e.mass.x, e.mass.y, e.mass.z])
    mass, of_mass = 1 + share, share / (1 + share)
    ahead = np.array([np.cos(psi), np.sin(psi), 0.0])
    aside = np.cross(UP, ahead)
    leaning = np.array(
        [np.cos(phi) * ahead + np.sin(phi) * UP, aside, np.cos(phi) * UP - np.sin(phi) * ahead]
    ).T
    c, s = np.cos(theta), np.sin(theta)
    R = leaning @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    w = leaning @ np.array([w1, w2, w3])
    inertia = np.diag([can.a, can.a, can.c])
    inertia = R @ (inertia + of_mass * (place @ place * np.eye(3) - np.outer(place, place))) @ R.T
    # the lowest point of the end, as seen from the centre of mass, and its velocity
    axis, steep = R[:, 2], UP - (UP @ R[:, 2]) * R[:, 2]
    axis_rate = np.cross(w, axis)
    steep_rate = -(UP @ axis_rate) * axis - (UP @ axis) * axis_rate
    size = np.linalg.norm(steep)
    up_end = steep / size
    p = -can.h * axis - up_end - of_mass * (R @ place)
    p_rate = -can.h * axis_rate - (steep_rate - up_end * (up_end @ steep_rate)) / size
    p_rate -= np.cross(w, of_mass * (R @ place))
    shaking = np.sin(e.gravity.rate * t + e.gravity.phase)
    gravity = np.array(e.gravity.constant) + shaking * np.array(e.gravity.amplitude)
    inverse = np.linalg.inv(inertia)
    free = -inverse @ np.cross(w, inertia @ w)
    rim = gravity + np.cross(free, p) + np.cross(w, p_rate)
    mobility = np.eye(3) / mass - cross_matrix(p) @ inverse @ cross_matrix(p)
    if slips:
        slip = u1 * ahead + u2 * aside
        direction = UP - (e.mu or 0.0) * slip / np.linalg.norm(slip)
        force = -rim[2] / (mobility @ direction)[2] * direction
    else:
        force = np.linalg.solve(mobility, -rim)
    level = np.array([ahead, aside, UP]).T
    return leaning, free + inverse @ np.cross(p, force), level.T @ (rim + mobility @ force), force


@pytest.mark.parametrize("compiled", [False, pytest.param(True, marks=needs_numba)])
@pytest.mark.parametrize(
    ("effects", "slips"),
    [
        (Effects(mu=0.2), False),
        (Effects(mu=0.2), True),
        (Effects(gravity=GRAVITY), False),
        (Effects(mass=POINT_MASS, gravity=GRAVITY), False),
    ],
    ids=["sticks", "slips", "shaken", "point mass"],
)
def test_the_rivals_equations_are_those_of_rotation_matrices(
    effects: Effects, *, slips: bool, compiled: bool
) -> None:
    problem = replace(STILL, effects=effects)
    motion = Motion.of(problem, compiled=compiled)
    rng = np.random.default_rng(5)
    for _ in range(10):
        t, y = float(rng.uniform(0, 3)), 0.5 * rng.normal(size=8)
        y[0] = rng.uniform(0.2, 1.2)
        y[6:] *= slips
        leaning, turning, rim, force = by_matrices(problem, t, y, slips=slips)
        phi, w2, w1, w3, psi, theta, u1, u2 = y.tolist()
        *a, b1, b2, F1, F2, N = motion.force(
            (t, phi, w1, w2, w3, psi, theta, u1, u2), np.sin(phi), np.cos(phi), slips
        )
        along = np.array([[np.cos(psi), -np.sin(psi)], [np.sin(psi), np.cos(psi)]])
        # some hundred roundings of numbers of size 1 to 10
        assert leaning @ np.array(a) == pytest.approx(turning, abs=1e-13)
        assert np.array([b1, b2, 0.0]) == pytest.approx(rim, abs=1e-13)
        assert along @ np.array([F1, F2]) == pytest.approx(force[:2], abs=1e-13)
        assert pytest.approx(force[2], abs=1e-13) == N


def test_effects_that_the_rivals_do_not_have_are_refused() -> None:
    with pytest.raises(ValueError, match=r"no damping, rim: only"):
        Motion.of(replace(STILL, effects=Effects(linear_damping=0.1, rim=0.05)))


def test_a_slip_with_a_point_mass_is_refused() -> None:
    motion = Motion.of(replace(STILL, effects=Effects(mu=0.2, mass=POINT_MASS)))
    with pytest.raises(ValueError, match="only stick"):
        motion.rates(0.0, (0.3, 0.0, 0.1, 0.0, 0.0, 0.0, 0.1, 0.0), True)  # noqa: FBT003
