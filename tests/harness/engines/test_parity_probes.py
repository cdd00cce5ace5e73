"""The probes of parity on a toy world: each fault shows in its own rows and in no other."""

# ruff: noqa: D102 - the methods of a toy are described where its role is

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from harness.engines.description import Precision
from harness.engines.parity.checks import parity
from harness.engines.stepping.settling import AT_REST, above_origin
from harness.engines.world import Contact
from models import NO_SLIP_FRICTION, Damping, Effects, Pose, Scene, Twist, angles, to_body
from models.kinematics import to_world

DT = 1e-3
SPIN = {"misfit of the gyroscopic acceleration"}
FRICTION = {"friction of the pair", "friction between the axes"}


class Toy:
    """A faultless world of one step, but for the faults that it is given."""

    def __init__(self, scene: Scene, **faults: float) -> None:
        self.scene, self.faults = scene, faults
        self.timestep = DT
        self._force = np.zeros(3)

    def fault(self, name: str, ideal: float) -> float:
        return self.faults.get(name, ideal)

    @property
    def mass(self) -> float:
        return self.fault("mass", self.scene.can.mass)

    @property
    def inertia(self) -> np.ndarray:
        A, C = self.scene.can.transverse_inertia, self.scene.can.axial_inertia
        first = self.fault("A", A)
        return np.array((first, self.fault("A2", first), self.fault("C", C)))

    def place(self, pose: Pose, twist: Twist) -> None:
        self._pose, self._twist = pose, twist

    def signed_distance(self) -> float:
        phi, _, theta = angles(self._pose.quaternion)
        radius = self.fault("radius", self.scene.can.radius)
        margin = self.fault("margin", 0.0)
        half_height = self.fault("half_height", self.scene.can.half_height)
        if "sides" in self.faults:
            corner = math.pi / self.faults["sides"]
            radius *= math.cos((float(theta) + corner) % (2.0 * corner) - corner)
        reach = (radius - margin) * math.sin(phi) + (half_height - margin) * math.cos(phi) + margin
        return float(self._pose.position[2] - reach)

    def step(self) -> None:
        dt = self.fault("timestep", DT)
        velocity = np.array(self._twist.velocity)
        spin = np.array(self._twist.angular_velocity)
        self._force = np.zeros(3)
        if -self.signed_distance() > self.fault("slop", 0.0):
            normal, mu = 1.0, self.fault("mu", NO_SLIP_FRICTION)
            self._force = normal * np.array((0.0, -mu, 1.0))
        velocity[2] -= self.fault("gravity", self.scene.gravity) * DT
        velocity *= math.exp(-self.fault("linear", 0.0) * DT)
        spin += self.timestep * self.fault("gyroscopic", 1.0) * self._acceleration(spin)
        spin *= math.exp(-self.fault("angular", 0.0) * DT)
        clamp = self.fault("clamp", math.inf)
        self._twist = Twist(
            velocity=np.clip(velocity, -clamp, clamp), angular_velocity=np.clip(spin, -clamp, clamp)
        )
        position = self._pose.position + dt * self._twist.velocity
        self._pose = Pose(position=position, quaternion=self._pose.quaternion)

    def _acceleration(self, spin: np.ndarray) -> np.ndarray:
        """Return what the can's spin gains without a torque, rad/s^2, in world coordinates."""
        inertia, orientation = np.diag(self.inertia), self._pose.quaternion
        own = spin if "body" in self.faults else to_body(orientation, spin)
        gained = -np.linalg.solve(inertia, np.cross(own, inertia @ own))
        return gained if "body" in self.faults else to_world(orientation, gained)

    def pose(self) -> Pose:
        return self._pose

    def twist(self) -> Twist:
        return self._twist

    def set_timestep(self, timestep: float) -> None:
        self.timestep = timestep

    def contact(self) -> Contact:
        return Contact(point=np.zeros(3), force=self._force, penetration=0.0, count=1)


