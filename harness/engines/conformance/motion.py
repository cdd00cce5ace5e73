"""The motion: at the release and after it, the same again, and the grid of its samples.

The clauses about the release compare the first accelerations with rigid-body mechanics. Neither
the reference nor an engine has a part in that: Newton's and Euler's equations are solved here. The
centre has acceleration a, the body has angular acceleration e, and the plane pushes with F at the
offset r of the contact point:

    m a = F - m g z
    I e + omega x I omega = r x F
    a + e x r + omega x r' = 0

The last line is the rolling condition v + omega x r = 0, differentiated once; r' is the velocity of
the contact offset as the contact point runs round the rim. With the axis n, its tilt phi
(c = cos phi = n_z, s = sin phi), and the direction d = (n c - z)/s from the middle of the base to
its lowest point,

    r = R d - H n,    n' = omega x n,    d' = (n' c + n n_z' + d n_z' c/s)/s

since s' = -c n_z'/s. The nine equations are linear in the nine components of a, e and F.

The sampling grid starts at the release, runs forwards, is dense by angle and ends at the horizon.
"""

import math
from dataclasses import replace

import numpy as np

from harness.core.trajectory import Floats, Trajectory, take
from harness.engines.base import features_of
from harness.engines.conformance.suite import (
    BRIEF,
    COARSE,
    FINE,
    ClauseResult,
    Fixture,
    clause,
    fingerprint,
    holds,
    not_applicable,
    same_bits,
    within,
)
from harness.engines.contract import contract_violation
from harness.engines.parity.contact import ROUND_OFF
from harness.engines.registry import engine, names
from harness.engines.stepping.settling import UP
from harness.execution.isolated_pool import IsolatedProcessPool
from harness.execution.limits import Limits
from models import (
    RESOLVED_STEP,
    Can,
    Horizon,
    Pose,
    Twist,
    angle_rates,
    angles,
    principal,
    release_state,
    to_body,
)


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
    d = (n * c - UP) / s
    n_dot = np.cross(omega, n)
    d_dot = (n_dot * c + n * n_dot[2] + d * n_dot[2] * c / s) / s
    r = can.radius * d - can.half_height * n
    r_dot = can.radius * d_dot - can.half_height * n_dot
    # the matrix `arm` takes w to r x w
    one, none, arm = np.eye(3), np.zeros((3, 3)), np.cross(r, np.eye(3)).T
    matrix = np.block([[can.mass * one, none, -one], [none, inertia, -arm], [one, -arm, none]])
    gyroscopic, carried = np.cross(omega, inertia @ omega), np.cross(omega, r_dot)
    right = np.concatenate((-can.mass * gravity * UP, -gyroscopic, -carried))
    solution: Floats = np.linalg.solve(matrix, right)
    return solution[:3], solution[3:6], solution[6:]


AT_RELEASE = 0.01
"""Share of g allowed at t = 0. An engine whose first step holds the touching material at rest, as
it should be, does not yet know that the contact point moves on: it misses |omega x r'|, which is
0.0015 g in the suite's release. A moment off by a tenth costs as much as is allowed."""

HALVING = 0.6
"""Share of the error left at half the timestep: 1/2 for the first order, with a fifth for the next
order, whose share at these timesteps is below a twentieth."""

NONE = 1e-9
"""Share of g that counts as none: differences over a timestep of velocities known to an ulp."""

ROUNDINGS = 4.0
"""Ulps of a position of the can's size that count as none, too: a contact as stiff as a timestep
allows makes of each an acceleration of an ulp over the square of the timestep. In double precision
that is far below `NONE`."""

SMOOTH = 1e-3
"""Share of g allowed between samples of a solver that chooses its own steps, from the trapezium
rule over its grid of a ninth of a natural time; measured: 9e-5."""


@clause("The first sample is the release to round-off, at static penetration.")
def initial_state(fixture: Fixture) -> ClauseResult:
    """Compare the first sample with the release, lowered by the static penetration."""
    first, can = fixture.trajectory(), fixture.brief.can
    pose, twist = release_state(can, fixture.brief.release)
    lowered = fixture.run(fixture.case()).static_penetration * UP
    rate = float(np.linalg.norm(twist.angular_velocity))
    misses = (
        np.abs(first.position[0] - pose.position + lowered).max() / can.bounding_radius,
        min(np.abs(first.quaternion[0] - sign * pose.quaternion).max() for sign in (1.0, -1.0)),
        np.abs(first.velocity[0] - twist.velocity).max() / (rate * can.bounding_radius),
        np.abs(first.angular_velocity[0] - twist.angular_velocity).max() / rate,
    )
    # a change of frame and back costs a few roundings
    allowed = 16.0 * fixture.precision(fixture.case()).epsilon
    return within(float(max(misses)), allowed, "relative", "pose and twist of the first sample")


