"""Walking a world through its readings gives what an engine's own stepping gives."""

from dataclasses import fields, replace

import numpy as np
import pytest

from harness.core.case import Case
from harness.core.trajectory import Trajectory, join
from harness.engines.registry import engine
from harness.engines.stepping.generic_stepping import walk
from harness.engines.stepping.recording import Chunk, SamplingInterval
from harness.engines.stepping.schedule import Adaptive, Fixed
from harness.engines.stepping.settling import settle
from harness.engines.world import Contact
from models import Horizon, Pose, Scene, Twist, release_state
from tests.support.engines import STEPPING, stepping_engine


def whole(chunks: list[Chunk]) -> Trajectory:
    """Return every step of some chunks."""
    return join([chunk.read(np.arange(len(chunk.quaternions))) for chunk in chunks])


@pytest.mark.parametrize("name", STEPPING)
@pytest.mark.parametrize("size", [4, 100])
def test_walking_is_stepping(brief: Scene, name: str, size: int) -> None:
    case = Case(scene=brief, engine=name, timestep=1e-3)
    own = engine(name).simulate(case)  # at 1 ms every step is recorded
    pose, twist = release_state(brief.can, brief.release)
    _, pose = settle(stepping_engine(name).open(case), brief, pose, twist)
    world = stepping_engine(name).open(case)
    world.place(pose, twist)
    chunks = list(walk(world, Fixed(1e-3, 0.02, 7), size))
    found = whole(chunks)
    assert own.trajectory is not None
    for field in fields(Trajectory):
        np.testing.assert_array_equal(
            getattr(found, field.name), getattr(own.trajectory, field.name), err_msg=field.name
        )
    assert all(chunk.sound for chunk in chunks)
    assert len(chunks) == (3 if size == 4 else 1)  # 21 steps in stages of 7, taken whole


@pytest.mark.slow
def test_walking_follows_a_schedule_that_changes_its_steps(brief: Scene) -> None:
    case = Case(scene=replace(brief, horizon=Horizon(seconds=0.16)), engine="mujoco")
    world = stepping_engine("mujoco").open(case)
    world.place(*release_state(brief.can, brief.release))
    limits = {"largest": 1e-3, "smallest": 1e-6, "limit": 0.16, "eta": 1e-3, "unit": 0.06}
    found = whole(list(walk(world, Adaptive(brief.can, **limits), 64)))
    steps = np.diff(found.time)
    assert len(np.unique(steps)) > 1
    assert found.time[-1] <= 0.16 < found.time[-1] + steps[-1] * (1.0 + 1e-9)


class Breaking:
    """A world whose numbers break in a step."""

    mass, inertia, timestep = 1.0, np.ones(3), 1.0

    def __init__(self, after: int) -> None:
        self.left = after

    def set_timestep(self, timestep: float) -> None:
        """Step as long as ever."""

    def place(self, pose: Pose, twist: Twist) -> None:
        """Stay."""

    def step(self) -> None:
        """Come nearer to the end."""
        self.left -= 1

    def pose(self) -> Pose:
        """Return a pose, or refuse what is none."""
        position = np.zeros(3) if self.left > 0 else np.full(3, np.nan)
        return Pose(position=position, quaternion=np.array((1.0, 0.0, 0.0, 0.0)))

    def twist(self) -> Twist:
        """Return rest."""
        return Twist(velocity=np.zeros(3), angular_velocity=np.zeros(3))

    def contact(self) -> Contact:
        """Return none."""
        return Contact(point=np.full(3, np.nan), force=np.zeros(3), penetration=np.nan, count=0)

    def signed_distance(self) -> float:
        """Return a gap."""
        return 1.0


@pytest.mark.parametrize("after", [0, 1, 5, 8, 13])
def test_walking_stops_where_numbers_break(after: int) -> None:
    chunks = list(walk(Breaking(after), Fixed(1.0, 100.0, 4), 8))
    assert [chunk.sound for chunk in chunks] == [True] * (len(chunks) - 1) + [False]
    assert sum(len(chunk.quaternions) for chunk in chunks) == after
    for chunk in chunks:
        assert len(chunk.constraint_rows) == len(chunk.times) >= len(chunk.quaternions)


def test_walking_sparsely_takes_the_same_steps_and_reads_what_the_recorder_needs(
    brief: Scene,
) -> None:
    case = Case(scene=brief, engine="mujoco", timestep=1e-5)
    sampling_interval, found = 3e-4, {}
    for sparsely in (False, True):
        world = stepping_engine("mujoco").open(case)
        world.place(*release_state(brief.can, brief.release))
        schedule = Fixed(1e-5, 0.02, 500)
        schedule.sampling = SamplingInterval(sampling_interval)
        chunks = list(walk(world, schedule, 500, sparsely=sparsely))
        assert all(chunk.sound for chunk in chunks)
        spans = [np.ones(len(c.times), np.int64) if c.spans is None else c.spans for c in chunks]
        assert sum(int(each.sum()) for each in spans) == 2001
        found[sparsely] = whole(chunks)
    every, few = found[False], found[True]
    assert len(every) == 2001
    assert len(few) < len(every) / 5
    at = np.searchsorted(every.time, few.time)
    for field in fields(Trajectory):
        np.testing.assert_array_equal(
            getattr(few, field.name), getattr(every, field.name)[at], err_msg=field.name
        )


@pytest.mark.parametrize("after", [0, 1, 5, 13])
def test_walking_sparsely_stops_where_numbers_break(after: int) -> None:
    schedule = Fixed(1.0, 100.0, 4)
    schedule.sampling = SamplingInterval(16.0)
    *sound, last = walk(Breaking(after), schedule, 8, sparsely=True)
    assert all(chunk.sound for chunk in sound)
    assert not last.sound
    assert len(last.times) == len(last.constraint_rows) == len(last.quaternions) + 1
