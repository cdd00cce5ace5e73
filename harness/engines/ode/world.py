"""An ODE world of a scene that can be placed, stepped and read.

The origin of a body in ODE is its centre of mass, so that the cylinder is fixed to it at an offset
where the scene has a point mass. The contacts are found before a step, and belong to the state
before it; their force is the one that the step applied. The softness of a contact goes with the
timestep and is set with it; damping is a wrench on the body, and the shaking of a plane a gravity
that is set anew before each step.
"""

import math
import weakref
from collections.abc import Mapping
from ctypes import byref, sizeof
from typing import Any

import numpy as np

from harness.engines import (
    Case,
    Collision,
    Contact,
    Floats,
    Value,
    contact_of,
    declared_friction,
    pressed_distance,
)
from harness.engines.ode.library import ode
from harness.engines.ode.settings import PROPORTION, QUICK_STEP, RIM
from models import Pose, Twist, angles, contact_offset, to_body
from models.gravity import gravity_vector, shaking
from models.kinematics import to_world
from models.mass import body as body_of

_MOST = 8
"""Contacts; a cylinder on a plane has four at most."""

_OVERFLOWING = 1e50
"""m/s and rad/s: a step multiplies velocities with each other several times."""

_ALL_DATA = 0xFFFFFFFF
"""dAllocateMaskAll: what a thread needs for a collider."""

_SEED = 0
_VELOCITY, _SPIN = ode.dBodyGetLinearVel, ode.dBodyGetAngularVel


