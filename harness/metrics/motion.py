"""What a trajectory says in the paper's terms, derived once and alike for every engine."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from harness.trajectory import Floats, Trajectory
from models.record import Angles, angles_of_record
from models.scene import Scene

_LIGHT = 1e-3
"""Share of the weight; with less a can is about to lift off: that of `reference.guard`, too."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Motion:
    """A trajectory in the paper's terms; every array has n samples.

    Parameters
    ----------
    time : ndarray, shape (n,)
        s.
    angles : Angles
        phi, psi, theta and their rates; psi and theta without jumps.
    locus : ndarray, shape (n, 2)
        Contact locus in the plane, m; NaN where nothing touches.
    friction_ratio : ndarray, shape (n,)
        |F|/N from the engine's own forces; NaN where nothing touches, or hardly: with less than a
        thousandth of the weight, for at lift-off the ratio grows without bound.
    slip : ndarray, shape (n,)
        Horizontal speed of the can's material at the contact point, m/s; NaN likewise.
    touching : ndarray of bool, shape (n,)
    trajectory : Trajectory
    """

    time: Floats
    angles: Angles
    locus: Floats
    friction_ratio: Floats
    slip: Floats
    touching: NDArray[np.bool_]
    trajectory: Trajectory


def motion(trajectory: Trajectory, scene: Scene) -> Motion:
    """Return a trajectory in the paper's terms."""
    release = scene.release
    record = angles_of_record(
        scene.can,
        trajectory.time,
        trajectory.quaternion,
        trajectory.angular_velocity,
        start=(release.psi, release.theta),
    )
    force, point = trajectory.contact_force, trajectory.contact_point
    touching = (force[:, 2] > 0.0) & np.isfinite(point).all(axis=1)
    bears = force[:, 2] >= _LIGHT * scene.can.mass * scene.gravity
    normal = np.where(touching & bears, force[:, 2], np.nan)
    arm = point - trajectory.position
    material = trajectory.velocity + np.cross(trajectory.angular_velocity, arm)
    return Motion(
        time=trajectory.time,
        angles=record,
        locus=np.where(touching[:, None], point[:, :2], np.nan),
        friction_ratio=np.hypot(force[:, 0], force[:, 1]) / normal,
        slip=np.where(touching, np.hypot(material[:, 0], material[:, 1]), np.nan),
        touching=touching,
        trajectory=trajectory,
    )


def shares(time: Floats) -> Floats:
    """Return the share of the whole time that each sample stands for, shape (n,), by trapezia.

    Samples are dense by angle, not by time: a mean over samples would be a mean over the bounce.
    """
    if len(time) == 1:
        return np.ones(1)
    gaps = np.diff(time)
    weights = np.zeros(len(time))
    weights[:-1] += gaps / 2.0
    weights[1:] += gaps / 2.0
    weights /= weights.sum()
    return weights
