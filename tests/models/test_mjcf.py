"""The MJCF as the real MuJoCo compiles it."""

import xml.etree.ElementTree as ET
from dataclasses import replace
from typing import Any

import mujoco
import numpy as np
import pytest

from models import (
    DEPTH_SENSOR,
    NET_SENSOR,
    NO_SLIP_FRICTION,
    Can,
    Effects,
    Release,
    Scene,
    Slip,
    contact_point,
    load,
    names,
    release_state,
)
from models.to_mjcf import mjcf

EPS = np.finfo(np.float64).eps
SPIN = Release(phi=0.3, psi=0.7, theta=-2.0, phi_dot=-0.5, psi_dot=5.0, theta_dot=3.0)


def compiled(scene: Scene, **settings: Any) -> tuple[mujoco.MjModel, mujoco.MjData]:
    """Return the compiled model, and its data at the release."""
    model = mujoco.MjModel.from_xml_string(mjcf(scene, **settings))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("release").id)
    return model, data


IDEAL = [name for name in names() if not load(name).effects.declared()]
"""Scenes whose model is the can alone; the others' are looked at in test_models_of_effects.py."""


@pytest.mark.parametrize("name", IDEAL)
def test_mujoco_compiles_what_the_scene_declares(name: str) -> None:
    scene = load(name)
    model, data = compiled(scene)
    can = scene.can
    body, geom = model.body("can"), model.geom("can")
    assert body.mass[0] == can.mass
    # MuJoCo may turn the axes of equal moments: the moments are compared, C along the axis below
    np.testing.assert_array_equal(
        body.inertia, (can.transverse_inertia, can.transverse_inertia, can.axial_inertia)
    )
    np.testing.assert_array_equal(body.iquat, (1.0, 0.0, 0.0, 0.0))
    np.testing.assert_array_equal(body.ipos, (0.0, 0.0, 0.0))
    assert geom.type[0] == mujoco.mjtGeom.mjGEOM_CYLINDER
    assert tuple(geom.size[:2]) == (can.radius, can.half_height)
    assert model.geom("ground").type[0] == mujoco.mjtGeom.mjGEOM_PLANE
    np.testing.assert_array_equal(model.opt.gravity, (0.0, 0.0, -scene.gravity))
    assert model.nv == 6
    assert model.dof_damping.max() == 0.0
    pose, _ = release_state(can, scene.release)
    np.testing.assert_array_equal(data.qpos[:3], pose.position)
    # MuJoCo normalises the quaternion once more
    np.testing.assert_allclose(data.qpos[3:], pose.quaternion, atol=2 * EPS, rtol=0)
    np.testing.assert_allclose(model.qpos0, data.qpos, atol=2 * EPS, rtol=0)


@pytest.mark.parametrize("release", [SPIN, Release(phi=1e-3), Release(phi=1.5, theta=2.0)])
def test_the_released_can_touches_the_plane_at_its_contact_point(release: Release) -> None:
    scene = replace(load("gentle-rock"), release=release)
    model, data = compiled(scene, geom={"margin": "1e-9"})
    mujoco.mj_forward(model, data)
    pose, _ = release_state(scene.can, release)
    expected = contact_point(scene.can, pose.position, pose.quaternion)
    size = scene.can.bounding_radius
    assert data.ncon == 1
    # MuJoCo finds the lowest rim point along a vector of length sin phi, known to eps
    tolerance = 16 * EPS * size / np.sin(release.phi)
    np.testing.assert_allclose(data.contact[0].pos, expected, atol=tolerance, rtol=0)
    assert abs(data.contact[0].dist) <= tolerance


def test_the_keyframe_rolls_without_slipping() -> None:
    scene = replace(load("gentle-rock"), release=SPIN)
    model, data = compiled(scene)
    mujoco.mj_forward(model, data)
    _, twist = release_state(scene.can, SPIN)
    found = np.zeros(6)  # rotational first, in the world
    mujoco.mj_objectVelocity(model, data, mujoco.mjtObj.mjOBJ_BODY, model.body("can").id, found, 0)
    # rotated into the body and out again: a few roundings each way
    speed = np.linalg.norm(twist.angular_velocity)
    np.testing.assert_allclose(found[:3], twist.angular_velocity, atol=16 * EPS * speed, rtol=0)
    np.testing.assert_allclose(found[3:], twist.velocity, atol=16 * EPS * speed, rtol=0)
    pose, _ = release_state(scene.can, SPIN)
    point = contact_point(scene.can, pose.position, pose.quaternion)
    jacobian = np.zeros((3, 6))
    mujoco.mj_jac(model, data, jacobian, None, point, model.body("can").id)
    slip = jacobian @ data.qvel
    assert np.linalg.norm(slip) <= 32 * EPS * speed * scene.can.bounding_radius


