"""Recording by angle: dense where the can races round its rim, sparse elsewhere.

A sample is recorded whenever the path of (phi, psi, theta) has grown by `ANGLE_STEP`, or time by
its share, since the last sample. The path is summed over every step of the engine, so the choice
does not depend on how the run is cut into chunks, and no part of a bounce of one step is lost.

How fast the path grows follows from a state alone, so an engine that pays for each reading need not
read every step of a slow motion: `READINGS_PER_SAMPLE` readings between two samples are enough, and
where the can races round its rim that is every step. The rate may change in between. Near the flat
state the path grows with 1/phi^2, so a pause also ends before phi has changed by `CHANGE`; a
contact that is lost or made changes the rates themselves, by what a fall gives, sqrt(g/R), and a
pause ends before that could have changed phi by as much.
"""

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from harness.core.simulation import Outcome, Simulation
from harness.core.trajectory import Floats, Integers, Trajectory, join
from harness.engines.stepping.horizon import Watch, natural_time
from models.kinematics import nutation
from models.scene import Scene


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Chunk:
    """Consecutive steps: the states before them with the contacts that they solved.

    An engine that pays for each reading may read some of the steps only; each of those then
    stands for the steps up to the next.

    Parameters
    ----------
    times : ndarray, shape (n,)
        Of the states that were read, each before its step, s.
    quaternions : ndarray, shape (m, 4)
        Of the first m states, scalar first; fewer than n if the engine's numbers broke.
    constraint_rows : ndarray of int, shape (n,)
        Rows that each of those steps solved for.
    sound : bool
        False if the engine's numbers broke within or right after these steps.
    read : callable
        Takes indices of the first m states and returns those states as a trajectory: most steps of
        a run are never looked at again.
    spans : ndarray of int, shape (n,), or None
        Steps that each reading stands for, its own the first; None where every step was read.
    """

    times: Floats
    quaternions: Floats
    constraint_rows: Integers
    sound: bool
    read: Callable[[Integers], Trajectory]
    spans: Integers | None = None


def trajectory_of(
    time: Floats, motion: Floats, contact: tuple[Floats, Floats, Floats, NDArray[np.generic]]
) -> Trajectory:
    """Return states of a run as a trajectory.

    Parameters
    ----------
    time : ndarray, shape (n,)
        s.
    motion : ndarray, shape (n, 13)
        Position, quaternion (scalar first), velocity and angular velocity, in world coordinates.
    contact : tuple
        Point (n, 3), force on the can (n, 3), depth (n,) and number of points (n,).
    """
    point, force, depth, count = contact
    return Trajectory(
        time=time,
        position=motion[:, :3],
        quaternion=motion[:, 3:7],
        velocity=motion[:, 7:10],
        angular_velocity=motion[:, 10:],
        contact_point=point,
        contact_force=force,
        penetration=depth,
        contact_count=count.astype(np.int64),
    )


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
        """Record a chunk that follows the one before; return the samples recorded of it."""
        count = len(chunk.quaternions)
        if count == 0:
            return None
        keep = np.flatnonzero(self._keep(chunk.times[:count], chunk.quaternions))
        self._last = (float(chunk.times[count - 1]), chunk.quaternions[-1])
        self._chunk = chunk
        if len(keep) == 0:
            return None
        samples = chunk.read(keep)
        self._parts.append(samples)
        return samples

    def _keep(self, time: Floats, quaternion: Floats) -> NDArray[np.bool_]:
        """Return which of the samples the path calls for, shape (n,)."""
        first = self._last is None
        if self._last is not None:
            time = np.concatenate(([self._last[0]], time))
            quaternion = np.vstack((self._last[1], quaternion))
        path = np.empty(len(time))
        path[0] = self._path
        path[1:] = _path(quaternion) / ANGLE_STEP + (time[1:] - time[:-1]) / self._time_step
        # summed from the first step on, not chunk by chunk, so that round-off is that of one chunk
        path.cumsum(out=path)
        self._path = float(path[-1])
        whole = np.floor(path)
        keep = whole[1:] > whole[:-1]
        return np.concatenate((np.ones(1, dtype=np.bool_), keep)) if first else keep

    def trajectory(self, until: float) -> Trajectory | None:
        """Return the samples recorded up to a time in s, and the last step in any case."""
        parts = self._parts
        if self._chunk is None or self._last is None:
            return None
        if parts[-1].time[-1] < self._last[0] <= until:
            parts = [*parts, self._chunk.read(np.array([len(self._chunk.quaternions) - 1]))]
        return join(parts, until)


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
    rocked = np.abs(square[1:] - square[:-1])
    size = np.sqrt(square[1:] * (1.0 - square[1:]))
    path: Floats = _over(rocked, size) + 2.0 * (_over(turned, upright) + _over(raced, tilted))
    return path


def _over(part: Floats, total: Floats) -> Floats:
    """Return a ratio; pi behind a right angle, or where the can is flat: always worth keeping."""
    if total.size and total.min() > 0.0:  # a masked division takes three times as long
        return part / total
    return np.divide(part, total, out=np.full_like(part, np.pi), where=total > 0.0)