def faulty(
    scene: Scene, imposed: Mapping[str, float] | None = None, **faults: float
) -> dict[str, Any]:
    """Return the verdict of each quantity that is not equal."""
    rows = parity(Toy(scene, **faults), scene, DT, imposed or {})
    return {row.quantity: row.verdict for row in rows if row.verdict != "equal"}


def test_a_faultless_world_is_equal_in_everything(gentle: Scene) -> None:
    assert faulty(gentle) == {}


FAULTS: list[tuple[dict[str, Any], set[str]]] = [
    ({"mass": 0.043 * (1 + 1e-9)}, {"mass"}),
    ({"gyroscopic": 0.0}, SPIN),
    ({"gyroscopic": 0.99}, SPIN),
    ({"body": 1.0}, SPIN),
    ({"timestep": DT * (1 + 1e-6)}, {"timestep"}),
    ({"gravity": 9.81 * (1 + 1e-6)}, {"gravity"}),
    ({"gravity": -9.81}, {"gravity"}),
    ({"linear": 0.04}, {"linear damping", "speed kept", "gravity"}),
    ({"angular": 0.04}, {"angular damping", "spin kept"}),
    ({"clamp": 100.0}, {"speed kept", "spin kept"}),
    ({"radius": 0.037 * (1 + 1e-6)}, {"radius R", "rim deviation"}),
    ({"half_height": 0.055}, {"half height H", "rim deviation"}),
    ({"margin": 1e-6}, {"radius R", "half height H", "rim deviation"}),
    ({"sides": 32.0}, {"radius R", "rim deviation"}),
    ({"mu": NO_SLIP_FRICTION * (1 + 1e-5)}, FRICTION),
    ({"mu": 0.0}, FRICTION),
]


@pytest.mark.parametrize(
    ("faults", "quantities"), FAULTS, ids=lambda value: " ".join(sorted(value))[:40]
)
def test_a_fault_shows_where_it_is(
    gentle: Scene, faults: dict[str, Any], quantities: set[str]
) -> None:
    assert faulty(gentle, **faults) == dict.fromkeys(quantities, "mismatch")


@pytest.mark.parametrize(("gravity", "verdict"), [(9.81, None), (9.81 * 0.999, "mismatch")])
def test_damping_excuses_no_gravity_but_for_what_it_takes_in_a_step(
    gentle: Scene, gravity: float, verdict: str | None
) -> None:
    damped = replace(gentle, effects=Effects(damping=Damping(linear=0.04)))
    assert faulty(damped, linear=0.04, gravity=gravity).get("gravity") == verdict


def test_moments_are_told_apart(gentle: Scene) -> None:
    A, C = gentle.can.transverse_inertia, gentle.can.axial_inertia
    assert set(faulty(gentle, A=A * (1 + 1e-9))) == {"transverse inertia A"}
    assert set(faulty(gentle, C=C * (1 + 1e-9))) == {"axial inertia C"}
    lopsided = faulty(gentle, A=A * (1 + 1e-9), A2=A * (1 - 1e-9))
    assert set(lopsided) == {"inertia asymmetry"}


def test_what_is_known_to_differ_is_imposed_and_nothing_else(gentle: Scene) -> None:
    found = faulty(gentle, {"mass": math.inf}, mass=1.0, gravity=9.0)
    assert found == {"mass": "imposed", "gravity": "mismatch"}


@pytest.mark.parametrize(
    ("faults", "quantity", "share"),
    [
        ({"mass": 0.043 * 1.01}, "mass", 0.01),
        ({"mu": 1.4 * NO_SLIP_FRICTION}, "friction of the pair", 0.4),
        # what is declared as zero: over the size of the can, its moment, or one unit
        ({"margin": 1e-4}, "rim deviation", 1e-4 * (math.sin(0.9) + math.cos(0.9) - 1.0) / 0.06587),
        ({"A": 1e-5, "A2": 2e-5}, "inertia asymmetry", 1e-5 / 4.2796e-5),
        ({"angular": 0.04}, "angular damping", 0.04),
    ],
)
def test_a_deviation_is_imposed_up_to_the_share_that_is_declared(
    gentle: Scene, faults: dict[str, float], quantity: str, share: float
) -> None:
    for allowed, verdict in ((1.02 * share, "imposed"), (0.98 * share, "mismatch")):
        assert faulty(gentle, {quantity: allowed}, **faults)[quantity] == verdict


