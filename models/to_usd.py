"""The scene as USD with UsdPhysics, for Isaac, Newton and others that read it.

The stage has metres, kilograms and z up; the prim of the can has the centre of the can at its
origin and z along the symmetry axis, and is let go with the velocities of the release. Needs the
package `usd-core`.
"""

import math
from typing import Any

from models.effects import NO_SLIP_FRICTION
from models.gravity import gravity_vector
from models.mass import body
from models.rim import released
from models.scene import Scene


def usd(scene: Scene) -> str:
    """Return the scene as the text of a USD stage.

    Parameters
    ----------
    scene : Scene

    Returns
    -------
    str
        A stage with the prims `/World/PhysicsScene`, `/World/Ground`, `/World/Can` and the material
        of their contact, `/World/Contact`. What USD has no words for is in the stage's comment.

    Raises
    ------
    ImportError
        Without `usd-core`.
    """
    from pxr import Gf, Usd, UsdGeom, UsdPhysics, UsdShade  # noqa: PLC0415 - an extra

    stage = Usd.Stage.CreateInMemory()
    stage.SetMetadata("comment", _beyond_usd(scene))
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    UsdPhysics.SetStageKilogramsPerUnit(stage, 1.0)
    world = UsdGeom.Xform.Define(stage, "/World").GetPrim()
    stage.SetDefaultPrim(world)

    physics = UsdPhysics.Scene.Define(stage, "/World/PhysicsScene")
    down = gravity_vector(scene)
    direction = down / scene.gravity if scene.gravity else (0.0, 0.0, -1.0)
    physics.CreateGravityDirectionAttr(Gf.Vec3f(*map(float, direction)))
    physics.CreateGravityMagnitudeAttr(scene.gravity)

    contact = UsdShade.Material.Define(stage, "/World/Contact")
    material = UsdPhysics.MaterialAPI.Apply(contact.GetPrim())
    effects = scene.effects
    mu = NO_SLIP_FRICTION if effects.slip is None else effects.slip.mu
    material.CreateStaticFrictionAttr(mu)
    material.CreateDynamicFrictionAttr(mu)
    rebound = 0.0 if effects.restitution is None else effects.restitution.coefficient
    material.CreateRestitutionAttr(rebound)

    ground = UsdGeom.Plane.Define(stage, "/World/Ground")
    ground.CreateAxisAttr(UsdGeom.Tokens.z)
    can = UsdGeom.Cylinder.Define(stage, "/World/Can")
    can.CreateAxisAttr(UsdGeom.Tokens.z)
    can.CreateRadiusAttr(scene.can.radius)
    can.CreateHeightAttr(2.0 * scene.can.half_height)
    for prim in (ground.GetPrim(), can.GetPrim()):
        UsdPhysics.CollisionAPI.Apply(prim)
        binding = UsdShade.MaterialBindingAPI.Apply(prim)
        binding.Bind(contact, UsdShade.Tokens.weakerThanDescendants, "physics")

    pose, twist = released(scene)
    can.AddTranslateOp(UsdGeom.XformOp.PrecisionDouble).Set(Gf.Vec3d(*pose.position.tolist()))
    can.AddOrientOp(UsdGeom.XformOp.PrecisionDouble).Set(Gf.Quatd(*pose.quaternion.tolist()))
    moving = UsdPhysics.RigidBodyAPI.Apply(can.GetPrim())
    moving.CreateVelocityAttr(Gf.Vec3f(*twist.velocity.tolist()))
    spin = [math.degrees(rate) for rate in twist.angular_velocity.tolist()]
    moving.CreateAngularVelocityAttr(Gf.Vec3f(*spin))
    _mass(UsdPhysics.MassAPI.Apply(can.GetPrim()), scene, Gf)
    text: str = stage.GetRootLayer().ExportToString()
    return text


def _mass(mass: Any, scene: Scene, gf: Any) -> None:  # noqa: ANN401 - of USD
    """Set mass, centre of mass, and principal moments with their axes."""
    rigid = body(scene)
    moments, axes = rigid.principal()
    mass.CreateMassAttr(rigid.mass)
    mass.CreateCenterOfMassAttr(gf.Vec3f(*rigid.centre.tolist()))
    mass.CreateDiagonalInertiaAttr(gf.Vec3f(*moments.tolist()))
    # USD turns row vectors: its matrix is the transpose of the axes as columns
    turned = gf.Matrix3d(*axes.T.ravel().tolist()).ExtractRotation().GetQuat()
    mass.CreatePrincipalAxesAttr(gf.Quatf(turned))


_SAID = frozenset({"slip", "restitution", "tilt", "point_mass"})
"""Effects that the stage has."""


def _beyond_usd(scene: Scene) -> str:
    """Return what the stage cannot say, in sentences."""
    absent = [
        repr(getattr(scene.effects, effect))
        for effect in scene.effects.declared()
        if effect not in _SAID
    ]
    return f"To be applied beside: {'; '.join(absent)}." if absent else ""
