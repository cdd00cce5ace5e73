"""What a record says, in the harness's terms: a convention that the scene confirms, or none.

The convention is that which the scene confirms (`harness.records.confirming`); what was understood
is told. A record that is no motion of the scene is refused.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
from scipy.interpolate import CubicSpline

from harness.core.trajectory import Floats, Trajectory
from harness.engines.stepping.horizon import natural_time
from harness.records.columns import (
    ANGLES,
    CONTACT,
    DEPTH,
    FORCE,
    QUATERNION,
    SPIN,
    VELOCITY,
    Columns,
    RecordFileError,
)
from harness.records.confirming import confirmed, poses_of, spins
from harness.records.convention import (
    Convention,
    multiplied,
    turned,
    vector_from,
)
from harness.records.placing import CONJUGATE, Placed, Poses
from models.rim import contact_point, released
from models.scene import Scene

_SPIN_OFF = 0.05
"""Of the natural rate: an angular velocity that is farther from the release's is another."""

_SPLINE = 4
"""Samples that a cubic spline needs."""

_UNIT = 1e-3
"""Distance of a quaternion from unit length."""

_TOUCHING = 1e-3
"""Of the radius: a can that is nearer to the plane touches it, where no force is recorded."""


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
    if not columns.has(ANGLES):
        _check_lengths(columns)
    chosen, why = confirmed(columns, scene, given)
    poses = poses_of(columns, scene, chosen)
    placed = Placed.of(poses, scene)
    spin, chosen, spin_said = _spin(columns, placed, chosen, given)
    said = f"convention, {why}: {chosen.sentence()}"
    return _assembled(columns, scene, placed, chosen, spin, (said, *placed.said, spin_said))


def _check_lengths(columns: Columns) -> None:
    lengths = np.linalg.norm(columns.stacked(QUATERNION), axis=1)
    off = np.abs(lengths - 1.0)
    if off.max() > _UNIT:
        first = int(np.argmax(off > _UNIT))
        reason = f"the quaternion in sample {first + 1} has length {lengths[first]:.4g}, not 1"
        raise RecordFileError(columns.path, reason)


def _spin(
    columns: Columns, placed: Placed, convention: Convention, given: dict[str, str]
) -> tuple[Floats, Convention, str]:
    """Return the angular velocity in the world, the axes it was given in, and where it is from.

    It is taken in those axes in which it is nearer to what the orientations do.
    """
    derived = _turning(placed.poses)
    if not columns.has(SPIN):
        return derived, convention, "the angular velocity is from the orientations, by splines"
    found = spins(columns, placed, convention)
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
    spin: Floats = 2.0 * multiplied(rate, q * CONJUGATE)[:, 1:]
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
        load = _mean_load(poses, force, scene)
        if load < 0.0:
            reason = (
                "forces pull at the can: they are to be those of the ground on the can, upwards"
            )
            raise RecordFileError(columns.path, reason)
        said.append(f"the mean load is {load:.4g} of the weight")
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
    if columns.has(DEPTH):
        said.append(_sentence_of_depth(depth, -lowest[:, 2], can.radius))
    else:
        said.append("the depth is that of the lowest point of the exact rim")
    height = float(lowest[0, 2])
    if abs(height) > _TOUCHING * can.radius:
        where = "above" if height > 0.0 else "below"
        said.append(f"at the release the exact rim is {abs(height):.3g} m {where} the plane")
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


def _mean_load(poses: Poses, force: Floats, scene: Scene) -> float:
    """Return the mean in time of the vertical force over the weight."""
    weight = scene.can.mass * scene.gravity
    if weight == 0.0:
        return 0.0
    span = poses.time[-1] - poses.time[0]
    return float(np.trapezoid(force[:, 2], poses.time) / (span * weight))


def _sentence_of_depth(depth: Floats, exact: Floats, radius: float) -> str:
    """Return how the recorded depth lies beside that of the exact rim."""
    off = float(np.nanmax(np.abs(depth - exact), initial=0.0))
    if off <= _TOUCHING * radius:
        return "the depth is that of the exact rim"
    return f"the depth is up to {off:.3g} m off that of the exact rim, and is taken as recorded"


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
        f"'{scene.name}' has ({spelled[1]}) rad/s: the first sample must be the release, so cut "
        "what is before it"
    )


def _sentence_of_columns(columns: Columns) -> str:
    """Return in a sentence which columns are taken and which are not."""
    taken = ", ".join(columns.names.values())
    left = f"; left out: {', '.join(columns.left_out)}" if columns.left_out else ""
    return f"columns: {taken}{left}"
