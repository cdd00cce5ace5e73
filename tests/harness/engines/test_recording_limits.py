"""Numbers that docstrings cite of recording, settling and flights, just inside and outside each.

They are written out here as the docstrings have them, and not imported: whoever changes one in the
code is told which sentence no longer holds.
"""

# ruff: noqa: D102 - the methods of a toy are described where its role is

import math
from collections.abc import Callable
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from harness.core.case import Case
from harness.core.simulation import Outcome, Simulation
from harness.core.trajectory import Trajectory
from harness.engines.contract import contract_violation
from harness.engines.probes.flight import flight, turn
from harness.engines.stepping.recording import Chunk, SamplingInterval, record
from harness.engines.stepping.settling import hovering_distance, settle
from models import Can, Pose, Scene, Twist, contact_point, load, quaternion, release_state
from tests.support.trajectories import make_trajectory

GENTLE = load("gentle-rock")
INTERVAL = 3e-4


def prepared(trajectory: Trajectory | None = None) -> Simulation:
    return Simulation(
        case=Case(scene=GENTLE, engine="mujoco"),
        outcome=Outcome.FINISHED,
        trajectory=trajectory,
        engine_version="1",
        model="toy",
    )


# --- recording ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("steps", "outcome"), [(99_999_999, Outcome.TIMED_OUT), (100_000_000, Outcome.TOO_SLOW)]
)
def test_a_run_of_a_hundred_million_steps_does_not_end(steps: int, outcome: Outcome) -> None:
    one = make_trajectory(1, quaternion=quaternion(np.array([0.3]), np.zeros(1), np.zeros(1)))
    chunk = Chunk(
        times=one.time,
        quaternions=one.quaternion,
        constraint_rows=np.ones(1, dtype=np.int64),
        sound=True,
        velocities=one.velocity,
        readings=(),
        trajectory=lambda _: one,
        spans=np.array([steps]),
    )
    found = record(prepared(), [chunk])
    assert (found.outcome, found.steps) == (outcome, steps)


@pytest.mark.parametrize(("share", "spares"), [(0.2499, True), (0.2501, False)])
def test_from_half_a_reading_in_a_step_on_every_step_is_read(share: float, *, spares: bool) -> None:
    assert SamplingInterval(INTERVAL).spare(share * INTERVAL) is spares


def test_two_readings_lie_between_two_samples() -> None:
    sampling = SamplingInterval(INTERVAL)
    assert sampling.steps(1e-9) == pytest.approx(INTERVAL / 2.0 / 1e-9)
    w, x, y, z = quaternion(0.4, 0.0, 0.0).tolist()
    assert sampling.pause((x, y, z, w), (0.0, 0.0, 0.0), 1e-9) == int(INTERVAL / 2.0 / 1e-9)
    # the path counts a turn about the vertical twice, and calls for a sample every 0.02 rad
    fast = SamplingInterval(1e6)
    quarter = fast.pause((x, y, z, w), (0.0, 0.0, 1.0), 1e-6)
    assert quarter == pytest.approx(0.02 / 2.0 / 2.0 / 1e-6, abs=1.0)


@pytest.mark.parametrize("phi", [1e-4, 1e-2])
def test_phi_changes_by_a_tenth_at_most_unseen(phi: float) -> None:
    # of phi' = 1 alone: the interval in time is a week
    tilted = (math.sin(phi / 2.0), 0.0, 0.0, math.cos(phi / 2.0))
    pause = SamplingInterval(1e6).pause(tilted, (1.0, 0.0, 0.0), 1e-9)
    assert pause * 1e-9 == pytest.approx(0.1 * phi, rel=1e-3)
    # a contact that is lost changes phi' by 1 in a natural time, which is 200 intervals
    still = SamplingInterval(1e-2).pause(tilted, (0.0, 0.0, 0.0), 1e-9)
    assert still * 1e-9 == pytest.approx(min(0.1 * phi * 2.0, 0.5e-2), rel=1e-3)


# --- settling -------------------------------------------------------------------------------------


class Plane:
    """A world of one step that gives the touching point a velocity by its depth below zero."""

    def __init__(self, can: Can, rise: Callable[[float], float]) -> None:
        self.can, self.rise, self.timestep = can, rise, 1e-4
        self.depths: list[float] = []

    def place(self, pose: Pose, twist: Twist) -> None:
        self._pose, self._twist = pose, twist

    def signed_distance(self) -> float:
        return float(contact_point(self.can, self._pose.position, self._pose.quaternion)[2])

    def step(self) -> None:
        self.depths.append(-self.signed_distance())
        upward = np.array((0.0, 0.0, self.rise(self.depths[-1])))
        self._twist = Twist(velocity=upward, angular_velocity=np.zeros(3))

    def twist(self) -> Twist:
        return self._twist


