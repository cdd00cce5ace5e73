"""Energy where a scene declares effects: by its definition anew, or told to be no constant."""

from dataclasses import replace

import numpy as np
import pytest

from harness.metrics.energy import conserves_energy, energy, energy_drift
from models import (
    Compliance,
    Damping,
    Effects,
    PointMass,
    Restitution,
    Scene,
    Slip,
    Tilt,
    quaternion,
)
from tests.support.declared_effects import effects_of
from tests.support.trajectories import make_trajectory

EPS = np.finfo(np.float64).eps


def test_a_point_mass_adds_its_own_energy(gentle: Scene) -> None:
    point = PointMass(mass=0.01, x=0.02, y=0.005, z=-0.01)
    weighted = replace(gentle, effects=Effects(point_mass=point))
    psi, spin, velocity = 0.7, np.array((1.0, -2.0, 3.0)), np.array((0.3, 0.1, -0.2))
    turned = np.array(
        ((np.cos(psi), -np.sin(psi), 0.0), (np.sin(psi), np.cos(psi), 0.0), (0.0, 0.0, 1.0))
    )
    one = make_trajectory(
        1,
        quaternion=quaternion(0.0, psi, 0.0)[None],
        position=np.array(((0.0, 0.0, 2.0),)),
        velocity=velocity[None],
        angular_velocity=spin[None],
    )
    place = turned @ (point.x, point.y, point.z)
    moving = velocity + np.cross(spin, place)
    own = 0.5 * point.mass * moving @ moving + point.mass * 9.81 * (2.0 + point.z)
    added = energy(one, weighted)[0] - energy(one, gentle)[0]
    assert added == pytest.approx(own, rel=64 * EPS, abs=0)


def test_down_a_tilted_plane_energy_is_lost_by_height(gentle: Scene) -> None:
    tilted = replace(gentle, effects=Effects(tilt=Tilt(angle=0.1, direction=np.pi / 2.0)))
    down = make_trajectory(2, position=np.array(((0.0, 0.0, 1.0), (0.0, 3.0, 1.0))))
    change = np.diff(energy(down, tilted))[0]
    assert change == pytest.approx(-gentle.can.mass * 9.81 * 3.0 * np.sin(0.1), rel=64 * EPS, abs=0)


CONSERVED = [
    Effects(),
    Effects(slip=Slip(mu=0.0)),
    Effects(restitution=Restitution(coefficient=1.0)),
    *map(effects_of, ("tilt", "point_mass", "rim")),
]
TAKE_OR_BRING = (
    "slip",
    "compliance",
    "restitution",
    "drilling",
    "rolling_resistance",
    "damping",
    "shake",
)
NOT_CONSERVED = [
    *map(effects_of, TAKE_OR_BRING),
    effects_of("tilt", "damping"),
    Effects(compliance=Compliance(stiffness=2e4)),
    Effects(damping=Damping(linear=0.1)),
    Effects(damping=Damping(angular=0.1)),
]


@pytest.mark.parametrize("effects", CONSERVED)
def test_what_takes_nothing_has_a_drift(gentle: Scene, effects: Effects) -> None:
    scene = replace(gentle, effects=effects)
    assert conserves_energy(scene)
    assert energy_drift(make_trajectory(3), scene) == 0.0


@pytest.mark.parametrize("effects", NOT_CONSERVED)
def test_what_takes_or_brings_has_none(gentle: Scene, effects: Effects) -> None:
    scene = replace(gentle, effects=effects)
    assert not conserves_energy(scene)
    assert energy_drift(make_trajectory(3), scene) is None


def test_without_gravity_there_is_no_scale(gentle: Scene) -> None:
    assert energy_drift(make_trajectory(3), replace(gentle, gravity=0.0)) is None


def test_a_point_mass_is_where_the_can_has_turned_it(gentle: Scene) -> None:
    """In any orientation, by the vectors of the body's axes."""
    point = PointMass(mass=0.01, x=0.02, y=0.005, z=-0.01)
    weighted = replace(gentle, effects=Effects(point_mass=point))
    turned = np.array((0.5, -0.1, 0.7, 0.5))  # of unit length, all four components at work
    w, v = turned[0], turned[1:]
    place = np.array((point.x, point.y, point.z))
    place = place + 2.0 * w * np.cross(v, place) + 2.0 * np.cross(v, np.cross(v, place))
    one = make_trajectory(1, quaternion=turned[None])
    added = energy(one, weighted)[0] - energy(one, gentle)[0]
    assert added == pytest.approx(point.mass * 9.81 * place[2], rel=64 * EPS, abs=0)
