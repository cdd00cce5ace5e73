"""The can and the plane of a case as a stage of USD."""

from collections.abc import Mapping

import numpy as np

from harness.engines import (
    MESH_SETTING,
    Case,
    Floats,
    Value,
    declared_friction,
    hull_triangles,
    mesh_points,
)
from models.gravity import gravity_vector
from models.mass import body as body_of

ALOFT = 100.0
"""Sizes of the can: out of reach of the plane."""

_USD = """#usda 1.0
(
    defaultPrim = "World"
    metersPerUnit = 1
    upAxis = "Z"
)
def Xform "World"
{{
    def PhysicsScene "Scene" (prepend apiSchemas = ["PhysxSceneAPI"])
    {{
        vector3f physics:gravityDirection = ({down[0]!r}, {down[1]!r}, {down[2]!r})
        float physics:gravityMagnitude = {gravity!r}
        bool physxScene:enableGPUDynamics = false
        uniform token physxScene:broadphaseType = "MBP"
        uniform token physxScene:solverType = "{solverType}"
        uniform token physxScene:collisionSystem = "{collisionSystem}"
        bool physxScene:enableExternalForcesEveryIteration = {enableExternalForcesEveryIteration:d}
        bool physxScene:enableEnhancedDeterminism = 1
        uniform bool physxScene:disableSleeping = {disableSleeping:d}
        float physxScene:bounceThreshold = 0
        float physxScene:frictionOffsetThreshold = {frictionOffsetThreshold!r}
        float physxScene:frictionCorrelationDistance = {frictionCorrelationDistance!r}
    }}
    def Material "Material" (prepend apiSchemas = ["PhysicsMaterialAPI", "PhysxMaterialAPI"])
    {{
        float physics:staticFriction = {mu!r}
        float physics:dynamicFriction = {mu!r}
        float physics:restitution = 0
    }}
    def Plane "Ground" (
        prepend apiSchemas = ["PhysicsCollisionAPI", "PhysxCollisionAPI", "MaterialBindingAPI"]
    )
    {{
        uniform token axis = "Z"
        rel material:binding:physics = </World/Material>
        float physxCollision:contactOffset = {contactOffset!r}
        float physxCollision:restOffset = 0
    }}
    def {shape} "Can" (
        prepend apiSchemas = ["PhysicsRigidBodyAPI", "PhysxRigidBodyAPI", "PhysicsCollisionAPI",
            "PhysxCollisionAPI", "PhysicsMassAPI", "PhysxContactReportAPI", "MaterialBindingAPI",
            "PhysicsMeshCollisionAPI"]
    )
    {{
{geometry}
        rel material:binding:physics = </World/Material>
        float physics:mass = {mass!r}
        float3 physics:diagonalInertia = ({moments[0]!r}, {moments[1]!r}, {moments[2]!r})
        quatf physics:principalAxes = (1, 0, 0, 0)
        point3f physics:centerOfMass = (0, 0, 0)
        float physxRigidBody:linearDamping = {linearDamping!r}
        float physxRigidBody:angularDamping = {angularDamping!r}
        float physxRigidBody:maxAngularVelocity = {maxAngularVelocity!r}
        float physxRigidBody:maxDepenetrationVelocity = {maxDepenetrationVelocity!r}
        float physxRigidBody:cfmScale = {cfmScale!r}
        bool physxRigidBody:enableGyroscopicForces = {enableGyroscopicForces:d}
        int physxRigidBody:solverPositionIterationCount = {solverPositionIterationCount}
        int physxRigidBody:solverVelocityIterationCount = {solverVelocityIterationCount}
        float physxCollision:contactOffset = {contactOffset!r}
        float physxCollision:restOffset = 0
        float physxContactReport:threshold = 0
        double3 xformOp:translate = (0, 0, {aloft!r})
        uniform token[] xformOpOrder = ["xformOp:translate"]
    }}
}}
"""

_CYLINDER = """\
        uniform token axis = "Z"
        double radius = {radius!r}
        double height = {height!r}"""

_MESH = """\
        uniform token physics:approximation = "convexHull"
        point3f[] points = {points}
        int[] faceVertexCounts = {counts}
        int[] faceVertexIndices = {corners}"""


def stage_text(case: Case, chosen: Mapping[str, Value]) -> str:
    """Return the can and the plane of a case as a stage of USD.

    Parameters
    ----------
    case : Case
    chosen : mapping of str to Value
        Every setting in force.
    """
    scene, effects, can = case.scene, case.scene.effects, case.scene.can
    gravity = gravity_vector(scene)
    size = float(np.linalg.norm(gravity))
    down = gravity / size if size > 0.0 else np.array((0.0, 0.0, -1.0))
    values = dict(chosen) | {"linearDamping": 0.0}
    if effects.damping is not None:
        values |= {
            "linearDamping": effects.damping.linear,
            "angularDamping": effects.damping.angular,
        }
    mesh = chosen[MESH_SETTING.name]
    if mesh is None:
        shape = "Cylinder"
        geometry = _CYLINDER.format(radius=can.radius, height=2.0 * can.half_height)
    else:
        shape, geometry = "Mesh", _hull(mesh_points(mesh, can))  # type: ignore[arg-type] # as checked
    return _USD.format(
        **values,
        down=down.tolist(),
        gravity=size,
        mu=declared_friction(scene),
        shape=shape,
        geometry=geometry,
        mass=can.mass,
        moments=np.diagonal(body_of(scene).inertia).tolist(),
        aloft=ALOFT * can.bounding_radius,
    )


def _hull(points: Floats) -> str:
    """Return the attributes of a mesh with the convex hull of some points, m."""
    sides = hull_triangles(points)
    return _MESH.format(
        points=list(map(tuple, points.tolist())),
        counts=[3] * len(sides),
        corners=sides.ravel().tolist(),
    )
