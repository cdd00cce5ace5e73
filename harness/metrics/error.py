"""Errors of an engine's motion against the exact one, in named quantities and norms.

The two motions are compared at the engine's instants. A pointwise difference after a bounce mixes
the delay of the bounce with the error of its turn; so the shift in time, the error of the turn and
the errors before and after the bounce are separate numbers. Orientations are compared as rotations,
psi and theta without jumps; raw Euler angles are never subtracted.
"""

import itertools
import math
from dataclasses import dataclass

import numpy as np
import scipy

from harness.core.bounce import Bounce
from harness.core.trajectory import Floats, Integers
from harness.metrics.motion import Motion, shares


@dataclass(frozen=True, slots=True, kw_only=True)
class Errors:
    """Differences engine minus truth; NaN where there is nothing to compare. SI and rad.

    Parameters
    ----------
    phi_rms, phi_max : float
        Of phi over the whole run.
    phi_rms_before, phi_rms_after : float
        Up to the time of the first true bounce, and after it.
    rotation_rms : float
        Angle of the rotation that takes the true orientation to the engine's.
    psi_rms, theta_rms : float
        Of the angles without jumps.
    angle_of_turn, rotation_turn, time_of_bounce, phi_min, peak_friction_ratio : tuple of float
        Signed, for each bounce that both have completed.
    contact_locus_rms, contact_locus_max : float
        Distance of the contact points at the same instant.
    contact_locus_hausdorff : float
        Largest distance from a point of one curve to the other curve, whenever it is reached.
    """

    phi_rms: float
    phi_max: float
    phi_rms_before: float
    phi_rms_after: float
    rotation_rms: float
    psi_rms: float
    theta_rms: float
    angle_of_turn: tuple[float, ...]
    rotation_turn: tuple[float, ...]
    time_of_bounce: tuple[float, ...]
    phi_min: tuple[float, ...]
    peak_friction_ratio: tuple[float, ...]
    contact_locus_rms: float
    contact_locus_max: float
    contact_locus_hausdorff: float


def errors(
    own: Motion,
    true: Motion,
    own_bounces: tuple[Bounce, ...],
    true_bounces: tuple[Bounce, ...],
    true_locus: Floats,
) -> Errors:
    """Return the errors of a motion.

    Parameters
    ----------
    own, true : Motion
        At the same instants, shape (n,).
    own_bounces, true_bounces : tuple of Bounce
    true_locus : ndarray, shape (m, 2)
        The true contact locus on a grid dense by angle, m.
    """
    weight = shares(own.time)
    phi = own.angles.phi - true.angles.phi
    split = true_bounces[0].time if true_bounces else math.inf
    before = own.time <= split
    distance = np.linalg.norm(own.locus - true.locus, axis=1)
    touching = np.isfinite(distance)
    pairs = list(zip(own_bounces, true_bounces, strict=False))
    return Errors(
        phi_rms=_rms(phi, weight),
        phi_max=float(np.abs(phi).max()),
        phi_rms_before=_rms(phi[before], weight[before]),
        phi_rms_after=_rms(phi[~before], weight[~before]),
        rotation_rms=_rms(
            rotation_between(own.trajectory.quaternion, true.trajectory.quaternion), weight
        ),
        psi_rms=_rms(own.angles.psi - true.angles.psi, weight),
        theta_rms=_rms(own.angles.theta - true.angles.theta, weight),
        angle_of_turn=tuple(f.angle_of_turn - t.angle_of_turn for f, t in pairs),
        rotation_turn=tuple(f.rotation_turn - t.rotation_turn for f, t in pairs),
        time_of_bounce=tuple(f.time - t.time for f, t in pairs),
        phi_min=tuple(f.phi_min - t.phi_min for f, t in pairs),
        # where the truth asks the plane to pull, its ratio is infinite
        peak_friction_ratio=tuple(
            f.peak_friction_ratio - t.peak_friction_ratio
            if math.isfinite(t.peak_friction_ratio)
            else math.nan
            for f, t in pairs
        ),
        contact_locus_rms=_rms(distance[touching], weight[touching]),
        contact_locus_max=float(distance[touching].max()) if touching.any() else math.nan,
        contact_locus_hausdorff=hausdorff(own.locus[touching], true_locus),
    )