def test_no_number_is_imposed_where_any_size_is(gentle: Scene) -> None:
    rows = dict.fromkeys(FRICTION, 1e9)
    assert faulty(gentle, rows, slop=1.0) == dict.fromkeys(FRICTION, "mismatch")
    rows = dict.fromkeys(FRICTION, math.inf)
    assert faulty(gentle, rows, slop=1.0) == dict.fromkeys(FRICTION, "imposed")


def test_a_slop_that_leaves_shallow_contact_alone_is_no_mismatch(gentle: Scene) -> None:
    assert faulty(gentle, slop=1e-5) == {}


def test_a_contact_that_never_pushes_is_a_mismatch(gentle: Scene) -> None:
    assert faulty(gentle, slop=1.0) == dict.fromkeys(FRICTION, "mismatch")


def in_single(numbers: np.ndarray) -> np.ndarray:
    """Return numbers rounded to single precision, as doubles."""
    return numbers.astype(np.float32).astype(np.float64)


class SingleToy(Toy):
    """The same, with a state, a mass and moments that are rounded to single precision."""

    def __init__(self, scene: Scene, **faults: float) -> None:
        super().__init__(scene, **faults)
        self.place(above_origin(1.0), AT_REST)

    @property
    def mass(self) -> float:
        return float(np.float32(super().mass))

    @property
    def inertia(self) -> np.ndarray:
        return in_single(super().inertia)

    def place(self, pose: Pose, twist: Twist) -> None:
        super().place(rounded_pose(pose), rounded_twist(twist))

    def step(self) -> None:
        super().step()
        super().place(rounded_pose(self._pose), rounded_twist(self._twist))
        self._force = in_single(self._force)


def rounded_pose(pose: Pose) -> Pose:
    """Return a pose whose position has single precision."""
    position = in_single(pose.position)
    return Pose(position=position, quaternion=pose.quaternion)


def rounded_twist(twist: Twist) -> Twist:
    """Return a twist in single precision."""
    return Twist(
        velocity=in_single(twist.velocity),
        angular_velocity=in_single(twist.angular_velocity),
    )


def found_in_single(scene: Scene, precision: Precision, **faults: float) -> set[str]:
    """Return the quantities that are not equal."""
    rows = parity(SingleToy(scene, **faults), scene, DT, {}, precision)
    return {row.quantity for row in rows if row.verdict != "equal"}


def test_single_precision_is_no_mismatch_where_it_is_declared(gentle: Scene) -> None:
    assert found_in_single(gentle, Precision.SINGLE) == set()
    assert {"mass", "transverse inertia A"} <= found_in_single(gentle, Precision.DOUBLE)


@pytest.mark.parametrize(
    ("faults", "quantities"),
    [
        ({"mass": 0.043 * (1 + 1e-5)}, {"mass"}),
        ({"gyroscopic": 0.9}, SPIN),
        ({"body": 1.0}, SPIN),
        ({"timestep": DT * (1 + 1e-4)}, {"timestep"}),
        ({"gravity": 9.81 * (1 + 1e-3)}, {"gravity"}),
        ({"linear": 0.04}, {"linear damping", "speed kept", "gravity"}),
        ({"clamp": 100.0}, {"speed kept", "spin kept"}),
        ({"radius": 0.037 * (1 + 1e-4)}, {"radius R", "rim deviation"}),
        ({"sides": 32.0}, {"radius R", "rim deviation"}),
        ({"mu": NO_SLIP_FRICTION * (1 + 1e-4)}, FRICTION),
    ],
    ids=lambda value: " ".join(sorted(value))[:40],
)
def test_a_fault_shows_in_single_precision_too(
    gentle: Scene, faults: dict[str, Any], quantities: set[str]
) -> None:
    found = found_in_single(gentle, Precision.SINGLE, **faults)
    assert quantities - {"gravity"} <= found <= quantities
