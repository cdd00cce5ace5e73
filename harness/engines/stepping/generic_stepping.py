"""Stepping a world through its own readings, and stepping that leaves out readings.

Each step is read through `World`, which costs some tens of microseconds. An engine that steps many
times in one call writes its own `StageReader` and saves that; with `take_stage` it reads a slow
motion no oftener than the recorder needs.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from typing import Protocol

import numpy as np

from harness.core.trajectory import Floats, Integers
from harness.engines.stepping.recording import Chunk, SamplingInterval, trajectory_of
from harness.engines.stepping.schedule import Schedule, Stage
from harness.engines.world import Contact, World
from models.errors import InvalidValueError

_WIDTH = 21  # pose 7, twist 6, contact 8


class StageReader(Protocol):
    """Steps a world stage by stage, and holds the readings since the last chunk."""

    def state(self) -> tuple[Sequence[float], Sequence[float]]:
        """Return quaternion (scalar first) and angular velocity, which choose the next stage."""

    def take(self, stage: Stage) -> bool:
        """Take the steps of a stage; return False where the engine's numbers are known to break."""

    def chunk(self) -> Chunk | None:
        """Return the readings since the last chunk; None without any."""


def step_by_stages(reader: StageReader, schedule: Schedule, size: int) -> Iterator[Chunk]:
    """Step by a schedule from where a world is, yielding after `size` steps or more.

    While a schedule says that the run cannot be over yet, stage follows stage without a look.
    """
    # the schedule is asked after a chunk was seen: what is seen may change what comes
    sound = True
    while sound and (stage := schedule.next(*reader.state())) is not None:
        taken = 0
        while stage is not None:
            sound = reader.take(stage)
            taken += len(stage.times)
            state = reader.state()
            on = sound and (taken < size or schedule.falls(*state))
            stage = schedule.next(*state) if on else None
        if (chunk := reader.chunk()) is not None:
            yield chunk


def walk(world: World, schedule: Schedule, size: int, *, sparsely: bool = False) -> Iterator[Chunk]:
    """Step a world by a schedule from where it is, yielding after `size` steps or more.

    Parameters
    ----------
    world : World
    schedule : Schedule
    size : int
    sparsely : bool
        Whether to leave out the readings that the recorder does not need; else each step is read.
    """
    return step_by_stages(
        _WorldReader(world, schedule.sampling if sparsely else None), schedule, size
    )


def contact_of(points: Floats, forces: Floats, penetration: float) -> Contact:
    """Return the contact of several points, of which those count that the plane pushes.

    Parameters
    ----------
    points, forces : ndarray, shape (n, 3)
        m and N on the can.
    penetration : float
        Greatest depth, m; NaN where nothing touches.
    """
    bearing = forces[:, 2] > 0.0
    if not bearing.any():
        nowhere = np.full(3, np.nan)
        return Contact(point=nowhere, force=np.zeros(3), penetration=penetration, count=0)
    points, forces = points[bearing], forces[bearing]
    return Contact(
        point=forces[:, 2] @ points / forces[:, 2].sum(),
        force=forces.sum(axis=0),
        penetration=penetration,
        count=int(bearing.sum()),
    )


_NOWHERE = (math.nan,) * 4, (math.nan,) * 3
"""State of a world that holds no numbers."""