@clause("Mass and moments of the compiled can are the declared ones.")
def mass_properties(fixture: Fixture) -> ClauseResult:
    """Read mass and moments back from the compiled world."""
    features = features_of(fixture.engine)
    if features.open is None:
        return not_applicable("the engine compiles no world that could be read")
    world, can = features.open(fixture.case()), fixture.brief.can
    A, C = can.transverse_inertia, can.axial_inertia
    off = np.abs(np.asarray(world.inertia) / np.array((A, A, C)) - 1.0).max()
    worst = max(float(off), abs(world.mass / can.mass - 1.0))
    allowed = ROUND_OFF[fixture.precision(fixture.case())].read
    return within(worst, allowed, "relative", "mass and the three moments of the compiled world")


@clause("The first acceleration is that of a rigid can that rolls.")
def acceleration_at_release(fixture: Fixture) -> ClauseResult:
    """Compare the first difference of the velocities with Newton's and Euler's equations."""
    error = float(_errors(fixture, fixture.trajectory())[0])
    return within(error, AT_RELEASE, "g", "acceleration over the first step, at t = 0")


@clause("Later accelerations converge to those of a rigid can, in the first order.")
def acceleration(fixture: Fixture) -> ClauseResult:
    """Let the timestep halve: once the contact is at rest, the error goes with it."""
    what, said = "acceleration between samples", features_of(fixture.engine).description
    if said.accuracies:
        coarse, *_, fine = said.accuracies[-_APART:]
        error, finer = (
            _late(fixture, _thinned(fixture.trajectory(replace(fixture.case(), options=options))))
            for options in (((said.accuracy_setting, at),) for at in (coarse, fine))
        )
        asked = f"{said.accuracy_setting} {coarse:g}", f"{fine:g}"
    else:
        error = _late(fixture, fixture.trajectory())
        if not fixture.steps:
            return within(error, SMOOTH, "g", what)
        finer = _late(fixture, fixture.trajectory(fixture.case(timestep=COARSE / 2.0)))
        asked = "1 ms", "0.5 ms"
    ulp = fixture.precision(fixture.case()).epsilon * fixture.brief.can.bounding_radius
    none = max(NONE, ROUNDINGS * ulp / ((COARSE / 2.0) ** 2 * fixture.brief.gravity))
    if finer <= none:
        return within(finer, none, "g", what)
    detail = (
        f"error of {error:.2g} g at {asked[0]} and of {finer:.2g} g at {asked[1]}, as their ratio"
    )
    return within(finer / error, HALVING, "1", detail)


_APART = 3
"""Accuracies from the coarse one to the finest: two decades, as a rule."""


def _thinned(path: Trajectory) -> Trajectory:
    """Return samples 1 ms apart or more: a stiff contact bears its load in turns of own steps."""
    kept = [0]
    for place, time in enumerate(path.time.tolist()):
        if time - path.time[kept[-1]] >= COARSE:
            kept.append(place)
    return take(path, np.array(kept))


