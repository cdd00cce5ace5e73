"""The can on its ground as a plant of Drake: built, placed and read back.

The can is a free body whose frame is the can's, whatever its centre of mass. Its state is 13
numbers: quaternion (scalar first) and position, angular velocity and velocity, in world
coordinates. The plants of a can that differ in their timestep alone have that state in common.
"""

import logging
import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from pydrake.common.value import Value as AbstractValue
from pydrake.geometry import (
    AddCompliantHydroelasticProperties,
    AddContactMaterial,
    AddRigidHydroelasticProperties,
    Box,
    Cylinder,
    HalfSpace,
    ProximityProperties,
)
from pydrake.math import RigidTransform
from pydrake.multibody.math import SpatialForce
from pydrake.multibody.plant import (
    AddMultibodyPlant,
    CoulombFriction,
    ExternallyAppliedSpatialForce,
    MultibodyPlantConfig,
)
from pydrake.multibody.tree import RotationalInertia, SpatialInertia
from pydrake.systems.framework import DiagramBuilder

from harness.engines import (
    Collision,
    Contact,
    Floats,
    Value,
    contact_of,
    declared_friction,
    mesh_points,
)
from harness.engines.drake.settings import hydroelastic_mesh, side_of
from models import Pose, Scene, Twist
from models.gravity import gravity_vector
from models.mass import body as body_of

logging.getLogger("drake").setLevel(logging.ERROR)
"""Of a half-space it warns that it has no part in contacts of deformable bodies."""

_PRESSED = 2e-3
"""Of the radius: how much deeper the can is pressed in until a contact is found; more than the
height at which a collider is measured, so that once is enough there."""

_Pushes = list[ExternallyAppliedSpatialForce]


