"""A DART world of a scene that can be placed, stepped and read.

The can is a body on a free joint at its centre, so that its frame is the can's whatever its centre
of mass. The contacts that a step leaves behind belong to the state before the step; their force is
the one that a step applied. Damping is a wrench on the body, and the shaking of a plane a gravity
that is set anew before each step.
"""

import math
from collections.abc import Mapping
from typing import Any

import dartpy
import numpy as np

from harness.engines import (
    Case,
    Collision,
    Contact,
    Floats,
    InvalidSettingError,
    Value,
    contact_of,
    declared_friction,
    pressed_distance,
)
from harness.engines.dart.settings import DANTZIG, FCL, MESH, MOST_ITERATIONS, SHAPE_TYPE
from harness.engines.suppress_output import silence
from models import Pose, Twist, to_body
from models.gravity import gravity_vector, shaking
from models.mass import body as body_of

_OVERFLOWING = 1e50
"""m/s and rad/s: a step multiplies velocities with each other several times."""


def _detector(chosen: Mapping[str, Value]) -> Any:  # noqa: ANN401 - dartpy has no types
    """Return the collision detector of the settings.

    Raises
    ------
    InvalidSettingError
        If another than FCL's is to have a mesh.
    """
    name = str(chosen["collisionDetector"])
    detector = getattr(dartpy.collision, name)()
    if chosen[SHAPE_TYPE] == MESH:
        if name != FCL:
            raise InvalidSettingError(SHAPE_TYPE, MESH, f"PRIMITIVE with {name}")
        detector.setPrimitiveShapeType(type(detector).PrimitiveShape.MESH)
    return detector


