"""The probes of parity on a toy world: each fault shows in its own rows and in no other."""

# ruff: noqa: D102 - the methods of a toy are described where its role is

import math
from typing import Any

import numpy as np
import pytest

from harness.engines.base import Contact
from harness.engines.parity.checks import parity
from models import NO_SLIP_FRICTION, Pose, Scene, Twist, angles

DT = 1e-3


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
        spin *= math.exp(-self.fault("angular", 0.0) * DT)
        clamp = self.fault("clamp", math.inf)
        self._twist = Twist(
            velocity=np.clip(velocity, -clamp, clamp), angular_velocity=np.clip(spin, -clamp, clamp)
        )
        position = self._pose.position + dt * self._twist.velocity
        self._pose = Pose(position=position, quaternion=self._pose.quaternion)

    def pose(self) -> Pose:
        return self._pose

    def twist(self) -> Twist:
        return self._twist

    def set_timestep(self, timestep: float) -> None:
        raise AssertionError(timestep)

    def contact(self) -> Contact:
        return Contact(point=np.zeros(3), force=self._force, penetration=0.0, count=1)


def faulty(scene: Scene, imposed: frozenset[str] = frozenset(), **faults: float) -> dict[str, Any]:
    """Return the verdict of each quantity that is not equal."""
    rows = parity(Toy(scene, **faults), scene, DT, imposed)
    return {row.quantity: row.verdict for row in rows if row.verdict != "equal"}


def test_a_faultless_world_is_equal_in_everything(gentle: Scene) -> None:
    assert faulty(gentle) == {}


FAULTS: list[tuple[dict[str, Any], set[str]]] = [
    ({"mass": 0.043 * (1 + 1e-9)}, {"mass"}),
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
    ({"mu": NO_SLIP_FRICTION * (1 + 1e-5)}, {"friction of the pair"}),
    ({"mu": 0.0}, {"friction of the pair"}),
]


@pytest.mark.parametrize(
    ("faults", "quantities"), FAULTS, ids=lambda value: " ".join(sorted(value))[:40]
)
def test_a_fault_shows_where_it_is(
    gentle: Scene, faults: dict[str, Any], quantities: set[str]
) -> None:
    assert faulty(gentle, **faults) == dict.fromkeys(quantities, "mismatch")


def test_moments_are_told_apart(gentle: Scene) -> None:
    A, C = gentle.can.transverse_inertia, gentle.can.axial_inertia
    assert set(faulty(gentle, A=A * (1 + 1e-9))) == {"transverse inertia A"}
    assert set(faulty(gentle, C=C * (1 + 1e-9))) == {"axial inertia C"}
    lopsided = faulty(gentle, A=A * (1 + 1e-9), A2=A * (1 - 1e-9))
    assert set(lopsided) == {"inertia asymmetry"}


def test_what_is_known_to_differ_is_imposed_and_nothing_else(gentle: Scene) -> None:
    found = faulty(gentle, frozenset({"mass"}), mass=1.0, gravity=9.0)
    assert found == {"mass": "imposed", "gravity": "mismatch"}


def test_a_slop_that_leaves_shallow_contact_alone_is_no_mismatch(gentle: Scene) -> None:
    assert faulty(gentle, slop=1e-5) == {}


def test_a_contact_that_never_pushes_is_a_mismatch(gentle: Scene) -> None:
    assert faulty(gentle, slop=1.0) == {"friction of the pair": "mismatch"}