class CanPlant:
    """A plant of Drake with one can, one ground and nothing else.

    Parameters
    ----------
    scene : Scene
    config : dict
        Fields of `MultibodyPlantConfig`.
    material : mapping of str to Value
        Of each of the two geometries: the stiffness of the pair is half of `point_stiffness`, its
        dissipation the mean, its relaxation time twice `relaxation_time`.
    ground : str
        "HalfSpace" or "Box".
    compliant : mapping of str to Value, optional
        `hydroelastic_modulus` (Pa) and `resolution_hint` (m) of the can, which then touches by a
        surface, and the ground is rigid; else it touches at points.
    pushed : bool
        Whether a force is to be applied to the can in each step.
    """

    def __init__(
        self,
        scene: Scene,
        config: Mapping[str, Value],
        material: Mapping[str, Value],
        ground: str,
        *,
        compliant: Mapping[str, Value] | None = None,
        pushed: bool = False,
    ) -> None:
        builder, solid = DiagramBuilder(), body_of(scene)
        self.plant, _ = AddMultibodyPlant(
            MultibodyPlantConfig(
                contact_model="point" if compliant is None else "hydroelastic",
                # else contacts are those of the last step that a simulator took
                use_sampled_output_ports=False,
                **config,
            ),
            builder,
        )
        moments = solid.inertia[(0, 1, 2, 0, 0, 1), (0, 1, 2, 1, 2, 2)]
        inertia = SpatialInertia.MakeFromCentralInertia(
            solid.mass, solid.centre, RotationalInertia(*moments)
        )
        self.can = self.plant.AddRigidBody("can", inertia)
        side = side_of(scene.can)
        self.ground_half_width = side / 2.0 if ground == "Box" else math.inf
        shapes = {
            "HalfSpace": (HalfSpace(), RigidTransform()),
            "Box": (Box(side, side, side), RigidTransform([0.0, 0.0, -side / 2.0])),
        }
        cylinder = Cylinder(scene.can.radius, 2.0 * scene.can.half_height)
        world, friction = self.plant.world_body(), declared_friction(scene)
        for body, (shape, place), name in (
            (self.can, (cylinder, RigidTransform()), "can"),
            (world, shapes[ground], "ground"),
        ):
            properties = ProximityProperties()
            AddContactMaterial(
                dissipation=material["hunt_crossley_dissipation"],
                point_stiffness=material["point_stiffness"],
                friction=CoulombFriction(friction, friction),
                properties=properties,
            )
            if "relaxation_time" in material:
                relaxation = material["relaxation_time"]
                properties.AddProperty("material", "relaxation_time", relaxation)
            if compliant is not None and body is world:
                AddRigidHydroelasticProperties(properties)
            elif compliant is not None:
                hint, modulus = compliant["resolution_hint"], compliant["hydroelastic_modulus"]
                AddCompliantHydroelasticProperties(hint, modulus, properties)
            self.plant.RegisterCollisionGeometry(body, place, shape, name, properties)
        self.plant.mutable_gravity_field().set_gravity_vector(gravity_vector(scene))
        self.plant.Finalize()
        if pushed:
            builder.ExportInput(self.plant.get_applied_spatial_force_input_port(), "push")
        self.diagram = builder.Build()
        self.root = self.diagram.CreateDefaultContext()
        self.context = self.plant.GetMyMutableContextFromRoot(self.root)
        self._representation = self.plant.get_contact_surface_representation()
        self._query = self.plant.get_geometry_query_input_port()
        self._contacts = self.plant.get_contact_results_output_port()
        self._deepest, self._by_surfaces = scene.can.radius, compliant is not None
        if compliant is not None:
            self._corners = mesh_points(hydroelastic_mesh(scene.can, compliant), scene.can)
        if pushed:
            self.push(np.zeros(3), np.zeros(3), solid.centre)

    def state(self) -> Floats:
        """Return the state, shape (13,)."""
        state: Floats = self.plant.GetPositionsAndVelocities(self.context)
        return state

    def set_state(self, state: Floats) -> None:
        """Take over a state, shape (13,)."""
        self.plant.SetPositionsAndVelocities(self.context, state)

    def push(self, force: Floats, torque: Floats, point: Floats) -> None:
        """Apply a force (N) and a torque (N m), in world coordinates, until others come.

        Parameters
        ----------
        force, torque : ndarray, shape (3,)
        point : ndarray, shape (3,)
            Of the body at which the force acts, in its own axes, m.
        """
        push = ExternallyAppliedSpatialForce()
        push.body_index, push.p_BoBq_B = self.can.index(), point
        push.F_Bq_W = SpatialForce(torque, force)
        self.diagram.get_input_port().FixValue(self.root, AbstractValue[_Pushes]([push]))

    def contact(self) -> Contact:
        """Return the contact that is solved at this state."""
        results: Any = self._contacts.Eval(self.context)
        if self._by_surfaces:
            return self._contact_by_surfaces(results)
        force, moment, total, bearing, depth = np.zeros(3), np.zeros(3), 0.0, 0, -math.inf
        for index in range(results.num_point_pair_contacts()):
            info = results.point_pair_contact_info(index)
            depth = max(depth, info.point_pair().depth)
            # that on one body of the pair, which is the can or the ground
            own = info.contact_force()
            own = own if own[2] >= 0.0 else -own
            if own[2] > 0.0:
                force, moment = force + own, moment + own[2] * info.contact_point()
                total, bearing = total + own[2], bearing + 1
        return Contact(
            point=moment / total if bearing else np.full(3, np.nan),
            force=force,
            penetration=depth if depth > -math.inf else math.nan,
            count=bearing,
        )

    def _contact_by_surfaces(self, results: Any) -> Contact:  # noqa: ANN401 - as in `_penetration`
        """Return the pressure on a surface as its resultant, at the centre of pressure.

        A surface has no depth: it is that of the cylinder which the mesh stands for.
        """
        forces, centres = [], []
        for index in range(results.num_hydroelastic_contacts()):
            info = results.hydroelastic_contact_info(index)
            own, moment = info.F_Ac_W().translational(), info.F_Ac_W().rotational()
            own, moment = (own, moment) if own[2] >= 0.0 else (-own, -moment)
            if own[2] > 0.0:
                forces.append(own)
                away = np.array((-moment[1], moment[0], 0.0)) / own[2]
                centres.append(info.contact_surface().centroid() + away)
        depth = max((pair.depth for pair in self._penetration()), default=math.nan)
        return contact_of(np.array(centres).reshape(-1, 3), np.array(forces).reshape(-1, 3), depth)

    def collision(self) -> Collision:
        """Return the overlapping points, from the middle between the two surfaces.

        A surface of hydroelastic contact is told by its centroid and its mean normal.
        """
        if self._by_surfaces:
            query, representation = self._query.Eval(self.context), self._representation
            surfaces = query.ComputeContactSurfaces(representation)
            return Collision(
                points=np.array([each.centroid() for each in surfaces]).reshape(-1, 3),
                normals=np.array([_mean_normal(each) for each in surfaces]).reshape(-1, 3),
                depths=np.full(len(surfaces), math.nan),
            )
        pairs = self._penetration()
        normals = np.array([pair.nhat_BA_W for pair in pairs]).reshape(-1, 3)
        middles = [(pair.p_WCa + pair.p_WCb) / 2.0 for pair in pairs]
        return Collision(
            points=np.array(middles).reshape(-1, 3),
            normals=normals * np.copysign(1.0, normals[:, 2:]),
            depths=np.array([pair.depth for pair in pairs]),
        )

    def lowest(self) -> tuple[float, Floats]:
        """Return the signed distance of the can to the ground, m, and where it is nearest, (3,).

        Drake has none of a cylinder to a half-space, but the depth of what overlaps: a can aloft is
        pressed down until it overlaps, and lifted again; none within reach is infinitely far. A
        surface of contact is that of a prism, which has corners.
        """
        if self._by_surfaces:
            turned = self.plant.EvalBodyPoseInWorld(self.context, self.can)
            corners: Floats = turned.multiply(self._corners.T).T
            lowest = corners[np.argmin(corners[:, 2])]
            return float(lowest[2]), lowest
        kept, pressed = self.state(), 0.0
        sunk = kept.copy()
        while not (pairs := self._penetration()) and pressed < self._deepest:
            pressed += _PRESSED * self._deepest
            sunk[6] = kept[6] - pressed
            self.set_state(sunk)
        self.set_state(kept)
        if not pairs:
            return math.inf, np.full(3, math.nan)
        deepest = max(pairs, key=lambda pair: pair.depth)
        point: Floats = (deepest.p_WCa + deepest.p_WCb) / 2.0
        point[2] += pressed / 2.0  # on the ground's side nothing was pressed
        return pressed - deepest.depth, point

    def _penetration(self) -> Any:  # noqa: ANN401 - types are the same without the package
        """Return the overlapping pairs of geometries."""
        return self._query.Eval(self.context).ComputePointPairPenetration()


