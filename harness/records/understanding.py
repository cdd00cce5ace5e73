"""What a record says, in the harness's terms: a convention that the scene confirms, or none.

Columns that are written by our convention need no option. Otherwise every convention is tried that
the user has not ruled out: one is taken if the record then starts as the scene's release does, and
goes on as its exact motion up to the first bounce; what was understood is told. If none fits, or
several that differ, the record is refused.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from scipy.interpolate import CubicSpline

from harness.core.trajectory import Floats, Trajectory
from harness.engines.reference.to_reference_problem import refusal
from harness.engines.reference.truth import truth
from harness.engines.stepping.horizon import natural_time
from harness.metrics.error import rotation_between
from harness.records.columns import (
    ANGLES,
    CONTACT,
    DEPTH,
    FORCE,
    POSITION,
    QUATERNION,
    SPIN,
    VELOCITY,
    Columns,
    RecordFileError,
)
from harness.records.convention import (
    Convention,
    body_vector_from,
    continuous,
    conventions,
    multiplied,
    quaternion_from,
    turned,
    vector_from,
)
from harness.records.placing import ALIKE, Placed, Poses
from models.kinematics import angles as angles_of
from models.kinematics import quaternion as quaternion_of
from models.rim import contact_point, released
from models.scene import Scene

_TILT_OFF, _HEIGHT_OFF, _SPIN_OFF = 0.02, 0.02, 0.05
"""Of the tilt of the release, of the radius, and of the natural rate: a start that is farther from
the scene's is another."""

_MOTION_OFF = 0.1
"""rad, and radii: a motion that is farther from the exact one before its first bounce is another,
where a convention is sought."""

_CLEARLY = 0.3
"""rad, radii, and share of the next best: a whole motion that is nearer decides between several."""

_CONJUGATE = np.array((1.0, -1.0, -1.0, -1.0))

_SPLINE = 4
"""Samples that a cubic spline needs."""

_UNIT = 1e-3
"""Distance of a quaternion from unit length."""

_TOUCHING = 1e-3
"""Of the radius: a can that is nearer to the plane touches it, where no force is recorded."""