@pytest.mark.parametrize("phi", [0.0, 0.3, 1.2])
def test_a_can_hovers_at_a_thousandth_of_its_radius(phi: float) -> None:
    world = Plane(GENTLE.can, float)
    found = hovering_distance(world, GENTLE.can, phi, 0.7)  # type: ignore[arg-type]
    assert found == pytest.approx(1e-3 * GENTLE.can.radius, rel=1e-9, abs=0)


def test_the_first_depth_that_is_tried_is_a_tenth_of_a_picometre(gentle: Scene) -> None:
    pose, twist = release_state(gentle.can, gentle.release)
    world = Plane(gentle.can, lambda depth: -1.0 if depth < 1e-9 else 1.0)
    settle(world, gentle, pose, twist)  # type: ignore[arg-type]
    # where the can just touches, then ever four times as deep; the distance has ulps of the radius
    assert world.depths[:4] == pytest.approx([0.0, 1e-13, 4e-13, 1.6e-12], abs=3e-17)


# --- free flights ---------------------------------------------------------------------------------


class Aloft:
    """A world in which nothing changes but how often it was stepped."""

    def __init__(self, timestep: float, greatest: float = math.inf) -> None:
        self.timestep, self.steps, self.greatest = timestep, 0, greatest
        self.inertia = np.array((2.0, 2.0, 1.0))

    def place(self, pose: Pose, twist: Twist) -> None:
        self._pose, self._twist = pose, twist

    def step(self) -> None:
        self.steps += 1

    def pose(self) -> Pose:
        return self._pose

    def twist(self) -> Twist:
        return self._twist


@pytest.mark.parametrize(("duration", "steps"), [(0.0999, 99_900), (0.1, 100_000), (7.0, 100_000)])
def test_a_flight_takes_a_hundred_thousand_steps_at_most(duration: float, steps: int) -> None:
    world = Aloft(1e-6)
    rows = flight(world, np.array((0.0, 0.0, 1.0)), duration)  # type: ignore[arg-type]
    assert world.steps == steps
    assert rows[-1, 0] == pytest.approx(steps * 1e-6, rel=0.01)


class Turning(Aloft):
    """A world that turns the can by a little more than it should."""

    def __init__(self, timestep: float, over: float) -> None:
        super().__init__(timestep)
        self.over = over

    def step(self) -> None:
        turn = self._twist.angular_velocity * (self.timestep * (1.0 + self.over))
        before = Rotation.from_quat(self._pose.quaternion, scalar_first=True)
        after = (Rotation.from_rotvec(turn) * before).as_quat(scalar_first=True)
        self._pose = Pose(position=self._pose.position, quaternion=after)


@pytest.mark.parametrize(("over", "greatest"), [(0.99e-9, 3.0), (1.01e-9, 0.0)])
def test_a_turn_is_exact_to_a_billionth(over: float, greatest: float) -> None:
    engine = SimpleNamespace(
        settings=(), version="1", timestep=lambda _: 1e-3, open=lambda _: Turning(1e-3, over)
    )
    readings = turn(engine, Case(scene=GENTLE, engine="mujoco"))
    found = {quantity: value for quantity, _, value, *_ in readings}
    assert found["largest turn in a step that is exact"] == pytest.approx(greatest)


# --- what an adapter answers ----------------------------------------------------------------------


@pytest.mark.parametrize(("off", "sound"), [(0.99e-6, True), (1.01e-6, False)])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_quaternion_is_normalised_in_single_precision_at_least(
    off: float, sign: float, *, sound: bool
) -> None:
    long = make_trajectory(2, quaternion=np.outer(np.ones(2), (1.0 + sign * off, 0.0, 0.0, 0.0)))
    answer = prepared(long)
    assert (contract_violation(answer, answer.case) == "") is sound


@pytest.mark.parametrize(("steps", "sound"), [(2**63 - 1, True), (2**63, False)])
def test_a_count_has_64_bits(steps: int, *, sound: bool) -> None:
    answer = Simulation(
        case=Case(scene=GENTLE, engine="mujoco"),
        outcome=Outcome.TIMED_OUT,
        trajectory=None,
        engine_version="1",
        model="toy",
        steps=steps,
    )
    assert (contract_violation(answer, answer.case) == "") is sound