def _mean_normal(surface: Any) -> Floats:  # noqa: ANN401 - as in `_penetration`
    """Return the mean upward normal of a surface of contact, shape (3,); NaN without an area."""
    faces = range(surface.num_faces())
    total = sum((surface.area(f) * surface.face_normal(f) for f in faces), np.zeros(3))
    length = math.copysign(math.hypot(*total.tolist()), total[2])
    normal: Floats = total / length if length else np.full(3, math.nan)
    return normal


class PlantWorld:
    """What the worlds of this folder have in common: the can is read from the plant in force."""

    of: CanPlant

    @property
    def ground_half_width(self) -> float:
        """How far the ground goes from the origin, m."""
        return self.of.ground_half_width

    @property
    def mass(self) -> float:
        """Mass of the can with all that is fixed to it, kg."""
        return float(self.of.can.get_mass(self.of.context))

    @property
    def centre_of_mass(self) -> Floats:
        """From the centre of the can in the body's axes, shape (3,), m."""
        centre: Floats = self.of.can.CalcCenterOfMassInBodyFrame(self.of.context)
        return centre

    @property
    def inertia_tensor(self) -> Floats:
        """About the centre of mass in the body's axes, shape (3, 3), kg m^2."""
        inertia = self.of.can.CalcSpatialInertiaInBodyFrame(self.of.context)
        central = inertia.Shift(inertia.get_com()).CalcRotationalInertia()
        tensor: Floats = central.CopyToFullMatrix3()
        return tensor

    @property
    def inertia(self) -> Floats:
        """Moments about the body's axes through the centre of mass, shape (3,), kg m^2."""
        moments: Floats = np.diagonal(self.inertia_tensor).copy()
        return moments

    def pose(self) -> Pose:
        """Return where the can is."""
        state = self.of.state()
        return Pose(position=state[4:7], quaternion=unit(state[:4]))

    def twist(self) -> Twist:
        """Return how the can moves."""
        state = self.of.state()
        return Twist(velocity=state[10:], angular_velocity=state[7:10])

    def collision(self) -> Collision:
        """Return the contact points where the can is, without a step."""
        return self.of.collision()

    def signed_distance(self) -> float:
        """Return the signed distance from the collider of the can to the ground, m."""
        return self.of.lowest()[0]


def state_of(pose: Pose, twist: Twist) -> Floats:
    """Return the state of a pose and a motion, shape (13,)."""
    return np.concatenate((pose.quaternion, pose.position, twist.angular_velocity, twist.velocity))


def unit(quaternion: Floats) -> Floats:
    """Return a quaternion, shape (4,), at unit length, at which Drake does not keep it."""
    length = math.hypot(*quaternion.tolist())  # a norm of squares overflows
    with np.errstate(invalid="ignore"):  # numbers that break are an outcome
        scaled: Floats = quaternion / length
    return scaled