_SAMPLES = 400
"""Of the start of a record, in which conventions are tried."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Understood:
    """A record in the harness's terms.

    Parameters
    ----------
    trajectory : Trajectory
    convention : Convention
    said : tuple of str
        What was understood of the file, in sentences.
    unknown : tuple of str
        What it cannot tell and why, in sentences.
    """

    trajectory: Trajectory
    convention: Convention
    said: tuple[str, ...]
    unknown: tuple[str, ...]


def understand(columns: Columns, scene: Scene, given: dict[str, str]) -> Understood:
    """Return a record in the harness's terms.

    Parameters
    ----------
    columns : Columns
    scene : Scene
        Whose motion it is said to be.
    given : dict of str to str
        Parts of the convention that are known, as in `Convention`.

    Raises
    ------
    RecordFileError
        If the record does not start as the scene's release does, or no convention is found.
    """
    chosen, why = _confirmed(columns, scene, given)
    poses = _poses(columns, scene, chosen)
    placed = Placed.of(poses, scene)
    spin, chosen, spin_said = _spin(columns, placed, chosen, given)
    said = f"convention, {why}: {chosen.sentence()}"
    return _assembled(columns, scene, placed, chosen, spin, (said, *placed.said, spin_said))


def _poses(columns: Columns, scene: Scene, convention: Convention) -> Poses:
    """Return the poses of a record by a convention, the time from its first sample on."""
    time = columns.quantities["time"]
    if columns.has(ANGLES):
        q = continuous(quaternion_of(*(columns.quantities[name] for name in ANGLES)))
    else:
        q = quaternion_from(convention, columns.stacked(QUATERNION))
    position = vector_from(convention, columns.stacked(POSITION))
    if convention.origin == "base":
        position = position + turned(q, np.array((0.0, 0.0, scene.can.half_height)))
    return Poses(time=time - time[0], position=position, quaternion=q)


_CONFIRMED = "confirmed by the motion up to the bounce"
_TOLD_APART = "confirmed by the whole motion"
_ASSUMED = "assumed, since others fit as well"
_STARTS = "assumed, since the start is the release's, but no convention comes near the exact motion"
_NO_MOTION = "confirmed by the release alone: the scene has no exact motion"


def _confirmed(columns: Columns, scene: Scene, given: dict[str, str]) -> tuple[Convention, str]:
    """Return the convention that the scene confirms, and what confirms it."""
    if not columns.has(ANGLES):
        _check_lengths(columns)
    every = tuple(conventions(given, angles=columns.has(ANGLES)))
    ours, few = every[0], _few(columns)
    wrong = {one: _wrong_start(_poses(few, scene, one), scene) for one in every}
    starting = [one for one in every if not wrong[one]]
    fitting = [one for one in starting if _strays(columns, scene, one) <= _MOTION_OFF]
    fitting = list(_different(columns, scene, fitting))
    if len(fitting) > 1:  # alike up to the bounce: the whole motion tells, if it is near to any
        off = {one: _strays(columns, scene, one, whole=True) for one in fitting}
        best, second = sorted(fitting, key=lambda one: off[one])[:2]
        if off[best] <= _CLEARLY and off[best] <= _CLEARLY * off[second]:
            return best, _TOLD_APART
        if ours not in fitting:
            words = "; or ".join(one.words() or "ours" for one in fitting)
            reason = f"several conventions fit and differ: choose one by --convention: {words}"
            raise RecordFileError(columns.path, reason)
        return ours, _ASSUMED
    if fitting:
        return fitting[0], _NO_MOTION if refusal(scene) else _CONFIRMED
    if ours in starting:  # it starts well: what it does later is its program's
        return ours, _STARTS
    reason = f"is no motion of scene '{scene.name}' by any convention that is left: {wrong[ours]}"
    raise RecordFileError(columns.path, reason)


def _check_lengths(columns: Columns) -> None:
    lengths = np.linalg.norm(columns.stacked(QUATERNION), axis=1)
    off = np.abs(lengths - 1.0)
    if off.max() > _UNIT:
        first = int(np.argmax(off > _UNIT))
        reason = f"the quaternion in sample {first + 1} has length {lengths[first]:.4g}, not 1"
        raise RecordFileError(columns.path, reason)


def _few(columns: Columns) -> Columns:
    """Return the first sample, and those that are needed to know a start."""
    return replace(columns, quantities={k: v[:1] for k, v in columns.quantities.items()})


def _wrong_start(poses: Poses, scene: Scene) -> str:
    """Return how the first sample differs from the release; empty if it does not."""
    can, release = scene.can, scene.release
    phi, _, _ = (float(each) for each in angles_of(poses.quaternion[0]))
    if abs(phi - release.phi) > _TILT_OFF * release.phi:
        return f"it starts at a tilt of {phi:.6g} rad, and the release is at {release.phi:.6g} rad"
    pose, _ = released(scene)
    height, expected = float(poses.position[0, 2]), float(pose.position[2])
    if abs(height - expected) > _HEIGHT_OFF * can.radius:
        return (
            f"its centre starts at a height of {height:.6g} m, and the release is at "
            f"{expected:.6g} m"
        )
    return ""


def _strays(
    columns: Columns, scene: Scene, convention: Convention, *, whole: bool = False
) -> float:
    """Return how far a record is from the exact motion, rad or radii, whichever is more.

    Before its first bounce the farthest, and over the whole record the median. Zero where there is
    no exact motion.
    """
    if refusal(scene):
        return 0.0
    exact = truth(scene)
    until = exact.bounces[0].time if exact.bounces else exact.ends
    time = columns.quantities["time"] - columns.quantities["time"][0]
    count = len(time) if whole else max(int(np.searchsorted(time, 0.9 * until)), 2)
    keep = np.unique(np.linspace(0, count - 1, min(count, _SAMPLES)).astype(np.int64))
    some = replace(columns, quantities={k: v[keep] for k, v in columns.quantities.items()})
    poses = Placed.of(_poses(some, scene, convention), scene).poses
    inside = poses.time <= exact.ends
    if not inside.any():
        return math.inf
    true = exact.at(poses.time[inside])
    angle = rotation_between(poses.quaternion[inside], true.quaternion)
    distance = np.linalg.norm(poses.position[inside] - true.position, axis=1) / scene.can.radius
    off = np.maximum(angle, distance)
    return float(np.median(off) if whole else off.max())


def _different(columns: Columns, scene: Scene, fitting: list[Convention]) -> Iterator[Convention]:
    """Yield the first of all conventions by which a record is the same motion."""
    seen: list[Poses] = []
    for one in fitting:
        own = Placed.of(_poses(columns, scene, one), scene).poses
        apart = (
            max(
                float(rotation_between(own.quaternion, other.quaternion).max()),
                float(np.abs(own.position - other.position).max()) / scene.can.radius,
            )
            for other in seen
        )
        if all(distance > ALIKE for distance in apart):
            seen.append(own)
            yield one


def _spin(
    columns: Columns, placed: Placed, convention: Convention, given: dict[str, str]
) -> tuple[Floats, Convention, str]:
    """Return the angular velocity in the world, the axes it was given in, and where it is from.

    It is taken in those axes in which it is nearer to what the orientations do.
    """
    derived = _turning(placed.poses)
    if not columns.has(SPIN):
        return derived, convention, "the angular velocity is from the orientations, by splines"
    own = columns.stacked(SPIN)
    found = {
        "world": turned(placed.heading, vector_from(convention, own, axial=True)),
        "body": turned(
            placed.poses.quaternion,
            turned(placed.roll * _CONJUGATE, body_vector_from(convention, own)),
        ),
    }
    # the median: at a bounce samples are too coarse for a spline
    off = {
        axes: float(np.median(np.linalg.norm(vectors - derived, axis=1)))
        for axes, vectors in found.items()
    }
    axes = given.get("spin") or min(off, key=lambda one: off[one])
    told = replace(convention, spin=axes)
    return found[axes], told, f"the angular velocity is in the axes of the {axes}"


def _turning(poses: Poses) -> Floats:
    """Return the angular velocity of orientations, shape (n, 3), rad/s, by cubic splines."""
    q = poses.quaternion / np.linalg.norm(poses.quaternion, axis=1)[:, None]
    rate = CubicSpline(poses.time, q)(poses.time, 1)
    spin: Floats = 2.0 * multiplied(rate, q * _CONJUGATE)[:, 1:]
    return spin


def _assembled(  # noqa: PLR0917 - what was found so far
    columns: Columns,
    scene: Scene,
    placed: Placed,
    convention: Convention,
    spin: Floats,
    found: tuple[str, ...],
) -> Understood:
    """Return the motion of a record, and what it says and cannot say."""
    poses, can = placed.poses, scene.can
    said, unknown = [_sentence_of_columns(columns), *found], []
    lowest = contact_point(can, poses.position, poses.quaternion)
    force = np.full_like(poses.position, math.nan)
    if columns.has(FORCE):
        force = turned(placed.heading, vector_from(convention, columns.stacked(FORCE)))
    else:
        unknown.append("friction and load: the record has no forces (force_x_n, ...)")
    if columns.has(VELOCITY):
        velocity = turned(placed.heading, vector_from(convention, columns.stacked(VELOCITY)))
        if convention.origin == "base":
            arm = turned(poses.quaternion, np.array((0.0, 0.0, can.half_height)))
            velocity = velocity + np.cross(spin, arm)
    else:
        velocity = CubicSpline(poses.time, poses.position)(poses.time, 1)
        said.append("the velocity is from the positions, by splines")
    depth = columns.quantities["depth"] if columns.has(DEPTH) else -lowest[:, 2]
    if not columns.has(DEPTH):
        said.append("the depth is that of the lowest point of the exact rim")
    touching = force[:, 2] > 0.0 if columns.has(FORCE) else depth > -_TOUCHING * can.radius
    point = lowest * (1.0, 1.0, 0.0)
    if columns.has(CONTACT) and convention.up == "z":
        there = np.column_stack((columns.stacked(CONTACT), np.zeros(len(point))))
        point = turned(placed.heading, vector_from(convention, there)) + placed.shift
    else:
        unknown.append(
            "the engine's own contact point: the record has none with z up (contact_x_m, "
            "contact_y_m), and the lowest point of the exact rim stands for it"
        )
    trajectory = Trajectory(
        time=poses.time,
        position=poses.position,
        quaternion=poses.quaternion,
        velocity=velocity,
        angular_velocity=spin,
        contact_point=np.where(touching[:, None], point, math.nan),
        contact_force=force,
        penetration=depth,
        contact_count=touching.astype(np.int64),
    )
    known = 0.0 if columns.has(SPIN) else _spline_error(poses)
    if wrong := _wrong_rates(trajectory, scene, known):
        raise RecordFileError(columns.path, wrong)
    return Understood(
        trajectory=trajectory, convention=convention, said=tuple(said), unknown=tuple(unknown)
    )


def _spline_error(poses: Poses) -> float:
    """Return how far a spline through every other sample starts from one through all, rad/s."""
    few = replace(poses, time=poses.time[::2], quaternion=poses.quaternion[::2])
    if len(few.time) < _SPLINE:
        return math.inf
    return float(np.linalg.norm(_turning(few)[0] - _turning(poses)[0]))


def _wrong_rates(trajectory: Trajectory, scene: Scene, known: float) -> str:
    """Return how the first angular velocity differs from the release's; empty if it does not.

    It is known to within `known`, rad/s.
    """
    _, twist = released(scene)
    own, expected = trajectory.angular_velocity[0], twist.angular_velocity
    scale = float(np.linalg.norm(expected)) + 1.0 / natural_time(scene)
    if float(np.linalg.norm(own - expected)) <= _SPIN_OFF * scale + known:
        return ""
    spelled = [", ".join(f"{part:.4g}" for part in one) for one in (own, expected)]
    return (
        f"it starts with an angular velocity of ({spelled[0]}) rad/s, and the release of scene "
        f"'{scene.name}' has ({spelled[1]}) rad/s"
    )


def _sentence_of_columns(columns: Columns) -> str:
    """Return in a sentence which columns are taken and which are not."""
    taken = ", ".join(columns.names.values())
    left = f"; left out: {', '.join(columns.left_out)}" if columns.left_out else ""
    return f"columns: {taken}{left}"
