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
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.core.simulation import Outcome, Simulation
from harness.core.trajectory import Floats, Integers, Trajectory
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
    velocities : ndarray, shape (m, 3)
        Of the first m states, in world coordinates, m/s.
    readings : tuple of ndarray, shape (m or more, ...)
        What the engine tells of these states, in its own terms.
    trajectory : callable
        Takes times and the rows of each of the readings at these times, and returns them as a
        trajectory. It is called once at the end of a run, with what is recorded of all of its
        chunks: most steps of a run are never looked at again.
    spans : ndarray of int, shape (n,), or None
        Steps that each reading stands for, its own the first; None where every step was read.
    """

    times: Floats
    quaternions: Floats
    constraint_rows: Integers
    sound: bool
    velocities: Floats
    readings: tuple[NDArray[Any], ...]
    trajectory: Callable[..., Trajectory]
    spans: Integers | None = None

    def read(self, keep: Integers) -> Trajectory:
        """Return the states that `keep` selects as a trajectory."""
        return self.trajectory(self.times[keep], *(rows[keep] for rows in self.readings))

    def effort(self, until: float) -> tuple[int, int]:
        """Return the steps up to the end of a run, s, and the constraint rows that they solved.

        An end of infinity is none.
        """
        taken, ends = len(self.times), until < np.inf
        if ends:
            taken = int(np.searchsorted(self.times, until, side="right"))
        if self.spans is None:
            return taken, int(self.constraint_rows[:taken].sum())
        spans = self.spans[:taken].copy()
        if ends:
            spans[-1:] = 1  # where a run ended, the last reading stands for its own step
        return int(spans.sum()), int(self.constraint_rows[:taken] @ spans)


def trajectory_of(time: Floats, motion: Floats, *contact: NDArray[Any]) -> Trajectory:
    """Return states of a run as a trajectory.

    Parameters
    ----------
    time : ndarray, shape (n,)
        s.
    motion : ndarray, shape (n, 13)
        Position, quaternion (scalar first), velocity and angular velocity, in world coordinates.
    contact : four ndarrays
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
        self._parts: list[tuple[NDArray[Any], ...]] = []
        self._path = 0.0
        self._chunk: Chunk | None = None

    def add(self, chunk: Chunk) -> Integers:
        """Record a chunk that follows the one before; return the places of what is recorded."""
        if len(chunk.quaternions) == 0:
            return np.zeros(0, dtype=np.int64)
        places = self._places(chunk.times, chunk.quaternions)
        self._chunk = chunk
        if len(places) > 0:
            self._parts.append(_rows(chunk, places))
        return places

    def _places(self, time: Floats, quaternion: Floats) -> Integers:
        """Return the places of the states that the path calls for."""
        before, count = self._chunk, len(quaternion)
        # of the chunk before the last state comes first
        late = int(before is not None)
        q = np.empty((4, count + late))
        q[:, late:] = quaternion.T
        path = np.empty(count + late)
        grown = path[1:]
        np.subtract(time[1:count], time[: count - 1], out=path[1 + late :])
        if before is not None:
            last = len(before.quaternions) - 1
            q[:, 0] = before.quaternions[last]
            path[1] = time[0] - before.times[last]
        path[0] = self._path
        grown /= self._time_step
        angles = _path(q)
        angles /= ANGLE_STEP
        grown += angles
        # summed from the first step on, not chunk by chunk, so that round-off is that of one chunk
        path.cumsum(out=path)
        self._path = float(path[-1])
        np.floor(path, out=path)
        places: Integers = np.flatnonzero(grown > path[:-1])
        return places if late else np.concatenate(([0], places + 1))

    def trajectory(self, until: float) -> Trajectory | None:
        """Return what is recorded up to a time in s, and the last step in any case."""
        parts, chunk = self._parts, self._chunk
        if chunk is None:
            return None
        last = len(chunk.quaternions) - 1
        if parts[-1][0][-1] < chunk.times[last] <= until:
            parts = [*parts, _rows(chunk, np.array([last]))]
        one = len(parts) == 1  # what is joined is copied
        time, *readings = parts[0] if one else map(np.concatenate, zip(*parts, strict=True))
        count = int(np.searchsorted(time, until, side="right"))
        return chunk.trajectory(time[:count], *(rows[:count] for rows in readings))


def _rows(chunk: Chunk, places: Integers) -> tuple[NDArray[Any], ...]:
    """Return times and readings of some of the states of a chunk."""
    # of rows that lie together `take` needs a quarter of the time of an index
    return chunk.times[places], *(rows.take(places, axis=0) for rows in chunk.readings)


def _path(q: Floats) -> Floats:
    """Return how far (phi, psi + theta, psi - theta) move from sample to sample, shape (n-1,), rad.

    In half angles the quaternion is two complex numbers, cos(phi/2) exp(i (psi + theta)/2) and
    sin(phi/2) exp(i (psi - theta)/2), see `models.kinematics`. A turn of one of them is its cross
    product over its dot product from sample to sample: the tangent, which is the angle where
    samples are dense, and more than it where they are not. No arctangent of millions of steps is
    needed.

    Parameters
    ----------
    q : ndarray, shape (4, n)
        Quaternions, scalar first.
    """
    before, after = q[:, :-1], q[:, 1:]
    along, across = before * after, before * after[::-1]  # ww xx yy zz; wz xy yx zw
    part, total = np.empty((2, 3, before.shape[1]))
    np.subtract(across[:2], across[:1:-1], out=part[:2])
    np.add(along[:2], along[:1:-1], out=total[:2])
    tilt = q[1:3] * q[1:3]
    square = tilt[0] + tilt[1]
    np.subtract(square[1:], square[:-1], out=part[2])
    np.subtract(1.0, square[1:], out=total[2])
    total[2] *= square[1:]
    np.sqrt(total[2], out=total[2])
    np.abs(part, out=part)
    first, second, rocked = _over(part, total)
    path: Floats = first
    path += second
    path *= 2.0
    path += rocked
    return path


def _over(part: Floats, total: Floats) -> Floats:
    """Return a ratio; pi behind a right angle, or where the can is flat: always worth keeping.

    Writes over the numbers that it is given.
    """
    if total.size and total.min() > 0.0:  # a masked division takes three times as long
        part /= total
        return part
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
        places = recorder.add(chunk)
        outcome, time, phi = None, chunk.times[places], nutation(chunk.quaternions[places])
        if len(places) > 0:
            outcome = watch.over(time, chunk.velocities[places], phi)
        if outcome is None and not chunk.sound:
            outcome = Outcome.DIVERGED
        taken, worked = chunk.effort(watch.ended_at)
        steps, rows = steps + taken, rows + worked
        if outcome is None and steps >= _MOST_STEPS:
            outcome = Outcome.TOO_SLOW
        if outcome is not None:
            break
        if len(places) > 0:
            seen(time, phi)
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
