"""Sampling a motion by angle.

Half the paper's motion happens within a microsecond: a grid even in time misses it. Here no angle
changes by more than 0.02 rad between samples.
"""

from typing import Protocol

import numpy as np

from reference.problem.states import Floats, States

LARGEST_ANGLE = 0.02
LARGEST_TIME = 0.25
MOST_PASSES = 60


class _Path(Protocol):
    def at(self, times: Floats) -> States: ...


def grid_by_angle(path: _Path, landmarks: Floats) -> Floats:
    """Refine `landmarks` until precession, rotation and nutation change little between samples.

    Parameters
    ----------
    path : Path
    landmarks : ndarray, shape (m,)
        Times that must be in the grid, in any order.

    Returns
    -------
    ndarray, shape (n,)
        Increasing times; neighbours differ by at most 0.02 rad in each angle and 0.25 in time,
        unless they are already neighbouring doubles.
    """
    times = np.unique(landmarks)
    angles = _angles(path, times)
    for _ in range(MOST_PASSES):
        gap = np.diff(times)
        turn = np.abs(np.diff(angles, axis=0)).max(axis=1)
        # a step of 0.02 exactly, recomputed, may exceed 0.02 by rounding: aim a little lower
        parts = np.ceil(np.maximum(turn / (0.98 * LARGEST_ANGLE), gap / LARGEST_TIME))
        split = (
            (parts > 1)
            & (gap > 4 * np.spacing(times[1:]))
            & ((turn > LARGEST_ANGLE) | (gap > LARGEST_TIME))
        )
        if not split.any():
            break
        # never more than 16 parts at once: where the turn is uneven, even parts are wasted
        counts = np.minimum(parts[split], 16).astype(int)
        new = np.concatenate(
            [
                left + width * np.arange(1, n) / n
                for left, width, n in zip(times[:-1][split], gap[split], counts, strict=True)
            ]
        )
        merged = np.concatenate([times, new])
        order = np.argsort(merged, kind="stable")
        angles = np.concatenate([angles, _angles(path, new)])[order]
        times = merged[order]
        keep = np.concatenate([[True], np.diff(times) > 0])
        times, angles = times[keep], angles[keep]
    return times


def _angles(path: _Path, times: Floats) -> Floats:
    states = path.at(times)
    return np.stack([states.phi, states.psi, states.theta], axis=1)
