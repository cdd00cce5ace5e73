"""Recording by angle, not by time: dense where the can races round its rim, sparse elsewhere.

A sample is kept whenever the path of (phi, psi, theta) has grown by `ANGLE_STEP`, or time by its
own share, since the last one. The path is summed over every step of the engine, so the choice does
not depend on how the run is cut into chunks, and of a bounce that lasts one step nothing is lost.
"""

import numpy as np
from numpy.typing import NDArray

from harness.engines.chunk import Chunk
from harness.engines.horizon import natural_time
from harness.trajectory import Floats, Trajectory, join, take
from models.scene import Scene

ANGLE_STEP = 0.02
"""rad: a chord of the rim this long leaves the locus by R ANGLE_STEP^2/8, 5e-5 of the radius."""

SAMPLES_IN_TIME = 200
"""Samples in the natural time sqrt(R/g), at most a bounce long, where no angle moves."""


class Recorder:
    """Takes every step of a run in chunks and keeps what the angles call for."""

    def __init__(self, scene: Scene) -> None:
        self._time_step = natural_time(scene) / SAMPLES_IN_TIME
        self._parts: list[Trajectory] = []
        self._path = 0.0
        self._last: tuple[float, Floats] | None = None
        self._chunk: Chunk | None = None

    def add(self, chunk: Chunk) -> Trajectory | None:
        """Record a chunk that follows the one before; return the part of it that was kept."""
        count = len(chunk.quaternions)
        if count == 0:
            return None
        keep = np.flatnonzero(self._keep(chunk.times[:count], chunk.quaternions))
        self._last = (float(chunk.times[count - 1]), chunk.quaternions[-1])
        self._chunk = chunk
        if len(keep) == 0:
            return None
        kept = chunk.read(keep)
        self._parts.append(kept)
        return kept

    def _keep(self, time: Floats, quaternion: Floats) -> NDArray[np.bool_]:
        """Return which of the samples the path calls for, shape (n,)."""
        first = self._last is None
        if self._last is not None:
            time = np.concatenate(([self._last[0]], time))
            quaternion = np.vstack((self._last[1], quaternion))
        growth = _path(quaternion) / ANGLE_STEP + np.diff(time) / self._time_step
        # summed from the first step on, not chunk by chunk, so that round-off is that of one chunk
        path = np.cumsum(np.concatenate((np.array([self._path]), growth)))
        self._path = float(path[-1])
        keep = np.diff(np.floor(path)) > 0.0
        return np.concatenate((np.ones(1, dtype=np.bool_), keep)) if first else keep

    def trajectory(self, until: float) -> Trajectory | None:
        """Return what was kept up to a time in s, and the last step whether or not it was."""
        parts = self._parts
        if self._chunk is None or self._last is None:
            return None
        if parts[-1].time[-1] < self._last[0]:
            parts = [*parts, self._chunk.read(np.array([len(self._chunk.quaternions) - 1]))]
        whole = join(parts)
        return take(whole, whole.time <= until)


def _path(quaternion: Floats) -> Floats:
    """Return how far (phi, psi + theta, psi - theta) move from sample to sample, shape (n-1,), rad.

    In half angles the quaternion is two complex numbers, cos(phi/2) exp(i (psi + theta)/2) and
    sin(phi/2) exp(i (psi - theta)/2), see `models.kinematics`. A turn of one of them is its cross
    product over its dot product from sample to sample: the tangent, which is the angle where
    samples are dense, and more than it where they are not. No arctangent of millions of steps is
    needed.
    """
    w, x, y, z = np.ascontiguousarray(quaternion.T)
    upright = w[:-1] * w[1:] + z[:-1] * z[1:]
    tilted = x[:-1] * x[1:] + y[:-1] * y[1:]
    turned = np.abs(w[:-1] * z[1:] - z[:-1] * w[1:])
    raced = np.abs(x[:-1] * y[1:] - y[:-1] * x[1:])
    square = x * x + y * y
    rocked = np.abs(np.diff(square))
    size = np.sqrt(square[1:] * (1.0 - square[1:]))
    path: Floats = _over(rocked, size) + 2.0 * (_over(turned, upright) + _over(raced, tilted))
    return path


def _over(part: Floats, whole: Floats) -> Floats:
    """Return a ratio; pi behind a right angle, or where the can is flat: always worth keeping."""
    if whole.size and whole.min() > 0.0:  # a masked division takes three times as long
        return part / whole
    return np.divide(part, whole, out=np.full_like(part, np.pi), where=whole > 0.0)
