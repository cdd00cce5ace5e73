"""The scene as SDF and as USD, opened again by libraries that read these formats."""

import math
import xml.etree.ElementTree as ET

import numpy as np
import pytest

from models import Scene, load, names
from models.mass import body
from models.rim import released
from models.to_sdf import sdf
from models.to_usd import usd

SINGLE = 1e-6
"""Numbers of USD's physics are in single precision."""


@pytest.fixture(params=[name for name in names() if name != "chaotic-can"])
def scene(request: pytest.FixtureRequest) -> Scene:
    """Return each scene of the catalogue."""
    return load(request.param)


def test_what_a_world_cannot_say_is_a_comment() -> None:
    text = sdf(load("shaken-plane"))
    assert "Shake(" in text
    assert "m/s in the world" in text
    assert ET.fromstring(text).get("version") == "1.9"  # noqa: S314 - our own


@pytest.mark.engine("drake")
def test_drake_opens_the_can_of_a_world(scene: Scene) -> None:
    from pydrake.multibody.parsing import Parser  # noqa: PLC0415 - may not be installed
    from pydrake.multibody.plant import AddMultibodyPlantSceneGraph  # noqa: PLC0415
    from pydrake.systems.framework import DiagramBuilder  # noqa: PLC0415

    plant, graph = AddMultibodyPlantSceneGraph(DiagramBuilder(), 1e-3)
    Parser(plant).AddModelsFromString(sdf(scene), "sdf")
    plant.Finalize()
    can, rigid = plant.GetBodyByName("can"), body(scene)
    context = plant.CreateDefaultContext()
    assert can.get_mass(context) == pytest.approx(rigid.mass, rel=1e-15)
    inertia = can.CalcSpatialInertiaInBodyFrame(context)
    np.testing.assert_allclose(inertia.get_com(), rigid.centre, atol=1e-15)
    moments = inertia.Shift(inertia.get_com()).CalcRotationalInertia().CopyToFullMatrix3()
    np.testing.assert_allclose(moments, rigid.inertia, atol=1e-12 * rigid.inertia.max())
    pose, _ = released(scene)
    placed = plant.EvalBodyPoseInWorld(context, can)
    np.testing.assert_allclose(placed.translation(), pose.position, atol=1e-15)
    quaternion = placed.rotation().ToQuaternion().wxyz()
    assert abs(quaternion @ pose.quaternion) == pytest.approx(1.0, rel=1e-14)
    (shape,) = (
        graph.model_inspector().GetShape(each) for each in plant.GetCollisionGeometriesForBody(can)
    )
    assert (shape.radius(), shape.length()) == (scene.can.radius, 2.0 * scene.can.half_height)


def test_usd_opens_the_can_of_a_stage(scene: Scene) -> None:
    pytest.importorskip("pxr")
    from pxr import Gf, Usd, UsdGeom, UsdPhysics  # noqa: PLC0415 - may not be installed

    stage = Usd.Stage.CreateInMemory()
    stage.GetRootLayer().ImportFromString(usd(scene))
    can = stage.GetPrimAtPath("/World/Can")
    rigid, (pose, twist) = body(scene), released(scene)
    mass = UsdPhysics.MassAPI(can)
    assert mass.GetMassAttr().Get() == pytest.approx(rigid.mass, rel=SINGLE)
    assert list(mass.GetCenterOfMassAttr().Get()) == pytest.approx(rigid.centre, abs=1e-9)
    axes = Gf.Matrix3d(Gf.Quatd(mass.GetPrincipalAxesAttr().Get()))
    turned = np.array(axes).T  # USD turns row vectors
    inertia = turned @ np.diag(list(mass.GetDiagonalInertiaAttr().Get())) @ turned.T
    np.testing.assert_allclose(inertia, rigid.inertia, atol=SINGLE * rigid.inertia.max())
    placed = UsdGeom.Xformable(can).GetLocalTransformation()
    np.testing.assert_allclose(placed.ExtractTranslation(), pose.position, atol=1e-15)
    turn = placed.ExtractRotationQuat()
    quaternion = np.array((turn.GetReal(), *turn.GetImaginary()))
    assert abs(quaternion @ pose.quaternion) == pytest.approx(1.0, rel=1e-14)
    moving = UsdPhysics.RigidBodyAPI(can)
    assert list(moving.GetVelocityAttr().Get()) == pytest.approx(twist.velocity, abs=1e-6)
    spin = [math.radians(rate) for rate in moving.GetAngularVelocityAttr().Get()]
    assert spin == pytest.approx(twist.angular_velocity.tolist(), rel=SINGLE, abs=1e-6)
    cylinder = UsdGeom.Cylinder(can)
    assert cylinder.GetRadiusAttr().Get() == scene.can.radius
    assert cylinder.GetHeightAttr().Get() == 2.0 * scene.can.half_height
    physics = UsdPhysics.Scene(stage.GetPrimAtPath("/World/PhysicsScene"))
    assert physics.GetGravityMagnitudeAttr().Get() == pytest.approx(scene.gravity, rel=SINGLE)
    length = np.linalg.norm(physics.GetGravityDirectionAttr().Get())
    assert length == pytest.approx(1.0, rel=SINGLE)
