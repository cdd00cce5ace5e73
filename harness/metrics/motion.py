"""A trajectory in the paper's terms, derived once and alike for every engine.

Depth, slip, lift-off and several points, in which an engine's contact differs from a rolling point,
are read at the recorded samples, which are dense by angle; a single step between two samples may be
missed.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from harness.core.trajectory import Floats, Trajectory
from models.kinematics import Angles, angles_of_record
from models.scene import Scene

if TYPE_CHECKING:
    import pandas as pd

_LIGHT = 1e-3
"""Share of the weight below which a can is about to lift off, as in `reference.analysis.validity`.
"""


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
    told = np.isfinite(force).all(axis=1)
    bearing = np.where(told, force[:, 2] > 0.0, trajectory.contact_count > 0)
    touching = bearing & np.isfinite(point).all(axis=1)
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


@dataclass(frozen=True, slots=True, kw_only=True)
class ContactQuality:
    """Quality of the contact over a run.

    Parameters
    ----------
    max_penetration : float
        m; zero if the can never sank.
    max_slip : float
        m/s, at the engine's contact point.
    lift_off_fraction : float
        Share of the time without any contact force.
    multi_contact_fraction : float
        Share of the time with more than one contact point that bears a force.
    """

    max_penetration: float
    max_slip: float
    lift_off_fraction: float
    multi_contact_fraction: float


def contact_quality(motion: Motion) -> ContactQuality:
    """Return the quality of the contact over a motion."""
    weight = shares(motion.time)
    depth, slip = motion.trajectory.penetration, motion.slip
    sunk, known = np.isfinite(depth), np.isfinite(slip)
    return ContactQuality(
        max_penetration=max(0.0, float(depth[sunk].max())) if sunk.any() else 0.0,
        max_slip=float(slip[known].max()) if known.any() else 0.0,
        lift_off_fraction=float(weight[~motion.touching].sum()),
        multi_contact_fraction=float(weight[motion.trajectory.contact_count > 1].sum()),
    )


def motion_frame(motion: Motion) -> "pd.DataFrame":
    """Return a motion as a DataFrame, a row a sample, with the units in the column names."""
    import pandas as pd  # noqa: PLC0415 - takes half a second to import

    angles, trajectory = motion.angles, motion.trajectory
    columns = {"t_s": motion.time}
    for name in ("phi", "psi", "theta"):
        columns[f"{name}_rad"] = getattr(angles, name)
    for name in ("phi", "psi", "theta"):
        columns[f"{name}_dot_rad_s"] = getattr(angles, f"{name}_dot")
    for axis, letter in enumerate("xyz"):
        columns[f"{letter}_m"] = trajectory.position[:, axis]
    for axis, letter in enumerate("wxyz"):
        columns[f"quaternion_{letter}"] = trajectory.quaternion[:, axis]
    for axis, letter in enumerate("xy"):
        columns[f"contact_{letter}_m"] = motion.locus[:, axis]
    for axis, letter in enumerate("xyz"):
        columns[f"force_{letter}_N"] = trajectory.contact_force[:, axis]
    columns["friction_ratio"] = motion.friction_ratio
    columns["slip_m_s"] = motion.slip
    columns["penetration_m"] = trajectory.penetration
    return pd.DataFrame(
        {
            **columns,
            "contact_count": trajectory.contact_count,
            "psi_unresolved": angles.unresolved,
        }
    )
