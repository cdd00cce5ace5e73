"""The verdict on a run: the worst failure seen in it, else how accurate it is.

Each failure is sought by itself: when it is seen first, and by how much. Energy is measured against
what the can has to spend: its kinetic energy at release and the height of its centre above where it
could come to rest. Of the paper's release that is 3 % of m g R; a share of m g R would see nothing.

A run is held against the exact motion of its scene, where there is one. Beside the truth that an
evaluation has, there is one more exact motion: a can without gravity turns as a free symmetric top.
With the angular momentum L, which stays, and the axial rate w, which stays as well, its angular
velocity is

    Omega = L/A + (1 - C/A) w e,    so that    R(t) = exp(L t/A) R(0) exp((1 - C/A) w t e_3).
"""

import math
from dataclasses import dataclass, replace
from enum import Enum

import numpy as np

from harness.core.bounce import PROMINENCE
from harness.core.case import Case
from harness.core.simulation import Outcome, Simulation
from harness.core.trajectory import Floats, Trajectory
from harness.engines.ladder import fineness
from harness.engines.stepping.horizon import natural_time
from harness.evaluation.case_record import LOST
from harness.evaluation.evaluation import Evaluation
from harness.metrics.energy import energy
from harness.metrics.error import rotation_between
from harness.metrics.motion import Motion, shares
from models.kinematics import to_body, to_world
from models.rim import contact_point
from models.scene import Scene


class StabilityStatus(Enum):
    """Verdict on a run, from good to bad; tables show the value."""

    ACCURATE = "accurate"
    STABLE = "stable, no exact motion"
    INACCURATE = "stable but inaccurate"
    UNRESOLVED = "unresolved"
    DISSIPATES = "dissipates"
    FLAT = "sleeps or sticks flat"
    GAINS = "gains energy"
    TUNNELS = "tunnels"
    DIVERGES = "diverges"
    REFUSED = "refused"


MEANINGS = {
    StabilityStatus.ACCURATE: (
        "phi, every turn or the orientation is within tolerance of the exact motion"
    ),
    StabilityStatus.STABLE: "nothing failed, and there is no exact motion to be accurate to",
    StabilityStatus.INACCURATE: "nothing failed, but the motion is another one",
    StabilityStatus.UNRESOLVED: (
        "the steps are too long to tell how often the contact point went round"
    ),
    StabilityStatus.DISSIPATES: "energy is lost where the exact motion keeps it",
    StabilityStatus.FLAT: "the can stays flat where the exact motion rises again",
    StabilityStatus.GAINS: "energy comes from nowhere",
    StabilityStatus.TUNNELS: "the can sinks into the plane",
    StabilityStatus.DIVERGES: "the numbers grow without bound or are no numbers",
    StabilityStatus.REFUSED: (
        "the engine could not compile the can of the scene, or its adapter broke"
    ),
}
"""What each verdict says, in a few words."""

SOUND = frozenset({StabilityStatus.ACCURATE, StabilityStatus.STABLE, StabilityStatus.INACCURATE})
"""Verdicts of a run in which nothing failed."""


@dataclass(frozen=True, slots=True)
class Symptom:
    """Something that was seen in a run.

    Parameters
    ----------
    time : float
        When it was seen first, s.
    number : float
        The number behind it.
    words : str
        What the number is; its unit, if it has one, comes last, after a comma.
    """

    time: float
    number: float
    words: str


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ClassifiedRun:
    """A run, without its motion, and the verdict on it.

    Parameters
    ----------
    simulation : Simulation
        Its trajectory is left out, so that thousands can be kept.
    verdict : StabilityStatus
    symptom : Symptom
        The number behind the verdict, and when.
    """

    simulation: Simulation
    verdict: StabilityStatus
    symptom: Symptom

    @property
    def case(self) -> Case:
        """The case that was run."""
        return self.simulation.case

    @property
    def rung(self) -> float:
        """The timestep, s, the largest of an adaptive run, or the accuracy; zero without either."""
        return fineness(self.simulation) or 0.0

    @property
    def sound(self) -> bool:
        """Whether nothing failed."""
        return self.verdict in SOUND

    @property
    def accurate(self) -> bool:
        """Whether it follows the exact motion."""
        return self.verdict is StabilityStatus.ACCURATE

    @property
    def good(self) -> bool:
        """Whether it is accurate, or sound where there is no exact motion."""
        return self.verdict in {StabilityStatus.ACCURATE, StabilityStatus.STABLE}


