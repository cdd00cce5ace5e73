"""A Pinocchio world of a scene that can be placed, stepped and read.

The can is a free flyer whose frame is the can's: position and quaternion (scalar last), and the
velocities in the axes of the body. A step goes to the free velocity first, by the articulated body
algorithm; coal finds the contacts of the state before it; a solver finds the impulses on Coulomb's
cone that leave no contact closing by more than its gap; and the state is integrated with the
velocity that is left.
"""

import math
from collections.abc import Mapping
from typing import Any

import coal
import numpy as np
import pinocchio as pin

from harness.engines import (
    AT_REST,
    Case,
    Collision,
    Contact,
    Floats,
    Value,
    above_origin,
    contact_of,
    declared_friction,
)
from models import Pose, Twist, to_body
from models.gravity import gravity_vector, shaking
from models.kinematics import to_world
from models.mass import body as body_of

_MOST = 4
"""Contacts between a cylinder and a plane."""

_TOLERANCES = tuple(
    f"{kind}_{what}_tol"
    for kind in ("absolute", "relative")
    for what in ("feasibility", "complementarity")
)


class PinocchioWorld:
    """One can on one plane in Pinocchio.

    Parameters
    ----------
    case : Case
    chosen : mapping of str to Value
        Every setting in force.
    timestep : float
        s.
    """

    def __init__(self, case: Case, chosen: Mapping[str, Value], timestep: float) -> None:
        self._scene, solid, self.timestep = case.scene, body_of(case.scene), timestep
        self._correction = float(chosen["correction"])  # type: ignore[arg-type]
        self.model = pin.Model()
        joint = self.model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "can")
        inertia = pin.Inertia(solid.mass, solid.centre, solid.inertia)
        self.model.appendBodyToJoint(joint, inertia, pin.SE3.Identity())
        self.model.gravity.linear = gravity_vector(case.scene)
        self.data = self.model.createData()
        self._mass_inverse = np.linalg.inv(inertia.matrix())  # in the axes of the body, for ever
        can = case.scene.can
        self._cylinder = coal.Cylinder(can.radius, 2.0 * can.half_height)
        self._plane = coal.Halfspace(np.array((0.0, 0.0, 1.0)), 0.0)
        self._ground = coal.Transform3s()
        self._request = coal.CollisionRequest(coal.CollisionRequestFlag.CONTACT, _MOST)
        self._request.security_margin = chosen["security_margin"]
        self._solver = getattr(pin, f"{chosen['solver']}ConstraintSolver")()
        self._options = getattr(pin, f"{chosen['solver']}SolverSettings")()
        self._options.max_iterations, self._options.solve_ncp = chosen["max_iterations"], True
        for name in _TOLERANCES:
            setattr(self._options, name, chosen["tolerance"])
        self._new_result = getattr(pin, f"{chosen['solver']}SolverResult")
        self._cones = [self._cones_of(count) for count in range(_MOST + 1)]
        self.place(above_origin(0.0), AT_REST)

    def _cones_of(self, count: int) -> tuple[Any, Any]:
        """Return so many contacts, which are the cones of a solver, and their data."""
        models, datas = pin.StdVec_ConstraintModel(), pin.StdVec_ConstraintData()
        for _ in range(count):
            contact = pin.PointContactConstraintModel(self.model, 1)
            contact.setFriction(declared_friction(self._scene))
            models.append(pin.ConstraintModel(contact))
            datas.append(models[-1].createData())
        return models, datas

    @property
    def mass(self) -> float:
        """Mass of the can with all that is fixed to it, kg."""
        return float(self.model.inertias[1].mass)

    @property
    def inertia(self) -> Floats:
        """Moments about the body's axes through the centre of mass, shape (3,), kg m^2."""
        moments: Floats = np.diagonal(self.inertia_tensor).copy()
        return moments

    @property
    def inertia_tensor(self) -> Floats:
        """About the centre of mass in the body's axes, shape (3, 3), kg m^2."""
        return np.array(self.model.inertias[1].inertia)

    @property
    def centre_of_mass(self) -> Floats:
        """From the centre of the can in the body's axes, shape (3,), m."""
        return np.array(self.model.inertias[1].lever)

    def set_timestep(self, timestep: float) -> None:
        """Step by another length from now on."""
        self.timestep = timestep

    def place(self, pose: Pose, twist: Twist) -> None:
        """Put the can somewhere, moving; forget what was before."""
        self._time, self.iterations = 0.0, 0
        self._contact = contact_of(np.empty((0, 3)), np.empty((0, 3)), math.nan)
        self.q = np.concatenate((pose.position, np.roll(pose.quaternion, -1)))
        own = (to_body(pose.quaternion, each) for each in (twist.velocity, twist.angular_velocity))
        self.v = np.concatenate(tuple(own))

    def pose(self) -> Pose:
        """Return where the can is."""
        return Pose(position=self.q[:3], quaternion=np.roll(self.q[3:], 1))

    def twist(self) -> Twist:
        """Return how the can moves."""
        velocity, spin = to_world(np.roll(self.q[3:], 1), self.v.reshape(2, 3))
        return Twist(velocity=velocity, angular_velocity=spin)

    def contact(self) -> Contact:
        """Return the contact that the last step solved: that of the state before it."""
        return self._contact

    def collision(self) -> Collision:
        """Return the contact points where the can is, without a step."""
        contacts = self._touching()
        return Collision(
            points=np.array([each.pos for each in contacts]).reshape(-1, 3),
            normals=np.array([each.normal for each in contacts]).reshape(-1, 3),
            depths=-np.array([each.penetration_depth for each in contacts]),
        )

    def _touching(self) -> list[Any]:
        """Return the contacts of coal, whose normals point from the plane to the can."""
        found = coal.CollisionResult()
        shapes = (self._plane, self._ground, self._cylinder, self._placed())
        coal.collide(*shapes, self._request, found)
        return list(found.getContacts())

    def signed_distance(self) -> float:
        """Return the signed distance from the collider of the can to the plane, m."""
        request, result = coal.DistanceRequest(), coal.DistanceResult()
        placed = self._placed()
        shapes = (self._plane, self._ground, self._cylinder, placed)
        return float(coal.distance(*shapes, request, result))

    def step(self) -> None:
        """Advance by one timestep."""
        dt, inverse = self.timestep, self._mass_inverse
        if self._scene.effects.shake is not None:
            sway = shaking(self._scene, self._time, dt)
            self.model.gravity.linear = gravity_vector(self._scene) + sway
            self._time += dt
        free = self.v + dt * pin.aba(self.model, self.data, self.q, self.v, self._drag())
        contacts = self._touching()
        points = np.array([each.pos for each in contacts]).reshape(-1, 3)
        gaps = np.array([each.penetration_depth for each in contacts])  # negative inside
        frame = pin.XYZQUATToSE3(self.q)
        # from the velocities of the body to those of its points that touch, in the world
        jacobian = np.array(
            [pin.SE3(np.eye(3), point).actInv(frame).action[:3] for point in points]
        ).reshape(-1, 6)
        impulses = np.zeros_like(points)
        if contacts:
            closing = (jacobian @ free).reshape(-1, 3)
            closing[:, 2] += np.where(gaps < 0.0, self._correction, 1.0) * gaps / dt
            impulses = self._impulses(jacobian @ inverse @ jacobian.T, closing)
        self._contact = contact_of(points, impulses / dt, -gaps.min(initial=math.inf))
        self.v = free + inverse @ (jacobian.T @ impulses.ravel())
        self.q = pin.integrate(self.model, self.q, self.v * dt)

    def _impulses(self, delassus: Floats, closing: Floats) -> Floats:
        """Return the impulses on the can, shape (n, 3), N s, of contacts that close so fast."""
        result, (models, datas) = self._new_result(), self._cones[len(closing)]
        operator = pin.DelassusOperatorDense(delassus)
        arguments = (operator, closing.ravel(), models, datas, self._options, result)
        self._solver.solve(*arguments)
        self.iterations = int(result.iterations)
        impulses: Floats = np.array(result.retrieveConstraintImpulses()).reshape(-1, 3)
        return impulses

    def _drag(self) -> Floats:
        """Return force and moment of the damping about the can's centre, in the body's axes."""
        damping, inertia = self._scene.effects.damping, self.model.inertias[1]
        if damping is None:
            return np.zeros(6)
        velocity, spin = self.v.reshape(2, 3)
        force = -damping.linear * inertia.mass * (velocity + np.cross(spin, inertia.lever))
        moment = -damping.angular * inertia.inertia @ spin + np.cross(inertia.lever, force)
        return np.concatenate((force, moment))

    def _placed(self) -> Any:  # noqa: ANN401 - coal has no types
        frame = pin.XYZQUATToSE3(self.q)
        return coal.Transform3s(frame.rotation, frame.translation)