class _WorldReader:
    """Reads a world through the role `World`, up to the first state that holds no numbers."""

    def __init__(self, world: World, sampling: SamplingInterval | None) -> None:
        self._world, self._sampling = world, sampling
        self._times: list[float] = []
        self._spans: list[int] = []
        self._rows: list[Floats] = []
        self._sound = True

    def state(self) -> tuple[Sequence[float], Sequence[float]]:
        """Return the state of the world; NaN if it holds no numbers, as the next step finds."""
        try:
            pose, twist = self._world.pose(), self._world.twist()
        except InvalidValueError:
            return _NOWHERE
        return pose.quaternion.tolist(), twist.angular_velocity.tolist()

    def take(self, stage: Stage) -> bool:
        """Keep the state before each step and the contact that it solved, while it is a state."""
        self._world.set_timestep(stage.timestep)
        places, spans = take_stage(stage, self._sampling, self._read_and_step, self._skip)
        self._times += stage.times[places].tolist()
        self._spans += spans.tolist()
        return self._sound

    def _read_and_step(self, steps: int) -> tuple[Sequence[float], Sequence[float]]:
        """Read so many steps, one or more; return quaternion (scalar last) and spin of the last."""
        for _ in range(steps):
            state = self._read_one()
        return state

    def _read_one(self) -> tuple[Sequence[float], Sequence[float]]:
        """Keep the state, step, keep the contact; return quaternion (scalar last) and spin."""
        world = self._world
        try:
            pose, twist = world.pose(), world.twist()
        except InvalidValueError:
            self._sound = False
        if not self._sound:
            return _NOWHERE
        self._skip(1)
        contact = world.contact()
        self._rows.append(
            np.concatenate(
                (
                    *(pose.position, pose.quaternion, twist.velocity, twist.angular_velocity),
                    *(contact.point, contact.force, (contact.penetration, contact.count)),
                )
            )
        )
        w, x, y, z = pose.quaternion.tolist()
        return (x, y, z, w), twist.angular_velocity.tolist()

    def _skip(self, steps: int) -> None:
        """Take steps that nobody looks at; numbers that break are an outcome."""
        if self._sound:
            with np.errstate(over="ignore", invalid="ignore"):
                for _ in range(steps):
                    self._world.step()

    def chunk(self) -> Chunk | None:
        """Return the time of each reading, and those whose numbers are finite; None without any."""
        if not self._times:
            return None
        rows = np.array(self._rows).reshape(-1, _WIDTH)
        # of what came after the first state without numbers only that one is told
        times, spans = (np.array(each[: len(rows) + 1]) for each in (self._times, self._spans))
        self._times, self._spans, self._rows = [], [], []

        worked = np.zeros(len(times), dtype=np.int64)
        worked[: len(rows)] = 3 * rows[:, 20].astype(np.int64)  # a normal and two of friction
        return Chunk(
            times=times,
            quaternions=rows[:, 3:7],
            constraint_rows=worked,
            sound=len(rows) == len(times),
            velocities=rows[:, 7:10],
            readings=(rows[:, :13], rows[:, 13:16], rows[:, 16:19], rows[:, 19], rows[:, 20]),
            trajectory=trajectory_of,
            spans=spans,
        )


def take_stage(
    stage: Stage,
    sampling: SamplingInterval | None,
    read_and_step: Callable[[int], tuple[Sequence[float], Sequence[float]]],
    skip: Callable[[int], object],
) -> tuple[Integers, Integers]:
    """Take the steps of a stage, and read as many as the recorder needs.

    Parameters
    ----------
    stage : Stage
    sampling : SamplingInterval or None
        Of the run; None reads every step.
    read_and_step : callable
        Keeps the state, takes a step and keeps the contact that it solved, so many times, one or
        more. Returns the quaternion, scalar last, and the angular velocity of the last state kept.
    skip : callable
        Takes so many steps and keeps nothing.

    Returns
    -------
    places, spans : ndarray of int, shape (n,)
        Which of the steps were read, and for how many steps each stands, its own the first.
    """
    count, last, timestep = len(stage.times), stage.ahead - 1, stage.timestep
    place = 0 if sampling is None else sampling.left
    if place > 0:
        skip(min(place, count))
    if sampling is None or not sampling.spare(timestep):
        every = np.arange(min(place, count), count)
        if len(every) > 0:
            read_and_step(len(every))
        if sampling is not None:
            sampling.left = max(place - count, 0)
        return every, np.ones(len(every), dtype=np.int64)
    places: list[int] = []
    spans: list[int] = []
    while place < count:
        quaternion, spin = read_and_step(1)
        after = place + 1
        if place < last:
            # the last step of all is read, whatever the motion
            after = min(place + sampling.pause(quaternion, spin, timestep), last)
        places.append(place)
        spans.append(after - place)
        if after > place + 1 < count:
            skip(min(after, count) - place - 1)
        place = after
    sampling.left = place - count
    return np.array(places, dtype=np.int64), np.array(spans, dtype=np.int64)