ACCURATE_PHI = 0.01
"""Of the largest true phi, root mean square over the run."""

ACCURATE_TURN = math.radians(2.0)
"""rad, of each turn, and of the orientation of a can that flies free: 1 % of a hard bounce's."""

_SEEN = 0.98
"""Of the length of the exact motion: a bounce that ends later may be missing in a record."""

_UNFIT = {Outcome.MISMATCH, Outcome.NO_SOLUTION, *(Outcome[name] for name in LOST)}
"""Endings of runs that say nothing of a motion."""


def classify(e: Evaluation) -> ClassifiedRun:
    """Return the verdict on a run."""
    verdict, symptom = _verdict(e)
    return ClassifiedRun(
        simulation=replace(e.simulation, trajectory=None), verdict=verdict, symptom=symptom
    )


def _verdict(e: Evaluation) -> tuple[StabilityStatus, Symptom]:
    scene, outcome = e.simulation.case.scene, e.simulation.outcome
    if outcome in _UNFIT:
        words = e.simulation.note or outcome.value
        return StabilityStatus.REFUSED, Symptom(0.0, math.nan, words)
    truth = None if e.truth_pulls else e.truth
    # an impact or a rim that slides may lose energy: it is kept where the exact motion is known
    keeps = math.inf if scene.gravity == 0.0 else 0.0 if truth is None else float(truth.time[-1])
    for verdict, symptom in (
        (StabilityStatus.DIVERGES, diverged(e)),
        (StabilityStatus.TUNNELS, tunnelled(e)),
        (StabilityStatus.GAINS, gained(e)),
        (StabilityStatus.FLAT, stuck_flat(e, truth)),
        *sorted(
            (
                (StabilityStatus.UNRESOLVED, None if truth is None else unresolved(e)),
                (StabilityStatus.DISSIPATES, dissipated(e, keeps)),
            ),
            # energy that is lost in a bounce which the steps pass over is lost to the steps
            key=lambda pair: math.inf if pair[1] is None else pair[1].time,
        ),
    ):
        if symptom is not None:
            return verdict, symptom
    if e.motion is None or outcome is Outcome.TOO_SLOW:
        return StabilityStatus.UNRESOLVED, Symptom(0.0, math.nan, outcome.value)
    return _accuracy(e, e.motion, truth)


def _accuracy(e: Evaluation, own: Motion, truth: Motion | None) -> tuple[StabilityStatus, Symptom]:
    """Return how near a sound run is to the exact motion."""
    if e.simulation.case.scene.gravity == 0.0:
        errors = [_orientation_error(e, own.trajectory)]
    elif truth is not None:
        errors = [_phi_error(own, truth), *_turn_errors(e, truth)]
    else:
        end = float(own.time[-1])
        words = "no exact motion; the run reached this time, s"
        return StabilityStatus.STABLE, Symptom(end, end, words)
    worst, allowed = max(errors, key=lambda pair: pair[0].number / pair[1])
    good = worst.number <= allowed  # false for what is no number
    return StabilityStatus.ACCURATE if good else StabilityStatus.INACCURATE, worst


def _phi_error(own: Motion, truth: Motion) -> tuple[Symptom, float]:
    """Return the error of phi over its largest value, rms, and the allowed one."""
    phi = truth.angles.phi
    off = own.angles.phi[: len(phi)] - phi
    share = math.sqrt(float(np.sum(shares(truth.time) * off**2))) / float(phi.max())
    worst = float(truth.time[np.argmax(np.abs(off))])
    return Symptom(worst, share, "error of phi over its largest, rms"), ACCURATE_PHI


