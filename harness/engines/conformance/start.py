"""The start: the state as released, the can as declared, the acceleration that mechanics gives.

Rigid-body mechanics of the rolling can at one instant, told from Newton and Euler anew.

Neither the reference nor an engine has a part in it. The centre has acceleration a, the body has
angular acceleration e, the plane pushes with F at the offset r of the contact point:

    m a = F - m g z
    I e + omega x I omega = r x F
    a + e x r + omega x r' = 0

The last line is the rolling condition v + omega x r = 0, once differentiated; r' is how the
contact offset moves as the contact point runs round the rim. With the axis n, its tilt phi
(c = cos phi = n_z, s = sin phi), and the direction d = (n c - z)/s from the middle of the base to
its lowest point,

    r = R d - H n,    n' = omega x n,    d' = (n' c + n n_z' + d n_z' c/s)/s

since s' = -c n_z'/s. Nine equations are linear in the nine components of a, e and F.
"""

import math

import numpy as np

from harness.core.trajectory import Floats, Trajectory
from harness.engines.conformance.fixture import (
    COARSE,
    ClauseEvidence,
    Fixture,
    not_applicable,
    within,
)
from harness.engines.probes.survey import opens_worlds
from models.can import Can
from models.kinematics import to_body
from models.rim import release_state
from models.state import Pose, Twist

_UP = np.array((0.0, 0.0, 1.0))


def rolling_acceleration(
    can: Can, gravity: float, pose: Pose, twist: Twist
) -> tuple[Floats, Floats, Floats]:
    """Return a, e and F of a can that rolls without slipping on the plane.

    Parameters
    ----------
    can : Can
    gravity : float
        m/s^2.
    pose : Pose
        Tilted, so that the lowest point is one.
    twist : Twist
        Its velocity has no part in the answer: rolling gives it from the angular velocity.

    Returns
    -------
    a, e, F : ndarray, shape (3,)
        m/s^2, rad/s^2 and N, in world coordinates.
    """
    R_WB = to_body(pose.quaternion, np.eye(3))  # row i is the world's axis i in the body's frame
    moments = np.array((can.transverse_inertia, can.transverse_inertia, can.axial_inertia))
    inertia, omega = R_WB @ np.diag(moments) @ R_WB.T, twist.angular_velocity
    n = R_WB[:, 2]
    c, s = n[2], math.hypot(n[0], n[1])
    d = (n * c - _UP) / s
    n_dot = np.cross(omega, n)
    d_dot = (n_dot * c + n * n_dot[2] + d * n_dot[2] * c / s) / s
    r = can.radius * d - can.half_height * n
    r_dot = can.radius * d_dot - can.half_height * n_dot
    one, none, arm = np.eye(3), np.zeros((3, 3)), _cross(r)
    matrix = np.block(
        [
            [can.mass * one, none, -one],
            [none, inertia, -arm],
            [one, -arm, none],
        ]
    )
    right = np.concatenate(
        (
            -can.mass * gravity * _UP,
            -np.cross(omega, inertia @ omega),
            -np.cross(omega, r_dot),
        )
    )
    found: Floats = np.linalg.solve(matrix, right)
    return found[:3], found[3:6], found[6:]


def _cross(vector: Floats) -> Floats:
    """Return the matrix that takes w to vector x w."""
    matrix: Floats = np.cross(vector, np.eye(3)).T
    return matrix


EPS = float(np.finfo(np.float64).eps)

AT_RELEASE = 0.01
"""Share of g allowed at t = 0. An engine whose first step holds the touching material at rest, as
it should be, does not yet know that the contact point moves on: it misses |omega x r'|, which is
0.0015 g in the suite's release. A moment off by a tenth costs as much as is allowed."""

HALVING = 0.6
"""Share of the error left at half the timestep: 1/2 for the first order, with a fifth for the next
order, whose share at these timesteps is below a twentieth."""

ROUND_OFF = 1e-9
"""Share of g that counts as none: differences over a timestep of velocities known to an ulp."""

