"""Trajectories: what is no trajectory is refused, what is one cannot be changed."""

import pickle
from dataclasses import FrozenInstanceError, fields

import numpy as np
import pytest

from harness.core.errors import HarnessError, TrajectoryError
from harness.core.trajectory import ArrayShapeError, TimeOrderError, Trajectory, join, take
from tests.support.trajectories import make_trajectory

NAMES = [field.name for field in fields(Trajectory)]


@pytest.mark.parametrize("name", [name for name in NAMES if name != "time"])
def test_an_array_of_another_length_is_refused_by_name(name: str) -> None:
    good = getattr(make_trajectory(4), name)
    with pytest.raises(ArrayShapeError) as caught:
        make_trajectory(4, **{name: good[:3]})
    assert (caught.value.name, caught.value.shape) == (name, good[:3].shape)
    assert caught.value.expected == good.shape


@pytest.mark.parametrize("name", [name for name in NAMES if name != "time"])
def test_an_array_of_another_width_is_refused_by_name(name: str) -> None:
    good = getattr(make_trajectory(4), name)
    wider = np.stack((good, good), axis=-1)
    with pytest.raises(ArrayShapeError) as caught:
        make_trajectory(4, **{name: wider})
    assert (caught.value.name, caught.value.shape) == (name, wider.shape)


@pytest.mark.parametrize(
    "time", [(0.0, 1.0, 1.0), (0.0, 2.0, 1.0), (0.0, np.nan, 1.0)], ids=["equal", "back", "nan"]
)
def test_time_must_increase(time: tuple[float, ...]) -> None:
    with pytest.raises(TimeOrderError):
        make_trajectory(3, time=np.array(time))


def test_there_must_be_an_instant() -> None:
    with pytest.raises(TimeOrderError):
        make_trajectory(0)


def test_a_refusal_is_a_value_error_and_one_of_the_harness() -> None:
    assert issubclass(TrajectoryError, ValueError)
    assert issubclass(TrajectoryError, HarnessError)


@pytest.mark.parametrize("name", NAMES)
def test_arrays_are_copies_that_cannot_be_written(name: str) -> None:
    given = getattr(make_trajectory(3), name).copy()
    trajectory = make_trajectory(3, **{name: given})
    kept = getattr(trajectory, name)
    with pytest.raises(ValueError, match="read-only"):
        kept[0] = 7.0
    before = kept.copy()
    given += 1
    np.testing.assert_array_equal(kept, before)
    with pytest.raises(FrozenInstanceError):
        setattr(trajectory, name, given)


def test_pickling_keeps_every_bit_and_the_locks() -> None:
    trajectory = make_trajectory(3, position=np.random.default_rng(1).normal(size=(3, 3)))
    back = pickle.loads(pickle.dumps(trajectory))  # noqa: S301 - our own bytes
    for name in NAMES:
        np.testing.assert_array_equal(getattr(back, name), getattr(trajectory, name))
        assert not getattr(back, name).flags.writeable
        assert getattr(back, name).dtype == getattr(trajectory, name).dtype


def test_taken_apart_and_joined_it_is_the_same() -> None:
    whole = make_trajectory(5, penetration=np.array((0.0, 1.0, np.nan, 3.0, 4.0)))
    first, second = take(whole, np.arange(5) < 2), take(whole, np.arange(2, 5))
    assert len(first) == 2
    assert len(second) == 3
    again = join([first, second])
    for name in NAMES:
        np.testing.assert_array_equal(getattr(again, name), getattr(whole, name))


def test_parts_that_overlap_cannot_be_joined() -> None:
    with pytest.raises(TimeOrderError):
        join([make_trajectory(2), make_trajectory(2)])