class DartWorld:
    """One can on one plane in DART.

    Parameters
    ----------
    case : Case
    chosen : mapping of str to Value
        Every setting in force.
    timestep : float
        s.
    """

    def __init__(self, case: Case, chosen: Mapping[str, Value], timestep: float) -> None:
        scene, effects = case.scene, case.scene.effects
        self._scene, self._solid, self._time = scene, body_of(scene), 0.0
        self._gravity, self._shaken = gravity_vector(scene), effects.shake is not None
        self._damping = effects.damping
        self._timestep = timestep
        self.world = dartpy.simulation.World()
        self.world.setTimeStep(timestep)
        self.world.setGravity(self._gravity)
        sleep = self.world.getDeactivationOptions()
        sleep.mEnabled = bool(chosen["deactivation"])
        self.world.setDeactivationOptions(sleep)
        mu = declared_friction(scene)
        rebound = 0.0 if effects.restitution is None else effects.restitution.coefficient
        self.can = dartpy.dynamics.Skeleton("can")
        self._joint, self.body = self.can.createFreeJointAndBodyNodePair()
        solid = self._solid
        self.body.setInertia(dartpy.dynamics.Inertia(solid.mass, solid.centre, solid.inertia))
        ground = dartpy.dynamics.Skeleton("ground")
        _, plane = ground.createWeldJointAndBodyNodePair()
        cylinder = dartpy.dynamics.CylinderShape(scene.can.radius, 2.0 * scene.can.half_height)
        # of a pair DART takes the smaller friction and the product of the restitutions
        for node, shape, coefficient in (
            (self.body, cylinder, rebound),
            (plane, dartpy.dynamics.PlaneShape([0.0, 0.0, 1.0], 0.0), 1.0),
        ):
            collider = node.createShapeNode(shape)
            collider.createCollisionAspect()
            surface = collider.createDynamicsAspect()
            surface.setFrictionCoeff(mu)
            surface.setRestitutionCoeff(coefficient)
        self.world.addSkeleton(ground)
        self.world.addSkeleton(self.can)
        self._constraints = self.world.getConstraintSolver()
        with silence():  # DART tells that for a mesh FCL takes the plane as it is
            self._constraints.setCollisionDetector(_detector(chosen))
        self._constraints.setSplitImpulseEnabled(bool(chosen["splitImpulseEnabled"]))
        self._solver: Any = None
        if chosen["boxedLcpSolver"] != DANTZIG:
            self._solver = _cone_solver(chosen)
            self._constraints.setBoxedLcpSolver(self._solver)

    @property
    def mass(self) -> float:
        """Mass of the can with all that is fixed to it, kg."""
        return float(self.body.getInertia().getMass())

    @property
    def inertia(self) -> Floats:
        """Moments about the body's axes through the centre of mass, shape (3,), kg m^2."""
        moments: Floats = np.diagonal(self.inertia_tensor).copy()
        return moments

    @property
    def inertia_tensor(self) -> Floats:
        """About the centre of mass in the body's axes, shape (3, 3), kg m^2."""
        return np.array(self.body.getInertia().getMoment())

    @property
    def centre_of_mass(self) -> Floats:
        """From the centre of the can in the body's axes, shape (3,), m."""
        return np.array(self.body.getInertia().getLocalCOM()).ravel()

    @property
    def timestep(self) -> float:
        """The timestep that was asked for, s."""
        return self._timestep

    def set_timestep(self, timestep: float) -> None:
        """Step by another length from now on."""
        if timestep != self._timestep:
            self._timestep = timestep
            self.world.setTimeStep(timestep)

    def place(self, pose: Pose, twist: Twist) -> None:
        """Put the can somewhere, moving, at the time zero; wake it if it sleeps."""
        self.world.reset()
        self._time = 0.0
        frame = dartpy.math.Isometry3()
        frame.set_rotation(to_body(pose.quaternion, np.eye(3)))
        frame.set_translation(pose.position)
        self.can.setPositions(dartpy.dynamics.FreeJoint.convertToPositions(frame))
        self._joint.setAngularVelocity(twist.angular_velocity)
        self._joint.setLinearVelocity(twist.velocity)

    def step(self) -> None:
        """Advance by one timestep."""
        if self._shaken:
            sway = shaking(self._scene, self._time, self._timestep)
            self.world.setGravity(self._gravity + sway)
            self._time += self._timestep
        if self._damping is not None:
            self._damp(self._damping.linear, self._damping.angular)
        self.world.step()

    def _damp(self, linear: float, angular: float) -> None:
        """Put the drag of the coming step on the body, by rates in 1/s."""
        solid, rotation = self._solid, self.body.getWorldTransform().rotation()
        spin = self.body.getAngularVelocity().ravel()
        velocity = self.body.getCOMLinearVelocity().ravel()
        drag, torque = -linear * solid.mass * velocity, rotation @ solid.inertia @ rotation.T @ spin
        self.body.clearExternalForces()
        self.body.addExtForce(drag, solid.centre, False, True)  # noqa: FBT003 - world, body frame
        self.body.addExtTorque(-angular * torque, False)  # noqa: FBT003 - in world coordinates

    def pose(self) -> Pose:
        """Return where the can is."""
        frame = self.body.getWorldTransform()
        return Pose(position=frame.translation().ravel(), quaternion=frame.quaternion().wxyz())

    def twist(self) -> Twist:
        """Return how the can moves.

        Raises
        ------
        InvalidValueError
            If the numbers break: DART puts an identity and zeros in the place of what overflows.
        """
        velocity, spin = self.body.getLinearVelocity(), self.body.getAngularVelocity()
        if not max(np.abs(velocity).max(), np.abs(spin).max()) < _OVERFLOWING:
            spin = np.full(3, math.nan)  # which no twist takes
        return Twist(velocity=velocity.ravel(), angular_velocity=spin.ravel())

    def contact(self) -> Contact:
        """Return the contact that the last step solved: that of the state before it."""
        contacts = self.world.getLastCollisionResult().getContacts()
        # the force on the body that the normal points to, which is the plane or the can
        forces = [each.force * math.copysign(1.0, each.normal[2]) for each in contacts]
        points = [each.point for each in contacts]
        return contact_of(
            np.array(points).reshape(-1, 3),
            np.array(forces).reshape(-1, 3),
            max((each.penetrationDepth for each in contacts), default=math.nan),
        )

    def collision(self) -> Collision:
        """Return the contact points where the can is, without a step."""
        group, found = self._constraints.getCollisionGroup(), dartpy.collision.CollisionResult()
        group.collide(self._constraints.getCollisionOption(), found)
        contacts = found.getContacts()
        normals = np.array([each.normal for each in contacts]).reshape(-1, 3)
        return Collision(
            points=np.array([each.point for each in contacts]).reshape(-1, 3),
            normals=normals * np.copysign(1.0, normals[:, 2:]),
            depths=np.array([each.penetrationDepth for each in contacts]),
        )

    def signed_distance(self) -> float:
        """Return the signed distance from the collider of the can to the plane, m."""
        kept = self.can.getPositions()
        frame = dartpy.dynamics.FreeJoint.convertToTransform(kept)
        start, group = frame.translation().ravel(), self._constraints.getCollisionGroup()
        option, found = self._constraints.getCollisionOption(), dartpy.collision.CollisionResult()

        def depth(lower: float) -> float | None:
            frame.set_translation(start - (0.0, 0.0, lower))
            self.can.setPositions(dartpy.dynamics.FreeJoint.convertToPositions(frame))
            group.collide(option, found)
            return max((each.penetrationDepth for each in found.getContacts()), default=None)

        try:
            return pressed_distance(depth, self._scene.can)
        finally:
            self.can.setPositions(kept)

    def iterations(self) -> int:
        """Return the iterations of the solver so far; Dantzig's method tells none."""
        return 0 if self._solver is None else int(self._solver.getStats().numIterations)


def _cone_solver(chosen: Mapping[str, Value]) -> Any:  # noqa: ANN401 - dartpy has no types
    """Return the solver of the cone that is chosen, with its options."""
    name = str(chosen["boxedLcpSolver"])
    kind = getattr(dartpy.constraint, name)
    solver = kind()
    options = solver.getOptions()
    options.tolerance = chosen["tolerance"]
    setattr(options, MOST_ITERATIONS[name], chosen["maxSweeps"])
    if hasattr(options, "law"):
        options.law = getattr(kind.Law, str(chosen["law"]))
    solver.setOptions(options)
    return solver