SMOOTH = 1e-3
"""Share of g allowed between samples of a solver that chooses its own steps, from the trapezium
rule over its grid of a ninth of a natural time; measured: 9e-5."""


def initial_state(bench: Fixture) -> ClauseEvidence:
    """Compare the first sample with the release, lowered by the static penetration."""
    case = bench.case(bench.brief)
    first, can = bench.trajectory(case), bench.brief.can
    pose, twist = release_state(can, bench.brief.release)
    lowered = np.array((0.0, 0.0, bench.run(case).static_penetration))
    rate = float(np.linalg.norm(twist.angular_velocity))
    misses = (
        np.abs(first.position[0] - pose.position + lowered).max() / can.bounding_radius,
        min(np.abs(first.quaternion[0] - sign * pose.quaternion).max() for sign in (1.0, -1.0)),
        np.abs(first.velocity[0] - twist.velocity).max() / (rate * can.bounding_radius),
        np.abs(first.angular_velocity[0] - twist.angular_velocity).max() / rate,
    )
    # a change of frame and back costs a few roundings
    return within(float(max(misses)), 16.0 * EPS, "relative", "pose and twist of the first sample")


def mass_properties(bench: Fixture) -> ClauseEvidence:
    """Read mass and moments back from the compiled world."""
    if not opens_worlds(bench.engine):
        return not_applicable("the engine compiles no world that could be read")
    world, can = bench.engine.open(bench.case(bench.brief)), bench.brief.can
    A, C = can.transverse_inertia, can.axial_inertia
    off = np.abs(np.asarray(world.inertia) / np.array((A, A, C)) - 1.0).max()
    worst = max(float(off), abs(world.mass / can.mass - 1.0))
    # decimal text and a change of frame cost a few roundings
    return within(worst, 1e-12, "relative", "mass and the three moments of the compiled world")


def acceleration_at_release(bench: Fixture) -> ClauseEvidence:
    """Compare the first difference of the velocities with Newton's and Euler's equations."""
    errors = _errors(bench, bench.trajectory(bench.case(bench.brief)))
    return within(float(errors[0]), AT_RELEASE, "g", "acceleration over the first step, at t = 0")


def acceleration_later(bench: Fixture) -> ClauseEvidence:
    """Let the timestep halve: once the contact is at rest, the error goes with it."""
    errors = _late(bench, COARSE)
    if not bench.steps:
        return within(errors, SMOOTH, "g", "acceleration between samples")
    finer = _late(bench, COARSE / 2.0)
    if finer <= ROUND_OFF:
        return within(finer, ROUND_OFF, "g", "acceleration between samples")
    detail = f"error of {errors:.2g} g at 1 ms and of {finer:.2g} g at 0.5 ms, as their ratio"
    return within(finer / errors, HALVING, "1", detail)


def _late(bench: Fixture, timestep: float) -> float:
    """Return the largest error in the second half of the brief release, over g."""
    errors = _errors(bench, bench.trajectory(bench.case(bench.brief, timestep)))
    return float(errors[len(errors) // 2 :].max())


def _errors(bench: Fixture, path: Trajectory) -> Floats:
    """Return the error of the acceleration between samples, over g, shape (n - 1,)."""
    can, gravity = bench.brief.can, bench.brief.gravity
    exact = []
    for i in range(len(path)):
        pose = Pose(position=path.position[i], quaternion=path.quaternion[i])
        twist = Twist(velocity=path.velocity[i], angular_velocity=path.angular_velocity[i])
        a, e, _ = rolling_acceleration(can, gravity, pose, twist)
        exact.append(np.concatenate((a, e * can.radius)))
    states = np.hstack((path.velocity, path.angular_velocity * can.radius))
    found = np.diff(states, axis=0) / np.diff(path.time)[:, None]
    means = (np.array(exact)[:-1] + np.array(exact)[1:]) / 2.0
    errors: Floats = np.linalg.norm(found - means, axis=1) / gravity
    return errors