_MOST_STEPS = 100_000_000
"""Steps, minutes of the fastest engine, from which a run counts as one that does not end."""


def record(
    prepared: Simulation,
    chunks: Iterable[Chunk],
    seen: Callable[[Floats, Floats], object] = lambda _time, _phi: None,
) -> Simulation:
    """Take chunks until the watch or the horizon ends the run; return what was prepared, completed.

    Parameters
    ----------
    prepared : Simulation
        Everything but outcome, trajectory and counts.
    chunks : iterable of Chunk
        Of consecutive steps, up to the horizon in time.
    seen : callable
        Called with time and nutation of the samples of each chunk, before the next is stepped.
    """
    scene = prepared.case.scene
    recorder, watch = Recorder(scene), Watch(scene)
    outcome: Outcome | None = None
    steps = rows = 0
    for chunk in chunks:
        samples = recorder.add(chunk)
        if samples is None:
            outcome, phi = None, np.zeros(0)
        else:
            phi = nutation(samples.quaternion)
            outcome = watch.over(samples, phi)
        if outcome is None and not chunk.sound:
            outcome = Outcome.DIVERGED
        taken = int(np.searchsorted(chunk.times, watch.ended_at, side="right"))
        spans = np.ones(taken, np.int64) if chunk.spans is None else chunk.spans[:taken].copy()
        if watch.ended_at < np.inf:
            spans[-1:] = 1  # where a run ended, the last reading stands for its own step
        steps += int(spans.sum())
        rows += int(chunk.constraint_rows[:taken] @ spans)
        if outcome is None and steps >= _MOST_STEPS:
            outcome = Outcome.TOO_SLOW
        if outcome is not None:
            break
        if samples is not None:
            seen(samples.time, phi)
    if outcome is None:
        outcome = Outcome.FINISHED if scene.horizon.seconds else Outcome.TIMED_OUT
    return replace(
        prepared,
        outcome=outcome,
        trajectory=recorder.trajectory(watch.ended_at),
        steps=steps,
        constraint_rows=rows,
    )


READINGS_PER_SAMPLE = 2.0
"""Readings from one sample to the next: samples lie at most half their spacing late."""

CHANGE = 0.1
"""Share of phi, or of sin(phi/2), that may change unseen: a fifth of the rate of the path."""

_OFTEN, _CHANGING = READINGS_PER_SAMPLE / ANGLE_STEP, 0.5 / CHANGE


class SamplingInterval:
    """Decides at each reading of a run how many steps to take until the next.

    Parameters
    ----------
    interval : float
        Time between two samples where no angle moves, s.
    """

    def __init__(self, interval: float) -> None:
        self._often = READINGS_PER_SAMPLE / interval
        self._fall = 1.0 / (SAMPLES_IN_TIME * interval)
        self._due = 0.0
        self.left = 0

    def spare(self, timestep: float) -> bool:
        """Whether a step of this length, s, is ever to be taken without a reading."""
        return self._often * timestep <= 1.0 / READINGS_PER_SAMPLE

    def steps(self, timestep: float) -> float:
        """Return the steps of this length, s, from one reading to the next where no angle moves."""
        return 1.0 / (self._often * timestep)

    def pause(
        self, quaternion: Sequence[float], angular_velocity: Sequence[float], timestep: float
    ) -> int:
        """Return the steps from a state to the next that is worth a reading, at least one.

        The share of a step that is left over counts towards the next pause, so that readings do not
        fall into step with an engine that does something every other step.

        Parameters
        ----------
        quaternion : sequence of 4 floats
            From body to world, scalar last.
        angular_velocity : sequence of 3 floats
            In world coordinates, rad/s.
        timestep : float
            s.
        """
        x, y, z, w = quaternion
        o_x, o_y, o_z = angular_velocity
        tilted, upright = x * x + y * y, w * w + z * z
        if tilted == 0.0 or upright == 0.0:
            return 1
        # half angles as the recorder's, cos(phi/2) exp(i (psi + theta)/2) = w + i z and
        # sin(phi/2) exp(i (psi - theta)/2) = x + i y, and twice their derivatives
        d_w, d_z = -o_x * x - o_y * y - o_z * z, o_z * w + o_x * y - o_y * x
        d_x, d_y = o_x * w + o_y * z - o_z * y, o_y * w + o_z * x - o_x * z
        rocked = abs(x * d_x + y * d_y) / math.sqrt(tilted * upright)
        path = rocked + abs(w * d_z - z * d_w) / upright + abs(x * d_y - y * d_x) / tilted
        rate = _OFTEN * path + self._often
        change = _CHANGING * (rocked + self._fall) * math.sqrt(upright / tilted)
        due = self._due + 1.0 / (max(rate, change) * timestep)
        if not due >= 1.0:  # NaN, where the state is not finite
            self._due = 0.0
            return 1
        steps = int(due)
        self._due = due - steps
        return steps
