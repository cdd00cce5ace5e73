"""Signs of failure on motions made by hand: each is seen when it comes, and by how much."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from harness.core.simulation import Outcome
from harness.core.trajectory import Trajectory, take
from harness.studies.stability.failure_criteria import (
    StabilityStatus,
    classify,
    free_rotation,
)
from models import Horizon, Scene, angular_velocity, load, quaternion, to_body
from tests.support.changed_motions import Fields, changed, exact_trajectory, run_of

Change = Callable[[Fields, np.ndarray], None]


def scene_of(seconds: float = 0.3) -> Scene:
    return replace(load("gentle-rock"), horizon=Horizon(seconds=seconds))


def verdict(change: Change, scene: Scene | None = None) -> tuple[StabilityStatus, float, float]:
    scene = scene_of() if scene is None else scene
    found = classify(
        run_of(
            changed(exact_trajectory(scene), lambda fields: change(fields, fields["time"])), scene
        )
    )
    assert found.simulation.trajectory is None
    return found.verdict, found.symptom.time, found.symptom.number


def test_the_exact_motion_is_accurate() -> None:
    found, _, number = verdict(lambda _f, _t: None)
    assert found is StabilityStatus.ACCURATE
    assert number < 1e-9  # round-off of quaternions, there and back


def test_a_can_that_sinks_tunnels_from_the_moment_that_it_is_too_deep() -> None:
    def sink(fields: Fields, time: np.ndarray) -> None:
        fields["position"][:, 2] -= 0.02 * time  # a tenth of 37 mm after 0.185 s

    found, when, number = verdict(sink)
    assert found is StabilityStatus.TUNNELS
    assert when == pytest.approx(0.185, abs=2e-3)  # the next sample
    assert number == pytest.approx(0.02 * 0.3 / 0.037, rel=1e-6)


@pytest.mark.parametrize(
    ("sign", "name"), [(1.0, StabilityStatus.GAINS), (-1.0, StabilityStatus.DISSIPATES)]
)
def test_energy_that_comes_or_goes_is_weighed_by_what_there_is_to_spend(
    sign: float, name: StabilityStatus
) -> None:
    scene = scene_of()
    can = scene.can
    high = can.radius * math.sin(0.4) + can.half_height * math.cos(0.4) - can.half_height

    def lift(fields: Fields, time: np.ndarray) -> None:
        fields["position"][:, 2] += sign * 0.1 * high * time / 0.3

    found, when, number = verdict(lift)
    assert found is name
    # the spin of the release, some per mille of it, counts as well
    assert when == pytest.approx(0.15, rel=0.05)
    assert number == pytest.approx(0.1, rel=0.05)


def test_a_can_that_lies_down_for_good_sticks_flat() -> None:
    scene = scene_of(0.33)

    def lie(fields: Fields, time: np.ndarray) -> None:
        flat = time > 0.16
        fields["quaternion"][flat] = quaternion(1e-3, 0.0, 0.0)
        fields["velocity"][flat] = fields["angular_velocity"][flat] = 0.0
        fields["position"][flat, 2] = scene.can.half_height

    found, when, number = verdict(lie, scene)
    assert found is StabilityStatus.FLAT
    assert when == pytest.approx(0.16, abs=2e-3)
    assert number == pytest.approx(1e-3)


def test_steps_too_long_to_count_the_turns_are_unresolved() -> None:
    scene = replace(load("paper-release"), horizon=Horizon(seconds=0.07))
    whole = exact_trajectory(scene)
    # six samples a millisecond apart are left of the bounce, which lasts a microsecond
    sparse = np.unique(np.searchsorted(whole.time, np.arange(0.0, whole.time[-1], 1e-3)))
    found = classify(run_of(take(whole, sparse), scene))
    assert found.verdict is StabilityStatus.UNRESOLVED
    assert found.symptom.time == pytest.approx(0.031, abs=1e-3)


def test_another_motion_is_inaccurate_and_says_by_how_much() -> None:
    def slow(fields: Fields, _time: np.ndarray) -> None:
        fields["time"] *= 1.02

    found, _, number = verdict(slow)
    assert found is StabilityStatus.INACCURATE
    assert 0.01 < number < 0.1


def test_broken_numbers_diverge_even_where_nothing_was_recorded() -> None:
    scene = scene_of()
    for trajectory in (None, exact_trajectory(scene)):
        found = classify(run_of(trajectory, scene, Outcome.DIVERGED))
        assert found.verdict is StabilityStatus.DIVERGES
    assert not found.sound


@pytest.mark.parametrize("outcome", [Outcome.MISMATCH, Outcome.BROKEN])
def test_what_did_not_run_is_refused(outcome: Outcome) -> None:
    assert classify(run_of(None, scene_of(), outcome)).verdict is StabilityStatus.REFUSED


def test_without_an_exact_motion_a_run_in_which_nothing_fails_is_stable() -> None:
    scene = load("gentle-rock")
    sunk = replace(scene, release=replace(scene.release, height=-1e-9))
    found = classify(run_of(exact_trajectory(scene), sunk))
    assert found.verdict is StabilityStatus.STABLE
    assert (found.good, found.accurate) == (True, False)


def test_a_free_can_turns_as_eulers_equations_say() -> None:
    # the closed form against its definition, by differences: the body's rate is L/A + ..., and
    # the angular momentum stays
    scene = load("free-tumbling")
    time = np.linspace(0.0, 0.02, 2001)
    start = scene.release
    ones = np.ones((len(time), 1))
    omega = angular_velocity(start.phi, start.psi, 0.0, start.psi_dot, start.theta_dot)
    q0 = quaternion(start.phi, start.psi, start.theta)
    record = Trajectory(
        time=time,
        position=0.0 * ones * np.ones(3),
        quaternion=ones * q0,
        velocity=0.0 * ones * np.ones(3),
        angular_velocity=ones * omega,
        contact_point=np.nan * ones * np.ones(3),
        contact_force=0.0 * ones * np.ones(3),
        penetration=np.full(len(time), np.nan),
        contact_count=np.zeros(len(time), dtype=np.int64),
    )
    q = free_rotation(record, scene)
    step = time[1] - time[0]
    rate = (q[2:] - q[:-2]) / (2.0 * step)
    middle = q[1:-1]
    # angular velocity 2 q' q*, in the world
    w, v = middle[:, :1], middle[:, 1:]
    dw, dv = rate[:, :1], rate[:, 1:]
    world = 2.0 * (-dw * v + w * dv - np.cross(dv, v))
    moments = np.array((scene.can.transverse_inertia,) * 2 + (scene.can.axial_inertia,))
    body = to_body(middle, world)
    inverse = middle * np.array((1.0, -1.0, -1.0, -1.0))
    momentum = to_body(inverse, moments * body)
    # the first difference is of the second sample, by when the rate has turned by 40 rad/s 1e-5 s
    assert np.linalg.norm(world[0] - omega) < 1e-3 * np.linalg.norm(omega)
    # a central difference over 1e-5 s at 40 rad/s is off by (40e-5)^2/6, relative
    assert np.abs(momentum - momentum[0]).max() < 1e-6 * np.linalg.norm(momentum[0])