def _rms(values: Floats, weight: Floats) -> float:
    """Return the root of the weighted mean square, NaN of nothing."""
    total = float(weight.sum())
    return math.sqrt(float(np.sum(weight * values**2)) / total) if total > 0.0 else math.nan


def rotation_between(first: Floats, second: Floats) -> Floats:
    """Return the angle between orientations, shape (n,), rad, in [0, pi]."""
    w1, v1 = first[:, 0], first[:, 1:]
    w2, v2 = second[:, 0], second[:, 1:]
    scalar = w1 * w2 + np.sum(v1 * v2, axis=1)
    vector = w1[:, None] * v2 - w2[:, None] * v1 - np.cross(v1, v2)
    angle: Floats = 2.0 * np.arctan2(np.linalg.norm(vector, axis=1), np.abs(scalar))
    return angle


_NEIGHBOURS = 16
"""Points of a curve whose chords are tried: more than cross in one place of a contact locus."""


def hausdorff(first: Floats, second: Floats) -> float:
    """Return the Hausdorff distance of two curves given by their points, shapes (n, 2), (m, 2).

    Each point is measured against the chords that meet in the other curve's nearest points, so that
    the spacing of the points does not count as a distance.
    """
    if len(first) < 2 or len(second) < 2:  # noqa: PLR2004 - a curve has two ends
        return math.nan
    return max(_farthest(first, second), _farthest(second, first))


_FIRST = 64
"""Points whose chords are all tried first; four times as many in each turn that follows."""


def _farthest(points: Floats, curve: Floats) -> float:
    """Return the largest distance from points (n, 2) to a curve (m, 2).

    The chords of the nearest point alone bound a distance from above, and bring most of it. So the
    others are tried from the largest bound on, until what was found is no less than what is left.
    """
    tree = scipy.spatial.KDTree(curve)
    # components of their own: sums over an axis of two take several times as long
    ends, own = np.ascontiguousarray(curve.T), np.ascontiguousarray(points.T)

    def distances(tried: Integers | slice, count: int) -> Floats:
        """Return squares of distances to the chords of so many nearest points."""
        _, near = tree.query(points[tried], k=np.arange(1, 1 + min(count, len(curve))))
        return _nearest_chord(own[:, tried], ends, near)

    everything = slice(None)
    bound = distances(everything, 1)
    # where the curve crosses itself the nearest chord need not end in the nearest point
    if not np.isfinite(bound).all():  # numbers that break have no order
        return math.sqrt(distances(everything, _NEIGHBOURS).max())
    order = np.argsort(-bound)
    found, start, count = -math.inf, 0, _FIRST
    while start < len(order) and bound[order[start]] > found:
        tried = order[start : start + count]
        found = max(found, float(distances(tried, _NEIGHBOURS).max()))
        start, count = start + count, 4 * count
    return math.sqrt(found)


def _nearest_chord(points: Floats, curve: Floats, near: Integers) -> Floats:
    """Return the square of the distance of points to the nearest of some chords, shape (n,).

    Parameters
    ----------
    points, curve : ndarray, shape (2, n), (2, m)
    near : ndarray of int, shape (n, k)
        Points of the curve in which the chords meet that are tried.
    """
    (own_x, own_y), (x, y) = points, curve
    along, across = np.diff(x), np.diff(y)
    square = along * along + across * across
    best = np.full(len(own_x), np.inf)
    for nearest, offset in itertools.product(np.ascontiguousarray(near.T), (-1, 0)):
        left = np.clip(nearest + offset, 0, len(x) - 2)
        chord_x, chord_y, length = along[left], across[left], square[left]
        arm_x, arm_y = own_x - x[left], own_y - y[left]
        share = np.zeros(len(own_x))
        np.divide(arm_x * chord_x + arm_y * chord_y, length, out=share, where=length > 0.0)
        np.clip(share, 0.0, 1.0, out=share)
        off_x, off_y = arm_x - share * chord_x, arm_y - share * chord_y
        best = np.minimum(best, off_x * off_x + off_y * off_y)
    return best