class OdeWorld:
    """One can on one plane in ODE.

    Parameters
    ----------
    case : Case
    chosen : mapping of str to Value
        Every setting in force.
    timestep : float
        s.
    """

    def __init__(self, case: Case, chosen: Mapping[str, Value], timestep: float) -> None:
        ode.dAllocateODEDataForThread(_ALL_DATA)
        self._scene, self._solid, self._time = case.scene, body_of(case.scene), 0.0
        self._gravity, self._shaken = (
            gravity_vector(case.scene),
            case.scene.effects.shake is not None,
        )
        self._damping, self._rim = case.scene.effects.damping, chosen["contacts"] == RIM
        self._quick, self._seed = chosen["step"] == QUICK_STEP, _SEED
        self._iterations = int(chosen["QuickStepNumIterations"])  # type: ignore[arg-type]
        self.world = ode.dWorldCreate()
        self._space, self._joints = ode.dSimpleSpaceCreate(None), ode.dJointGroupCreate(0)
        weakref.finalize(self, _destroy, self.world, self._space, self._joints)
        for name in ("ERP", "CFM", "ContactSurfaceLayer", "QuickStepNumIterations", "QuickStepW"):
            getattr(ode, f"dWorldSet{name}")(self.world, chosen[name])
        if chosen["ContactMaxCorrectingVel"] is not None:
            ode.dWorldSetContactMaxCorrectingVel(self.world, chosen["ContactMaxCorrectingVel"])
        ode.dWorldSetGravity(self.world, *self._gravity.tolist())
        self.body = ode.dBodyCreate(self.world)
        for name in ("GyroscopicMode", "FiniteRotationMode"):
            getattr(ode, f"dBodySet{name}")(self.body, int(bool(chosen[name])))
        self._add_mass()
        self._add_shapes()
        # memory of the body, which every step writes anew
        self._quaternion = ode.dBodyGetQuaternion(self.body)
        self._spin = ode.dBodyGetAngularVel(self.body)
        self._centre, self._vector = (-self._solid.centre).tolist(), ode.dVector3()
        self._make_contacts(chosen)
        self._timestep = math.nan
        self.set_timestep(timestep)

    def _add_mass(self) -> None:
        """Give the body the mass and the tensor of the scene's can, about its centre of mass."""
        mass, tensor = ode.dMass(), self._solid.inertia
        moments = (*tensor.diagonal(), tensor[0, 1], tensor[0, 2], tensor[1, 2])
        ode.dMassSetParameters(byref(mass), self._solid.mass, 0.0, 0.0, 0.0, *moments)
        ode.dBodySetMass(self.body, byref(mass))

    def _add_shapes(self) -> None:
        """Fix the cylinder to the body, and lay the plane."""
        can = self._scene.can
        self._cylinder = ode.dCreateCylinder(self._space, can.radius, 2.0 * can.half_height)
        ode.dGeomSetBody(self._cylinder, self.body)
        if self._solid.centre.any():
            ode.dGeomSetOffsetPosition(self._cylinder, *(-self._solid.centre).tolist())
        self._plane = ode.dCreatePlane(self._space, 0.0, 0.0, 1.0, 0.0)

    def _make_contacts(self, chosen: Mapping[str, Value]) -> None:
        """Make contacts into which the collider writes, with the surface of the scene."""
        effects = self._scene.effects
        self._contacts = (ode.dContact * _MOST)()
        self._feedback = (ode.dJointFeedback * _MOST)()
        self._geoms = byref(self._contacts[0].geom)
        self._found = 0
        for contact in self._contacts:
            surface = contact.surface
            surface.mode = ode.dContactApprox1 if chosen["friction"] == PROPORTION else 0
            surface.mu = declared_friction(self._scene)
            if effects.restitution is not None:
                surface.mode |= ode.dContactBounce
                surface.bounce = effects.restitution.coefficient
            if effects.compliance is not None:
                surface.mode |= ode.dContactSoftERP | ode.dContactSoftCFM

    @property
    def mass(self) -> float:
        """Mass of the can with all that is fixed to it, kg."""
        return float(self._read_mass().mass)

    @property
    def inertia(self) -> Floats:
        """Moments about the body's axes through the centre of mass, shape (3,), kg m^2."""
        moments: Floats = np.diagonal(self.inertia_tensor).copy()
        return moments

    @property
    def inertia_tensor(self) -> Floats:
        """About the centre of mass in the body's axes, shape (3, 3), kg m^2."""
        return np.array(self._read_mass().I).reshape(3, 4)[:, :3]

    @property
    def centre_of_mass(self) -> Floats:
        """From the centre of the can in the body's axes, shape (3,), m."""
        return -np.array(ode.dGeomGetOffsetPosition(self._cylinder)[:3])

    def _read_mass(self) -> Any:  # noqa: ANN401 - the binding has no types
        mass = ode.dMass()
        ode.dBodyGetMass(self.body, byref(mass))
        return mass

    @property
    def timestep(self) -> float:
        """The timestep that was asked for, s."""
        return self._timestep

    def set_timestep(self, timestep: float) -> None:
        """Step by another length from now on, and set what goes with it."""
        if timestep == self._timestep:
            return
        self._timestep = timestep
        compliance = self._scene.effects.compliance
        if compliance is not None:
            # a spring and a damper, both taken at the end of the step
            stiff = timestep * compliance.stiffness
            for contact in self._contacts:
                contact.surface.soft_erp = stiff / (stiff + compliance.damping)
                contact.surface.soft_cfm = 1.0 / (stiff + compliance.damping)

    def place(self, pose: Pose, twist: Twist) -> None:
        """Put the can somewhere, moving; forget what was before."""
        self._time, self._found, self._seed = 0.0, 0, _SEED
        arm = to_world(pose.quaternion, self._solid.centre)
        velocity = twist.velocity + np.cross(twist.angular_velocity, arm)
        ode.dBodySetPosition(self.body, *(pose.position + arm).tolist())
        ode.dBodySetQuaternion(self.body, ode.dQuaternion(*pose.quaternion.tolist()))
        ode.dBodySetLinearVel(self.body, *velocity.tolist())
        ode.dBodySetAngularVel(self.body, *twist.angular_velocity.tolist())

    def step(self) -> None:
        """Advance by one timestep."""
        if self._shaken:
            gravity = self._gravity + shaking(self._scene, self._time, self._timestep)
            ode.dWorldSetGravity(self.world, *gravity.tolist())
            self._time += self._timestep
        if self._damping is not None:
            self._damp(self._damping.linear, self._damping.angular)
        ode.dJointGroupEmpty(self._joints)
        self._found = self._touch() if self._rim else self._collide()
        for place in range(self._found):
            joint = ode.dJointCreateContact(self.world, self._joints, self._contacts[place])
            ode.dJointAttach(joint, self.body, None)
            ode.dJointSetFeedback(joint, self._feedback[place])
        if not self._quick:
            ode.dWorldStep(self.world, self._timestep)
            return
        ode.dRandSetSeed(self._seed)  # for the order of the sweeps, one for all worlds of a process
        ode.dWorldQuickStep(self.world, self._timestep)
        self._seed = ode.dRandGetSeed()

    def _damp(self, linear: float, angular: float) -> None:
        """Put the drag of the coming step on the body, by rates in 1/s.

        ODE's own damping comes after the body was moved, which then goes farther than its speed.
        """
        velocity, spin = (np.array(get(self.body)[:3]) for get in (_VELOCITY, _SPIN))
        quaternion = np.array(self._quaternion[:4])
        momentum = self._solid.inertia @ to_body(quaternion, spin)
        ode.dBodyAddForce(self.body, *(-linear * self._solid.mass * velocity).tolist())
        ode.dBodyAddTorque(self.body, *(-angular * to_world(quaternion, momentum)).tolist())

    def _collide(self) -> int:
        """Let ODE find the contacts; return how many there are."""
        size = sizeof(ode.dContact)
        return int(ode.dCollide(self._cylinder, self._plane, _MOST, self._geoms, size))

    def _touch(self) -> int:
        """Hand over the lowest point of the rim if it is in the plane; return how many."""
        point = self._lowest()
        if point[2] > 0.0:
            return 0
        geom = self._contacts[0].geom
        geom.pos[:3], geom.normal[:3], geom.depth = point.tolist(), (0.0, 0.0, 1.0), -point[2]
        geom.g1, geom.g2 = self._cylinder, self._plane
        return 1

    def _lowest(self) -> Floats:
        """Return the lowest point of the rim, shape (3,), m."""
        pose = self.pose()
        phi, psi, _ = angles(pose.quaternion)
        lowest: Floats = pose.position + contact_offset(self._scene.can, phi, psi)
        return lowest

    @property
    def sweeps(self) -> int:
        """Sweeps of the relaxation in the last step; none without a contact."""
        return self._iterations if self._quick and self._found else 0

    def pose(self) -> Pose:
        """Return where the can is."""
        ode.dBodyGetRelPointPos(self.body, *self._centre, self._vector)
        return Pose(position=self._vector[:3], quaternion=self._quaternion[:4])

    def twist(self) -> Twist:
        """Return how the can moves.

        Raises
        ------
        InvalidValueError
            If the numbers break.
        """
        ode.dBodyGetRelPointVel(self.body, *self._centre, self._vector)
        velocity, spin = self._vector[:3], self._spin[:3]
        if not max(map(abs, (*velocity, *spin))) < _OVERFLOWING:
            spin = [math.nan] * 3  # which no twist takes
        return Twist(velocity=velocity, angular_velocity=spin)

    def contact(self) -> Contact:
        """Return the contact that the last step solved: that of the state before it."""
        touched = range(self._found)
        forces = np.array([self._feedback[place].f1[:3] for place in touched]).reshape(-1, 3)
        points = np.array([self._contacts[place].geom.pos[:3] for place in touched]).reshape(-1, 3)
        depths = [self._contacts[place].geom.depth for place in touched]
        return contact_of(points, forces, max(depths, default=math.nan))

    def collision(self) -> Collision:
        """Return the contact points where the can is, without a step."""
        count = self._touch() if self._rim else self._collide()
        geoms = [self._contacts[place].geom for place in range(count)]
        return Collision(
            points=np.array([geom.pos[:3] for geom in geoms]).reshape(-1, 3),
            normals=np.array([geom.normal[:3] for geom in geoms]).reshape(-1, 3),
            depths=np.array([geom.depth for geom in geoms]),
        )

    def signed_distance(self) -> float:
        """Return the signed distance from the collider of the can to the plane, m."""
        if self._rim:
            return float(self._lowest()[2])
        position = ode.dBodyGetPosition(self.body)[:3]

        def depth(lower: float) -> float | None:
            ode.dBodySetPosition(self.body, position[0], position[1], position[2] - lower)
            found = self._collide()
            return max((self._contacts[place].geom.depth for place in range(found)), default=None)

        try:
            return pressed_distance(depth, self._scene.can)
        finally:
            ode.dBodySetPosition(self.body, *position)


def _destroy(world: object, space: object, joints: object) -> None:
    """Give back the memory of a world."""
    ode.dJointGroupDestroy(joints)
    ode.dSpaceDestroy(space)
    ode.dWorldDestroy(world)
