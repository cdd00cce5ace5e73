"""The URDF as the real PyBullet loads it."""

import xml.etree.ElementTree as ET
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from models import (
    GROUND_FRICTION,
    NO_SLIP_FRICTION,
    Effects,
    Slip,
    ground_urdf,
    load,
    names,
    release_state,
)
from models.to_urdf import urdf

pybullet = pytest.importorskip("pybullet", reason="pybullet is not installed")
FLAGS = pybullet.URDF_USE_INERTIA_FROM_FILE | pybullet.URDF_USE_IMPLICIT_CYLINDER


@pytest.fixture
def world() -> Iterator[int]:
    client = pybullet.connect(pybullet.DIRECT)
    yield client
    pybullet.disconnect(client)


def loaded(world: int, text: str, folder: Path, **where: object) -> int:
    # Bullet keeps a file it has read by its path, so no two texts may share one
    path = folder / f"{ET.fromstring(text).get('name')}.urdf"  # noqa: S314  # our own text
    path.write_text(text)
    return int(pybullet.loadURDF(str(path), flags=FLAGS, physicsClientId=world, **where))


IDEAL = [name for name in names() if not load(name).effects.declared()]
"""Scenes whose model is the can alone; the others' are looked at in test_models_of_effects.py."""


@pytest.mark.parametrize("name", IDEAL)
def test_bullet_loads_what_the_scene_declares(name: str, world: int, tmp_path: Path) -> None:
    scene = load(name)
    can = scene.can
    body = loaded(world, urdf(scene), tmp_path)
    mass, friction, inertia, centre, turned = pybullet.getDynamicsInfo(
        body, -1, physicsClientId=world
    )[:5]
    assert mass == can.mass
    assert inertia == (can.transverse_inertia, can.transverse_inertia, can.axial_inertia)
    assert centre == (0.0, 0.0, 0.0)
    assert turned == (0.0, 0.0, 0.0, 1.0)
    assert friction * GROUND_FRICTION == NO_SLIP_FRICTION
    ((_, _, kind, size, *_),) = pybullet.getCollisionShapeData(body, -1, physicsClientId=world)
    assert kind == pybullet.GEOM_CYLINDER
    assert size[:2] == (2.0 * can.half_height, can.radius)
    assert pybullet.getBodyInfo(body, physicsClientId=world) == (b"can", name.encode())


@pytest.mark.parametrize("mu", [0.0, 0.3])
def test_the_product_of_the_coefficients_is_that_of_the_pair(
    mu: float, world: int, tmp_path: Path
) -> None:
    scene = replace(load("gentle-rock"), effects=Effects(slip=Slip(mu=mu)))
    coefficients = [
        pybullet.getDynamicsInfo(body, -1, physicsClientId=world)[1]
        for body in (
            loaded(world, urdf(scene), tmp_path),
            loaded(world, ground_urdf(), tmp_path),
        )
    ]
    assert coefficients == [mu, 1.0]


def test_the_ground_is_a_true_plane_that_never_moves(world: int, tmp_path: Path) -> None:
    ground = loaded(world, ground_urdf(), tmp_path, useFixedBase=True)
    ((_, _, kind, normal, *_),) = pybullet.getCollisionShapeData(ground, -1, physicsClientId=world)
    assert kind == pybullet.GEOM_PLANE
    assert normal == (0.0, 0.0, 1.0)
    assert pybullet.getDynamicsInfo(ground, -1, physicsClientId=world)[0] == 0.0


def test_the_released_can_touches_the_ground(world: int, tmp_path: Path) -> None:
    scene = load("gentle-rock")
    pose, _ = release_state(scene.can, scene.release)
    w, x, y, z = pose.quaternion
    ground = loaded(world, ground_urdf(), tmp_path, useFixedBase=True)
    can = loaded(
        world,
        urdf(scene),
        tmp_path,
        basePosition=pose.position.tolist(),
        baseOrientation=(x, y, z, w),
    )
    for body in (ground, can):
        pybullet.changeDynamics(body, -1, collisionMargin=0.0, physicsClientId=world)
    ((*_, on_ground, on_can, normal, distance, _, _, _, _, _),) = pybullet.getClosestPoints(
        ground, can, 1e-3, physicsClientId=world
    )
    # Without a margin the implicit cylinder is exact, so what is left is round-off of its size.
    assert abs(distance) <= 1e-16
    assert normal == (0.0, 0.0, -1.0)
    assert on_ground[:2] == on_can[:2]


def test_the_text_parses_and_names_its_parts() -> None:
    root = ET.fromstring(urdf(load("petals")))  # noqa: S314  # our own text
    assert root.get("name") == "petals"
    assert [link.get("name") for link in root.findall("link")] == ["can"]
    assert {shape.get("name") for shape in root.iter("collision")} == {"can"}
