"""What an engine hands over: its declarations, a sound simulation, and the state at the release.

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
"""

import math
import pickle
import re
from dataclasses import fields

import numpy as np

from harness.core.case import PROFILES, Case
from harness.core.simulation import Outcome
from harness.core.trajectory import Floats, Trajectory
from harness.engines.base import Capabilities, Setting, resolve
from harness.engines.conformance.fingerprint import fingerprint
from harness.engines.conformance.fixture import (
    COARSE,
    ClauseResult,
    Fixture,
    clause,
    holds,
    not_applicable,
    within,
)
from harness.engines.probes.survey import opens_worlds
from models.can import Can
from models.effects import Effects
from models.kinematics import to_body
from models.rim import release_state
from models.state import Pose, Twist

_NAME = r"[a-z][a-z0-9_.-]{0,31}"


@clause("name", "The name fits a command line, a file name and a table.", needs_run=False)
def name(bench: Fixture) -> ClauseResult:
    """Look at the name: what a command line, a file name and a table key alike can hold."""
    found: object = bench.engine.name
    fits = isinstance(found, str) and re.fullmatch(_NAME, found) is not None
    wrong = "" if fits else f"{found!r} is not lower-case letters, digits, dots and dashes"
    return holds(wrong, str(found))


@clause("version", "The version is a text.", needs_run=False)
def version(bench: Fixture) -> ClauseResult:
    """Look at the version, which goes into the digest of every case."""
    found: object = bench.engine.version
    fits = isinstance(found, str) and found.strip() != ""
    return holds("" if fits else f"{found!r} is no text", str(found))


@clause(
    "settings", "Each setting is named once, explained, and takes its own values.", needs_run=False
)
def settings(bench: Fixture) -> ClauseResult:
    """Look at the settings: each named once, explained, and taking its own values."""
    declared: object = bench.engine.settings
    if not isinstance(declared, tuple) or not all(isinstance(s, Setting) for s in declared):
        return holds("`settings` is not a tuple of Setting", "")
    names = [setting.name for setting in declared]
    twice = sorted({each for each in names if names.count(each) > 1})
    if twice:
        return holds(f"declared twice: {', '.join(twice)}", "")
    mute = [s.name for s in declared if len(s.meaning.split()) < 2]  # noqa: PLR2004 - a sentence
    if mute:
        return holds(f"without a sentence of meaning: {', '.join(mute)}", "")
    for profile in PROFILES:
        case = Case(scene=bench.brief, engine=bench.engine.name, profile=profile)
        timestep = bench.engine.timestep(case) or 0.0
        chosen = resolve(case, declared, timestep)
        own = {key: value for key, value in chosen.items() if value is not None}
        again = Case(
            scene=case.scene, engine=case.engine, profile=profile, options=tuple(own.items())
        )
        resolve(again, declared, timestep)  # raises where a setting does not take its own value
    return holds("", f"{len(names)} settings")


@clause(
    "capabilities",
    "What is honoured is an effect of scenes; what is imposed has a sentence.",
    needs_run=False,
)
def capabilities(bench: Fixture) -> ClauseResult:
    """Look at the capabilities: effects that exist, and a sentence for each imposed one."""
    found: object = bench.engine.capabilities
    if not isinstance(found, Capabilities):
        return holds(f"`capabilities` is {type(found).__name__}, not Capabilities", "")
    unknown = sorted(set(found.honours) - {field.name for field in fields(Effects)})
    if unknown:
        return holds(f"honours what is no effect of a scene: {', '.join(unknown)}", "")
    mute = [key for key, sentence in found.imposes.items() if not sentence.strip()]
    honours = ", ".join(sorted(found.honours)) or "nothing"
    imposes = ", ".join(found.imposes) or "nothing"
    return holds(
        f"imposes without a sentence: {', '.join(mute)}" if mute else "",
        f"honours {honours}, imposes {imposes}",
    )


@clause(
    "trajectory", "A case runs to its horizon and hands over a sound trajectory.", needs_run=False
)
def trajectory(bench: Fixture) -> ClauseResult:
    """Run the brief release: it ends at its horizon, with a trajectory that is sound."""
    case = bench.case(bench.brief)
    samples = len(bench.trajectory(case))
    outcome = bench.run(case).outcome
    finished = outcome is Outcome.FINISHED
    return holds("" if finished else f"ended with {outcome.value}", f"{samples} samples")


@clause("report", "A simulation states the settings, timestep and version that were in force.")
def reported(bench: Fixture) -> ClauseResult:
    """Compare what a simulation says of itself with what was asked."""
    case = bench.case(bench.brief)
    simulation, engine = bench.run(case), bench.engine
    timestep = engine.timestep(case)
    asked = resolve(case, engine.settings, timestep or 0.0)
    wrong = []
    if dict(simulation.settings) != asked:
        different = {
            key
            for key in asked.keys() | simulation.settings.keys()
            if asked.get(key, ...) != simulation.settings.get(key, ...)
        }
        wrong.append(f"settings differ in {', '.join(sorted(different))}")
    if simulation.timestep != timestep:
        wrong.append(f"timestep {simulation.timestep} instead of {timestep}")
    if simulation.engine_version != engine.version:
        wrong.append(f"version {simulation.engine_version} instead of {engine.version}")
    if simulation.steps < (1 if bench.steps else 0):  # a closed form takes none
        wrong.append(f"{simulation.steps} steps")
    if min(simulation.setup_s, simulation.wall_s, simulation.cpu_s) < 0.0:
        wrong.append("a negative time")
    return holds("; ".join(wrong), f"{len(asked)} settings, {simulation.steps} steps")


@clause("pickling", "A simulation goes through pickle unchanged.")
def pickling(bench: Fixture) -> ClauseResult:
    """Send a simulation through pickle: it goes to and from other processes."""
    simulation = bench.run(bench.case(bench.brief))
    back = pickle.loads(pickle.dumps(simulation))  # noqa: S301 - our own bytes
    if back.case != simulation.case or dict(back.settings) != dict(simulation.settings):
        return holds("the case or its settings changed on the way", "")
    same = fingerprint(back) == fingerprint(simulation)
    return holds("" if same else "the arrays changed on the way", "equal bits")


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


@clause("initial state", "The first sample is the release to round-off, at static penetration.")
def initial_state(bench: Fixture) -> ClauseResult:
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


@clause("mass properties", "Mass and moments of the compiled can are the declared ones.")
def mass_properties(bench: Fixture) -> ClauseResult:
    """Read mass and moments back from the compiled world."""
    if not opens_worlds(bench.engine):
        return not_applicable("the engine compiles no world that could be read")
    world, can = bench.engine.open(bench.case(bench.brief)), bench.brief.can
    A, C = can.transverse_inertia, can.axial_inertia
    off = np.abs(np.asarray(world.inertia) / np.array((A, A, C)) - 1.0).max()
    worst = max(float(off), abs(world.mass / can.mass - 1.0))
    # decimal text and a change of frame cost a few roundings
    return within(worst, 1e-12, "relative", "mass and the three moments of the compiled world")


@clause("acceleration at release", "The first acceleration is that of a rigid can that rolls.")
def acceleration_at_release(bench: Fixture) -> ClauseResult:
    """Compare the first difference of the velocities with Newton's and Euler's equations."""
    errors = _errors(bench, bench.trajectory(bench.case(bench.brief)))
    return within(float(errors[0]), AT_RELEASE, "g", "acceleration over the first step, at t = 0")


@clause("acceleration", "Later accelerations converge to those of a rigid can, in the first order.")
def acceleration_later(bench: Fixture) -> ClauseResult:
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
