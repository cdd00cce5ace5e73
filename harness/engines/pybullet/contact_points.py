"""Contact points of PyBullet as numbers, summed up for many states."""

from collections.abc import Sequence
from struct import Struct
from typing import Any, TypeAlias

import numpy as np

from harness.engines import Floats, Integers

ContactPoint: TypeAlias = tuple[Any, ...]

POINT = Struct("19d")
"""A contact point: positions on can and ground, normal towards the can, distance, normal force, and
twice a friction force with its direction: the places 5 to 13 of PyBullet's tuple."""


def numbers_of(points: Sequence[ContactPoint]) -> Floats:
    """Return contact points as numbers, shape (n, 19), in the order of `POINT`."""
    rows = [
        (*own, *other, *normal, gap, force, along, *first, across, *second)
        for _, _, _, _, _, own, other, normal, gap, force, along, first, across, second in points
    ]
    return np.array(rows).reshape(-1, POINT.size // 8)


def resultants(points: Floats, counts: Integers) -> Floats:
    """Return the resultants of PyBullet's contact points between can and ground.

    Parameters
    ----------
    points : ndarray, shape (m, 19)
        Those of one state after the other, as `POINT` orders them.
    counts : ndarray of int, shape (n,)
        Points of each state.

    Returns
    -------
    ndarray, shape (n, 8)
        Force-weighted point (3), force on the can (3), depth of the deepest point, number of points
        that bear a force. Cached points without force stay out of the locus: they may be half a can
        away.
    """
    sums, first = np.zeros((8, len(counts))), np.cumsum(counts) - counts
    place, force, depth, bearing = sums[:3], sums[3:6], sums[6], sums[7]
    total, depth[:] = np.zeros(len(counts)), -np.inf
    # point by point, as one would add them: the numbers do not depend on how many states there are
    for number in range(int(counts.max(initial=0))):
        has = counts > number
        states = slice(None) if has.all() else np.flatnonzero(has)
        single = len(points) == len(counts) and has.all()
        rows = (points if single else points.take(first[states] + number, axis=0)).T.copy()
        own, other, normal, along, across = (rows[at : at + 3] for at in (0, 3, 6, 12, 16))
        gap, n, f1, f2 = rows[9], rows[10], rows[11], rows[15]
        depth[states] = np.maximum(depth[states], -gap)
        idle = n <= 0.0
        if idle.any():
            rows[10:12, idle] = f2[idle] = 0.0
        force[:, states] += n * normal + f1 * along + f2 * across
        place[:, states] += n * (own + other) / 2.0
        total[states] += n
        bearing[states] += ~idle
    place /= np.where(total == 0.0, np.nan, total)
    depth[counts == 0] = np.nan
    return sums.T
