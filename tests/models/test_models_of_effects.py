"""The MJCF and URDF of scenes with effects: what the engines compile of them, and what they say."""

import json
from pathlib import Path

import mujoco
import numpy as np
import pytest

from models import Scene, load, release_state
from models.gravity import gravity_vector
from models.mass import body
from models.to_mjcf import dof_damping, mjcf
from models.to_urdf import urdf
from tests.support.declared_effects import EFFECTS, declaring

EPS = np.finfo(np.float64).eps


def scene(*names: str) -> Scene:
    return declaring(load("gentle-rock"), *names)


@pytest.mark.parametrize("effect", EFFECTS)
def test_mujoco_opens_every_file_and_steps_it(effect: str) -> None:
    model = mujoco.MjModel.from_xml_string(mjcf(scene(effect), contact_sensors=True))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_step(model, data, nstep=10)
    assert np.isfinite(data.qpos).all()
    assert data.time > 0.0


@pytest.mark.engine("pybullet")
@pytest.mark.parametrize("effect", EFFECTS)
def test_pybullet_opens_every_file(effect: str, tmp_path: Path) -> None:
    import pybullet  # noqa: PLC0415 - may not be installed

    (tmp_path / "can.urdf").write_text(urdf(scene(effect)))
    client = pybullet.connect(pybullet.DIRECT)
    try:
        flags = pybullet.URDF_USE_INERTIA_FROM_FILE
        can = pybullet.loadURDF(str(tmp_path / "can.urdf"), flags=flags, physicsClientId=client)
        info = pybullet.getDynamicsInfo(can, -1, physicsClientId=client)
    finally:
        pybullet.disconnect(client)
    assert info[0] == body(scene(effect)).mass
    expected = {
        "slip": (1, 0.3),
        "restitution": (5, 0.5),
        "rolling_resistance": (6, 5e-4),
        "drilling": (7, 1e-3),
        "compliance": (9, 2e4),
    }
    for name, (place, value) in expected.items():
        assert (info[place] == value) == (name == effect), name
    if effect == "compliance":
        assert info[8] == 5.0  # N s/m


def test_gravity_follows_the_tilt() -> None:
    tilted = scene("tilt")
    model = mujoco.MjModel.from_xml_string(mjcf(tilted))
    np.testing.assert_array_equal(model.opt.gravity, gravity_vector(tilted))


def test_a_point_mass_moves_the_centre_of_mass_and_not_the_frame() -> None:
    weighted = scene("point_mass")
    whole = body(weighted)
    model = mujoco.MjModel.from_xml_string(mjcf(weighted))
    can = model.body("can")
    assert can.mass[0] == whole.mass
    np.testing.assert_array_equal(can.ipos, whole.centre)
    rows = np.zeros(9)
    mujoco.mju_quat2Mat(rows, can.iquat)
    R = rows.reshape(3, 3)
    # MuJoCo's own eigenvectors, good to some roundings
    found = R @ np.diag(can.inertia) @ R.T
    np.testing.assert_allclose(found, whole.inertia, atol=1e-12 * can.inertia.max(), rtol=0)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    pose, _ = release_state(weighted.can, weighted.release)
    np.testing.assert_array_equal(data.qpos[:3], pose.position)


@pytest.mark.parametrize(
    ("names", "condim"),
    [
        ((), 3),
        (("slip",), 3),
        (("drilling",), 4),
        (("rolling_resistance",), 6),
        (("drilling", "rolling_resistance"), 6),
        (("tilt", "shake", "point_mass", "damping"), 3),
    ],
)
def test_the_contact_has_as_many_rows_as_are_called_for(
    names: tuple[str, ...], condim: int
) -> None:
    model = mujoco.MjModel.from_xml_string(mjcf(scene(*names)))
    assert model.geom("can").condim[0] == model.geom("ground").condim[0] == condim
    mu, torsion, rolling = model.geom("can").friction
    if "drilling" in names:
        assert torsion == 1e-3
    if "rolling_resistance" in names:
        assert rolling == 5e-4
        assert torsion == (1e-3 if "drilling" in names else 0.0)
    assert mu == (0.3 if "slip" in names else 2.0)


def test_the_damping_of_each_degree_of_freedom_is_the_law() -> None:
    damped = scene("damping")
    can = damped.can
    across, along = 0.3 * can.transverse_inertia, 0.3 * can.axial_inertia
    assert dof_damping(damped) == (*(0.5 * can.mass,) * 3, across, across, along)
    assert dof_damping(scene()) is None
    assert json.dumps(across) in mjcf(damped)


@pytest.mark.parametrize("effect", ["shake", "damping", "rim", "restitution"])
def test_a_file_says_what_it_cannot_carry(effect: str) -> None:
    assert "<!--" in mjcf(scene(effect))
    if effect != "restitution":
        assert "<!--" in urdf(scene(effect))


@pytest.mark.parametrize("effect", ["slip", "tilt", "point_mass", "compliance", "drilling"])
def test_a_file_that_carries_everything_says_nothing(effect: str) -> None:
    assert "<!--" not in mjcf(scene(effect))