@pytest.mark.parametrize(
    ("slip", "friction", "condim"),
    [(None, NO_SLIP_FRICTION, 3), (Slip(mu=0.3), 0.3, 3), (Slip(mu=0.0), 0.0, 1)],
)
def test_friction_is_that_of_the_pair(slip: Slip | None, friction: float, condim: int) -> None:
    scene = replace(load("gentle-rock"), effects=Effects(slip=slip))
    model, data = compiled(scene, geom={"margin": "1e-6"})
    mujoco.mj_forward(model, data)
    contact = data.contact[0]
    assert contact.dim == condim
    if condim > 1:
        assert contact.friction[0] == contact.friction[1] == friction


def test_the_catalogue_needs_no_more_friction_than_no_slip_stands_for() -> None:
    # 1.021 in the bounces of `wobble`, the most that any scene asks whose plane need not pull
    assert NO_SLIP_FRICTION > 1.021


def test_settings_reach_the_compiled_model() -> None:
    model, _ = compiled(
        load("gentle-rock"),
        option={"timestep": "1e-5", "cone": "elliptic", "impratio": "100"},
        flag={"energy": "enable"},
        geom={"solref": "2e-5 1"},
    )
    assert model.opt.timestep == 1e-5
    assert model.opt.cone == mujoco.mjtCone.mjCONE_ELLIPTIC
    assert model.opt.impratio == 100.0
    assert model.opt.enableflags == mujoco.mjtEnableBit.mjENBL_ENERGY
    np.testing.assert_array_equal(model.geom_solref, ((2e-5, 1.0), (2e-5, 1.0)))


def test_nothing_is_simulated_that_was_not_asked_for() -> None:
    model, _ = compiled(load("gentle-rock"))
    assert model.nsensor == 0
    assert model.opt.enableflags == 0
    assert model.opt.disableflags == 0


@pytest.mark.parametrize(("phi", "contacts"), [(0.3, 1), (1e-5, 3)])
def test_the_sensors_give_the_resultant_of_all_contacts(phi: float, contacts: int) -> None:
    scene = replace(load("gentle-rock"), release=replace(SPIN, phi=phi))
    model, data = compiled(scene, contact_sensors=True, option={"cone": "elliptic"})
    data.qpos[2] -= 2e-5  # penetration enough for three contacts when nearly flat
    mujoco.mj_forward(model, data)
    assert data.ncon == contacts
    net = data.sensor(NET_SENSOR).data
    assert net[0] == contacts

    force, weighted, weights = np.zeros(3), np.zeros(3), 0.0
    for index in range(contacts):
        wrench = np.zeros(6)
        mujoco.mj_contactForce(model, data, index, wrench)
        contact = data.contact[index]
        part = contact.frame.reshape(3, 3).T @ wrench[:3]
        force += part
        weighted += np.linalg.norm(part) * contact.pos
        weights += float(np.linalg.norm(part))
    # the same sums in another order, of forces below 1 N at distances below 0.1 m
    np.testing.assert_allclose(net[1:4], force, atol=16 * EPS, rtol=0)
    np.testing.assert_allclose(net[4:7], weighted / weights, atol=16 * EPS, rtol=0)
    assert net[3] > 0.0  # the plane pushes the can up: the force is the one on the can
    assert data.sensor(DEPTH_SENSOR).data[0] == min(c.dist for c in data.contact)
    assert data.sensordata.size == 8


def test_the_sensors_are_zero_without_contact() -> None:
    model, data = compiled(load("gentle-rock"), contact_sensors=True)
    data.qpos[2] += 1e-3
    mujoco.mj_forward(model, data)
    assert not data.sensordata.any()


def test_a_flat_disk_and_a_needle_compile() -> None:
    for a, c in ((0.25, 0.5), (10.0, 1e-6)):
        can = Can.from_groups(mass=0.043, radius=0.037, a=a, c=c, h=1.0)
        model, _ = compiled(replace(load("gentle-rock"), can=can))
        assert model.body("can").inertia[2] == can.axial_inertia


def test_every_element_that_can_be_named_is() -> None:
    root = ET.fromstring(mjcf(load("gentle-rock"), contact_sensors=True))  # noqa: S314  # our own
    unnamed = {"mujoco", "option", "flag", "worldbody", "inertial", "sensor", "keyframe"}
    for element in root.iter():
        assert element.tag in unnamed or element.get("name")


def test_attributes_are_escaped_and_never_pasted() -> None:
    hostile = '"/><plugin file="x&y'
    scene = replace(load("gentle-rock"), cite=hostile)
    root = ET.fromstring(mjcf(scene, option={"solver": hostile}))  # noqa: S314  # our own
    assert root.findall("option")[0].get("solver") == hostile
    assert root.find(".//plugin") is None


def test_the_text_is_a_function_of_the_scene() -> None:
    assert mjcf(load("petals")) == mjcf(load("petals"))
    assert mjcf(load("petals")) != mjcf(load("wobble"))
