"""The contact that engines report: theirs, of the instant of the pose, and at rest at first."""

from dataclasses import replace

import numpy as np
import pytest

from harness.core.case import Case, Value
from harness.core.simulation import Outcome
from harness.core.trajectory import Trajectory
from harness.engines.reference.truth import truth
from models import Horizon, Scene, contact_point, load
from tests.support.engines import CONTACTS, DOUBLE
from tests.support.evaluations import evaluated, stepped

ENGINES = tuple(name for name in CONTACTS if name in DOUBLE)
HELD = ("mujoco", "pybullet")
"""Engines that keep a contact through every step; DART's is lost for steps, of its own accord."""

EXACT: dict[str, tuple[tuple[str, Value], ...]] = {"drake": (("ground", "HalfSpace"),)}
"""Settings whose collider is exact above 4.5e-4 rad; a box's contact is found by iteration."""

EPS = np.finfo(np.float64).eps


@pytest.fixture(params=ENGINES)
def steps(request: pytest.FixtureRequest, gentle: Scene) -> Trajectory:
    """Return every step of the gentle release up to and through its bounce."""
    name = request.param
    return stepped(Case(scene=gentle, engine=name, timestep=1e-3, options=EXACT.get(name, ())), 300)


IN_BODY_AXES = {"pinocchio"}
"""Engines whose step adds to the velocity in the axes of the body, which turn meanwhile."""


def test_force_and_velocity_obey_newton_step_by_step(
    gentle: Scene, steps: Trajectory, request: pytest.FixtureRequest
) -> None:
    can, dt = gentle.can, 1e-3
    gained = can.mass * np.diff(steps.velocity, axis=0) / dt
    given = steps.contact_force[:-1] - np.array((0.0, 0.0, can.mass * gentle.gravity))
    # differences of velocities below 1 m/s carry an ulp of 1 m/s each; MuJoCo's force is also
    # rebuilt from a soft constraint, which costs the digits of its stiffness; solvers stop earlier
    allowed = can.mass / dt * 8 * EPS + 1e-11 * can.mass * gentle.gravity
    if request.node.callspec.params["steps"] in IN_BODY_AXES:
        turn = np.linalg.norm(steps.angular_velocity, axis=1).max() * dt
        allowed = turn * np.linalg.norm(gained, axis=1).max()
    assert np.abs(gained - given).max() < allowed


def test_a_force_of_the_next_instant_would_be_noticed(gentle: Scene, steps: Trajectory) -> None:
    can, dt = gentle.can, 1e-3
    gained = can.mass * np.diff(steps.velocity, axis=0)[:-1] / dt
    late = steps.contact_force[1:-1] - np.array((0.0, 0.0, can.mass * gentle.gravity))
    # the force changes by this share of the weight from step to step
    assert np.abs(gained - late).max() > 1e-3 * can.mass * gentle.gravity


def test_the_contact_point_is_the_lowest_point_of_the_rim_of_the_same_state(
    gentle: Scene, steps: Trajectory
) -> None:
    single = steps.contact_count == 1
    assert single.mean() > 0.9
    low = contact_point(gentle.can, steps.position, steps.quaternion)
    found = steps.contact_point
    size = gentle.can.bounding_radius
    assert np.abs(found - low)[single, :2].max() < 1e-12 * size
    # on one of the two surfaces, or between them
    below, above = np.minimum(low[:, 2], 0.0), np.maximum(low[:, 2], 0.0)
    outside = np.maximum(below - found[:, 2], found[:, 2] - above)
    assert outside[single].max() < 1e-12 * size
    assert np.abs(steps.penetration + low[:, 2])[single].max() < 1e-12 * size
    moved = np.abs(np.diff(low[:, :2], axis=0)).max()
    assert moved > 1e-4 * size  # so that a point of the next instant would be noticed


@pytest.mark.parametrize("scene", ["gentle-rock", "paper-release", "wobble"])
@pytest.mark.parametrize("timestep", [1e-4, 1e-5])
@pytest.mark.parametrize("name", HELD)
def test_the_contact_bears_the_true_load_from_the_first_step_on(
    name: str, scene: str, timestep: float
) -> None:
    own = load(scene)
    steps = stepped(Case(scene=own, engine=name, timestep=timestep), 10)
    true = truth(own).at(steps.time).contact_force[:, 2]
    error = np.abs(steps.contact_force[:, 2] / true - 1.0)
    # In the first step an engine holds the rim at rest where it touches; the acceleration with
    # which the touching material leaves is missing: 1 % of the load where the can turns fastest
    # (wobble). A start-up bounce is of the order of the load.
    assert error[0] < 0.02
    # From then on: the softness of MuJoCo's friction, (1/d - 1)/impratio of the force, and an
    # error of first order.
    softness = (1.0 / 0.9 - 1.0) / 100.0
    assert error[1:].max() < softness + 10.0 * timestep


@pytest.mark.parametrize("name", HELD)
def test_without_settling_there_would_be_a_start_up_bounce(brief: Scene, name: str) -> None:
    depth = evaluated(brief, name, 1e-3).simulation.static_penetration
    # MuJoCo: (1 - d) (2 dt)^2 g with impedance d = 0.9, 3.9 micrometres; PyBullet is rigid up to
    # the residual at which its solver stops
    expected = 0.1 * 4e-6 * brief.gravity if name == "mujoco" else 0.0
    assert depth == pytest.approx(expected, rel=0.05, abs=1e-10)


@pytest.mark.parametrize("name", HELD)
@pytest.mark.parametrize("scene", ["gentle-rock", "wobble"])
def test_accelerations_agree_with_the_exact_ones_to_first_order(name: str, scene: str) -> None:
    own = load(scene)
    errors = {}
    for timestep in (2e-4, 1e-4, 5e-5):
        steps = stepped(Case(scene=own, engine=name, timestep=timestep), round(4e-3 / timestep))
        true = truth(own).at(steps.time)
        found, exact = (
            np.diff(np.hstack((t.velocity, t.angular_velocity * own.can.radius)), axis=0) / timestep
            for t in (steps, true)
        )
        error = np.linalg.norm(found - exact, axis=1) / own.gravity
        # from 3 ms on the slip that the first step leaves behind has decayed in MuJoCo as well,
        # which takes some tens of steps
        errors[timestep] = error[round(3e-3 / timestep) :].max()
    # an angular velocity of 10 rad/s changes direction within a step by 10 dt
    assert errors[2e-4] < 1e-3
    # first order: halving the timestep halves the error; 10 % for the next order
    assert errors[2e-4] / errors[1e-4] == pytest.approx(2.0, rel=0.1)
    assert errors[1e-4] / errors[5e-5] == pytest.approx(2.0, rel=0.1)


@pytest.mark.parametrize("name", ENGINES)
def test_a_can_that_flies_has_no_contact(brief: Scene, name: str) -> None:
    release = replace(brief.release, phi_dot=60.0)  # the centre then falls away from the rim
    scene = replace(brief, release=release, horizon=Horizon(seconds=5e-3))
    e = evaluated(scene, name, 1e-4)
    assert e.simulation.outcome is Outcome.FINISHED
    assert e.motion is not None
    assert e.contact is not None
    away = ~e.motion.touching
    assert away.any()
    trajectory = e.motion.trajectory
    np.testing.assert_array_equal(trajectory.contact_force[away], 0.0)
    assert np.isnan(e.motion.locus[away]).all()
    assert np.isnan(e.motion.friction_ratio[away]).all()
    np.testing.assert_array_equal(trajectory.contact_count[away], 0)
    assert 0.0 < e.contact.lift_off_fraction <= 1.0