def _late(fixture: Fixture, path: Trajectory) -> float:
    """Return the largest error in the second half of the brief release, over g."""
    errors = _errors(fixture, path)
    return float(errors[len(errors) // 2 :].max())


def _errors(fixture: Fixture, path: Trajectory) -> Floats:
    """Return the error of the acceleration between samples, over g, shape (n - 1,)."""
    can, gravity = fixture.brief.can, fixture.brief.gravity
    exact = []
    for i in range(len(path)):
        pose = Pose(position=path.position[i], quaternion=path.quaternion[i])
        twist = Twist(velocity=path.velocity[i], angular_velocity=path.angular_velocity[i])
        a, e, _ = rolling_acceleration(can, gravity, pose, twist)
        exact.append(np.concatenate((a, e * can.radius)))
    states = np.hstack((path.velocity, path.angular_velocity * can.radius))
    measured = np.diff(states, axis=0) / np.diff(path.time)[:, None]
    means = (np.array(exact)[:-1] + np.array(exact)[1:]) / 2.0
    errors: Floats = np.linalg.norm(measured - means, axis=1) / gravity
    return errors


@clause("A case run twice gives equal bits.")
def repeats(fixture: Fixture) -> ClauseResult:
    """Run a case twice."""
    case = fixture.case()
    same = fingerprint(fixture.run(case)) == fingerprint(fixture.run_anew(case))
    return same_bits(same, "two runs of one case differ")


@clause("A case run after another case gives equal bits.")
def repeats_after_another(fixture: Fixture) -> ClauseResult:
    """Run a case again after one with another can, gravity, release and timestep."""
    first = fingerprint(fixture.run(fixture.case()))
    can = replace(fixture.brief.can, mass=2.0 * fixture.brief.can.mass)
    fixture.run_anew(fixture.case(replace(fixture.thrown, can=can, gravity=1.62), FINE))
    same = fingerprint(fixture.run_anew(fixture.case())) == first
    return same_bits(same, "a case runs otherwise after another case")


@clause("Cases run together give the same bits as one by one.")
def repeats_in_a_batch(fixture: Fixture) -> ClauseResult:
    """Run cases together: two cans, two timesteps, and one case twice."""
    together = features_of(fixture.engine).simulate_many
    if together is None:
        return not_applicable("the engine runs cases one by one")
    can = replace(fixture.brief.can, mass=2.0 * fixture.brief.can.mass)
    case, other = fixture.case(), fixture.case(replace(fixture.brief, can=can))
    cases = [case, fixture.case(timestep=FINE), other, case]
    answers = list(together(cases))
    if len(answers) != len(cases):
        return holds(f"{len(answers)} answers to {len(cases)} cases", "")
    for index, (asked, answer) in enumerate(zip(cases, answers, strict=True)):
        reason = contract_violation(answer, asked)
        if not reason and fingerprint(answer) != fingerprint(fixture.run(asked)):
            reason = "differs from its run alone"
        if reason:
            return holds(f"case {index + 1} of {len(cases)}: {reason}", "")
    return holds("", f"equal bits in {len(cases)} cases")


_PATIENCE = Limits(seconds=120.0)  # a fresh process imports an engine and runs 20 steps


@clause("A case run in a process of its own gives equal bits.")
def repeats_in_a_fresh_process(fixture: Fixture) -> ClauseResult:
    """Run a case in a process of its own."""
    name = fixture.engine.name
    if name not in names():
        return not_applicable("the engine is not registered, so that no other process finds it")
    with IsolatedProcessPool(1, _PATIENCE) as alone:
        there = alone.submit(_brief_fingerprint, name).result()
    same = there == fingerprint(fixture.run(fixture.case()))
    return same_bits(same, "a fresh process runs a case otherwise")


def _brief_fingerprint(name: str) -> str:
    """Return the fingerprint of a registered engine's run of the brief release."""
    fixture = Fixture(engine(name))
    return fingerprint(fixture.run(fixture.case()))


_ODD = 7e-4
"""s: a timestep that does not divide the horizon."""


@clause("Samples start at t = 0 and time increases strictly.")
def starts(fixture: Fixture) -> ClauseResult:
    """Look at the first instant and at the smallest distance between two."""
    time = fixture.trajectory().time
    # the release is at zero exactly: nothing is summed up to there
    if len(time) > 1 and not np.diff(time).min() > 0.0:
        return within(-float(np.diff(time).min()), 0.0, "s", "time runs backwards or stands still")
    return within(abs(float(time[0])), 0.0, "s", f"first instant of {len(time)}, all increasing")


@clause("Samples are dense by angle, so that turns can be counted.")
def dense(fixture: Fixture) -> ClauseResult:
    """Look at how far the precession gets between samples, through the whole bounce.

    The rates at both ends count as well, since between samples far apart psi may go round unseen.
    """
    path = fixture.trajectory(fixture.case(fixture.gentle, FINE))
    if len(path) < 2:  # noqa: PLR2004 - one sample has no distance to another
        return within(float("inf"), float(RESOLVED_STEP), "rad", "one sample")
    phi, psi, _ = angles(path.quaternion)
    _, psi_dot, _ = angle_rates(phi, psi, path.angular_velocity)
    rate = np.maximum(np.abs(psi_dot[:-1]), np.abs(psi_dot[1:]))
    turn = np.maximum(np.abs(principal(np.diff(psi))), rate * np.diff(path.time))
    detail = f"largest turn of psi from sample to sample, of {len(path)}"
    return within(float(turn.max()), float(RESOLVED_STEP), "rad", detail)


@clause("Samples end at the horizon, whether or not the timestep divides it.")
def ends(fixture: Fixture) -> ClauseResult:
    """Look at the last instant, where the timestep divides the horizon and where it does not."""
    worst = 0.0
    for timestep in (1e-3, _ODD) if fixture.steps else (1e-3,):
        case = fixture.case(timestep=timestep)
        left = BRIEF - float(fixture.trajectory(case).time[-1])
        # a solver without timesteps ends at the horizon itself, but for round-off
        allowed = timestep if fixture.steps else 1e-12 * BRIEF
        # the last state lies at the horizon or less than a timestep before it, never behind it
        worst = max(worst, left / allowed, -left / (1e-9 * BRIEF))
    return within(worst, 1.0, "timesteps", "from the last sample to a horizon of 20 ms")


@clause("A longer horizon does not change what happens before.")
def horizon(fixture: Fixture) -> ClauseResult:
    """Let the horizon double: the first half of the run stays what it was."""
    if not fixture.steps:
        return not_applicable("a solver that chooses its own steps may choose others")
    short = fixture.trajectory()
    double = replace(fixture.brief, horizon=Horizon(seconds=2.0 * BRIEF))
    long = fixture.trajectory(fixture.case(double))
    common = short.time[:-1]  # the last sample of a run is always recorded
    at = np.searchsorted(long.time, common)
    if at.max() >= len(long):
        return within(float("inf"), 0.0, "m", "the longer run lacks instants of the shorter")
    off = float(np.abs(long.position[at] - short.position[:-1]).max())
    return within(off, 0.0, "m", "position at the instants of the shorter run")
