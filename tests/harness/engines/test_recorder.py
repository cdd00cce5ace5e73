"""The recorder: dense by angle, sparse in time, and blind to how a run is cut."""

from dataclasses import fields, replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from harness.core.trajectory import Trajectory, take
from harness.engines.stepping.horizon import natural_time
from harness.engines.stepping.recording import Chunk, Recorder
from models import Scene, load, quaternion
from tests.support.trajectories import make_trajectory

GENTLE = load("gentle-rock")
# as the docstrings have them, and not imported: whoever changes one is told
TIME_STEP = natural_time(GENTLE) / 200.0
ANGLE_STEP = 0.02


def turned(time: np.ndarray, phi: np.ndarray, psi: np.ndarray, theta: np.ndarray) -> Trajectory:
    """Return a trajectory with these angles."""
    return make_trajectory(len(time), time=time, quaternion=quaternion(phi, psi, theta))


def chunk(part: Trajectory) -> Chunk:
    """Return a trajectory as an engine hands it over."""
    names = [field.name for field in fields(Trajectory) if field.name != "time"]
    return Chunk(
        times=part.time,
        quaternions=part.quaternion,
        constraint_rows=np.ones(len(part), dtype=np.int64),
        sound=True,
        velocities=part.velocity,
        readings=tuple(getattr(part, name) for name in names),
        trajectory=lambda time, *rows: Trajectory(time=time, **dict(zip(names, rows, strict=True))),
    )


def recorded(whole: Trajectory, cuts: list[int], scene: Scene = GENTLE) -> Trajectory:
    """Return what is recorded of a trajectory that is handed over in parts."""
    recorder = Recorder(scene)
    edges = [0, *sorted(cuts), len(whole)]
    for left, right in pairwise(edges):
        if right > left:
            recorder.add(chunk(take(whole, np.arange(left, right))))
    kept = recorder.trajectory(np.inf)
    assert kept is not None
    return kept


@pytest.fixture(scope="module")
def wild() -> Trajectory:
    """Return a motion that rests, races and rests again, in steps that divide nothing evenly."""
    time = np.arange(3000) * 1.7e-5
    psi = 2.0 * np.arctan((time - time[1500]) / 1e-4)
    return turned(time, np.full(3000, 0.01), psi, -0.9 * psi + time)


def test_not_a_bit_depends_on_the_cuts(wild: Trajectory) -> None:
    whole = recorded(wild, [])
    assert 100 < len(whole) < 1000

    @given(st.lists(st.integers(1, 2999), max_size=200))
    def every_cut(cuts: list[int]) -> None:
        parts = recorded(wild, cuts)
        for field in fields(Trajectory):
            np.testing.assert_array_equal(getattr(parts, field.name), getattr(whole, field.name))

    every_cut()
    singly = recorded(wild, list(range(1, 3000)))
    np.testing.assert_array_equal(singly.time, whole.time)


def test_round_off_at_the_threshold_does_not_depend_on_the_cuts() -> None:
    # steps of a tenth of the sampling interval: the tenth sum of 0.1 is 1, or an ulp less
    time = np.arange(1001) * (TIME_STEP / 10.0)
    still = turned(time, np.full(1001, 0.4), np.zeros(1001), np.zeros(1001))
    times = [recorded(still, list(range(n, 1001, n))).time for n in (1, 3, 7, 10, 1001)]
    for other in times[1:]:
        np.testing.assert_array_equal(other, times[0])


def test_where_nothing_turns_samples_keep_to_their_interval_in_time() -> None:
    time = np.arange(5000) * (TIME_STEP / 7.3)
    still = turned(time, np.full(5000, 0.4), np.zeros(5000), np.zeros(5000))
    gaps = np.diff(recorded(still, []).time)[:-1]  # the last sample is kept whatever its distance
    # a sample is kept at the first step at or past the interval
    assert gaps.min() > TIME_STEP * (1.0 - 1.0 / 7.3)
    assert gaps.max() < TIME_STEP * (1.0 + 1.0 / 7.3)


@pytest.mark.parametrize("angle", ["phi", "psi", "theta"])
def test_where_the_can_turns_samples_keep_to_their_angle(angle: str) -> None:
    n = 20_000
    time = np.arange(n) * 1e-9  # 20 microseconds: time alone would call for no sample
    sweep = np.linspace(0.0, 1.5, n)
    angles = {"phi": np.full(n, 0.4), "psi": np.zeros(n), "theta": np.zeros(n)}
    angles[angle] = 0.01 + sweep if angle == "phi" else 4.0 * sweep  # past a branch of the others
    kept = recorded(turned(time, **angles), [])
    path = np.interp(kept.time, time, angles[angle])
    # psi moves the sum and the difference of psi and theta alike, and so does theta: the path
    # counts each of them, which is twice the angle
    share = 1.0 if angle == "phi" else 0.5
    step = np.diff(path)[:-1]
    one_step = np.diff(angles[angle]).max()
    assert step.max() <= share * ANGLE_STEP + one_step
    assert step.min() >= 0.9 * share * ANGLE_STEP  # the interval in time takes less than a tenth


def test_a_turn_within_one_step_is_kept_on_both_sides() -> None:
    time = np.arange(100) * 1e-8
    psi = np.where(np.arange(100) < 50, 0.0, 3.0)
    kept = recorded(turned(time, np.full(100, 1e-4), psi, -psi), [])
    assert {0.0, time[50], time[99]} <= set(kept.time.tolist())


def test_first_and_last_are_kept_and_nothing_after_the_end(wild: Trajectory) -> None:
    recorder = Recorder(GENTLE)
    recorder.add(chunk(wild))
    whole = recorder.trajectory(np.inf)
    assert whole is not None
    assert whole.time[0] == wild.time[0]
    assert whole.time[-1] == wild.time[-1]
    part = recorder.trajectory(float(whole.time[40]))
    assert part is not None
    np.testing.assert_array_equal(part.time, whole.time[:41])


def test_of_nothing_nothing_is_recorded(wild: Trajectory) -> None:
    recorder = Recorder(GENTLE)
    assert recorder.trajectory(np.inf) is None
    nothing = chunk(wild)
    broken = replace(nothing, quaternions=nothing.quaternions[:0], sound=False)
    assert len(recorder.add(broken)) == 0
    assert recorder.trajectory(np.inf) is None