def _turn_errors(e: Evaluation, truth: Motion) -> list[tuple[Symptom, float]]:
    """Return the worst error of a turn, or how many bounces are missing, and the allowed size."""
    # a ripple is no bounce; and one is complete in a record once phi has passed its next maximum
    low = (1.0 - 2.0 * PROMINENCE) * float(truth.angles.phi.max())
    known = [bounce for bounce in e.true_bounces if bounce.phi_min < low]
    due = [bounce for bounce in known if bounce.end < _SEEN * float(truth.time[-1])]
    if len(e.bounces) < len(due):
        number = float(len(due) - len(e.bounces))
        return [(Symptom(due[len(e.bounces)].time, number, "bounces missing"), 0.5)]
    pairs = [
        (abs(own.angle_of_turn - true.angle_of_turn), true.time)
        for own, true in zip(e.bounces, known, strict=False)
    ]
    if not pairs:
        return []
    error, time = max(pairs)
    return [(Symptom(time, error, "error of a turn, rad"), ACCURATE_TURN)]


def _orientation_error(e: Evaluation, own: Trajectory) -> tuple[Symptom, float]:
    """Return the largest error of the orientation of a can that flies free, and the allowed one."""
    off = rotation_between(own.quaternion, free_rotation(own, e.simulation.case.scene))
    worst = int(np.argmax(off))
    words = "error of the orientation, rad"
    return Symptom(float(own.time[worst]), float(off[worst]), words), ACCURATE_TURN


def free_rotation(trajectory: Trajectory, scene: Scene) -> Floats:
    """Return the orientations of a can that turns freely, from the first of a trajectory.

    Parameters
    ----------
    trajectory : Trajectory
        Only its times and its first sample matter.
    scene : Scene

    Returns
    -------
    ndarray, shape (n, 4)
        From body to world, scalar first.
    """
    A, C = scene.can.transverse_inertia, scene.can.axial_inertia
    start, omega = trajectory.quaternion[0], trajectory.angular_velocity[0]
    spin = np.array((0.0, 0.0, (1.0 - C / A) * float(to_body(start, omega)[2])))
    rate = omega - spin[2] * to_world(start, np.array((0.0, 0.0, 1.0)))  # L/A
    t = trajectory.time - trajectory.time[0]
    return _product(_product(_turned(rate, t), start), _turned(spin, t))


def _turned(rate: Floats, time: Floats) -> Floats:
    """Return the rotations exp(rate t), shape (n, 4)."""
    speed = float(np.linalg.norm(rate))
    axis = rate / speed if speed > 0.0 else rate
    half = speed * time / 2.0
    return np.concatenate((np.cos(half)[:, None], np.sin(half)[:, None] * axis), axis=1)


def _product(p: Floats, q: Floats) -> Floats:
    """Return the products of quaternions, shapes (..., 4)."""
    w = p[..., :1] * q[..., :1] - np.sum(p[..., 1:] * q[..., 1:], axis=-1, keepdims=True)
    v = p[..., :1] * q[..., 1:] + q[..., :1] * p[..., 1:] + np.cross(p[..., 1:], q[..., 1:])
    return np.concatenate((w, v), axis=-1)


GAIN = LOSS = 0.05
"""Of the energy that the can has to spend: a reader sees such a change of phi at once."""

DEEP = 0.1
"""Of the radius: a can this deep in the plane no longer touches it with its rim."""

LOW = 0.05
"""Of the largest phi: below it for good, the can counts as flat."""

HIGH = 0.5
"""Of the largest phi: above it the exact motion is plainly not flat."""


def available_energy(trajectory: Trajectory, scene: Scene) -> float:
    """Return the energy over that of the can at rest, flat or on its side, at release, J."""
    can = scene.can
    lowest = can.half_height if scene.release.phi < can.balancing_angle else can.radius
    return float(energy(trajectory, scene)[0]) - can.mass * scene.gravity * lowest


def diverged(e: Evaluation) -> Symptom | None:
    """Return when the numbers broke: the record of such a run ends there."""
    if e.simulation.outcome is not Outcome.DIVERGED:
        return None
    trajectory = e.simulation.trajectory
    if trajectory is None:
        return Symptom(0.0, math.nan, "no numbers in the first step")
    speed = np.linalg.norm(trajectory.velocity, axis=1)
    return Symptom(float(trajectory.time[-1]), float(speed.max()), "speed reached, m/s")


def tunnelled(e: Evaluation) -> Symptom | None:
    """Return when the ideal rim was deeper in the plane than a tenth of the radius."""
    trajectory, scene = e.simulation.trajectory, e.simulation.case.scene
    if trajectory is None or scene.gravity == 0.0:
        return None
    gap = contact_point(scene.can, trajectory.position, trajectory.quaternion)[:, 2]
    depth = (min(scene.release.height, 0.0) - gap) / scene.can.radius
    return _first(trajectory.time, depth, DEEP, "depth over the radius")


def gained(e: Evaluation) -> Symptom | None:
    """Return when the energy had grown by a twentieth of the energy that the can has to spend."""
    return _first(*_spent(e, -1.0), GAIN, "energy gained over what the can has to spend")


def dissipated(e: Evaluation, until: float) -> Symptom | None:
    """Return when a twentieth of the spendable energy was lost, up to a time in s."""
    time, lost = _spent(e, 1.0)
    within = time <= until
    return _first(time[within], lost[within], LOSS, "energy lost over what the can has to spend")


def stuck_flat(e: Evaluation, truth: Motion | None) -> Symptom | None:
    """Return when the can lay down for good although the exact motion rises.

    Without an exact motion: when it lay down for longer than the natural time sqrt(R/g).
    """
    if e.motion is None:
        return None
    time, phi, scene = e.motion.time, e.motion.angles.phi, e.simulation.case.scene
    largest = float(phi.max()) if truth is None else float(truth.angles.phi.max())
    up = np.flatnonzero(phi > LOW * largest)
    first = int(up[-1]) + 1 if len(up) else 0
    if first >= len(phi):
        return None
    since = float(time[first])
    if truth is None:
        flat = float(time[-1]) - since > natural_time(scene)
    else:
        flat = bool((truth.angles.phi[truth.time >= since] > HIGH * largest).any())
    largest_since = Symptom(since, float(phi[first:].max()), "largest phi since, rad")
    return largest_since if flat else None


def unresolved(e: Evaluation) -> Symptom | None:
    """Return when the contact point first went round too fast to be counted, in a true bounce."""
    if e.motion is None:
        return None
    for bounce, _ in zip(e.bounces, e.true_bounces, strict=False):
        if not bounce.resolved:
            inside = (e.motion.time >= bounce.start) & (e.motion.time <= bounce.end)
            step = float(np.abs(np.diff(e.motion.angles.psi[inside])).max())
            return Symptom(bounce.time, step, "change of psi in a step, rad")
    return None


def _spent(e: Evaluation, sign: float) -> tuple[Floats, Floats]:
    """Return times and the energy lost (sign 1) or gained (-1), as a share of the spendable."""
    trajectory, scene = e.simulation.trajectory, e.simulation.case.scene
    if trajectory is None:
        return np.empty(0), np.empty(0)
    total = energy(trajectory, scene)
    # lifting the can out of the plane costs what its depth is worth, and is no gain
    lift = scene.can.mass * scene.gravity * max(0.0, -scene.release.height)
    change = sign * (total[0] - total) - (lift if sign < 0.0 else 0.0)
    return trajectory.time, change / available_energy(trajectory, scene)


def _first(time: Floats, values: Floats, limit: float, words: str) -> Symptom | None:
    """Return when values first exceed a limit, and the most they reach."""
    beyond = np.flatnonzero(values > limit)
    if len(beyond) == 0:
        return None
    return Symptom(float(time[beyond[0]]), float(values.max()), words)
