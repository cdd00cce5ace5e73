"""Drake's settings that matter to a rolling can, what it ships with, and what `matched` takes.

As shipped the contact is a spring of 5e5 N/m with the friction of the last step's normal force, and
the ground of a model file is a half-space. `matched` takes the convex problem SAP with a contact as
stiff as it lets it be: near rigid, it yields in a timestep, and dissipates in as long. A relaxation
time of zero, or a lower `sap_near_rigid_threshold`, makes contacts chatter. The ground is a box,
for on a half-space the contact of a can that is nearly flat jumps to the middle of its base.

SAP trades the complementarity of a contact for convexity: what slides is lifted until it slides
mu (dt + relaxation time) times its speed above the ground. Where a scene declares slip the can
slides, and `matched` takes `similar`, which does not lift, and a stiffness at which the can sinks
by a ten thousandth of its radius. What is springy takes SAP, whose spring and damper are linear.

A setting has the name of the field of `MultibodyPlantConfig`, or of the property in the group
`material` of a geometry, of which the can and the ground have the same. `ground` is the shape.

Hydroelastic contact is a pressure over the surface in which a compliant can, a mesh, meets a rigid
ground: `compliance_type` is the can's. As shipped no geometry has one, and the contact is a point.
Distances are those of the mesh; a surface has no depth, and the cylinder's is told.

The differences between Drake as shipped and matched are in the order in which they are removed: the
geometry of the contact, its law, the timestep last.
"""

import math
from collections.abc import Mapping

from harness.engines import (
    COMMON,
    ETA_SETTING,
    TIMESTEP,
    Case,
    InvalidSettingError,
    Mesh,
    ModelDifference,
    Setting,
    Value,
    Variant,
    declared_friction,
    prism,
)
from models import Can, Scene

DEFAULT_TIMESTEP = 1e-3
MATCHED_TIMESTEP = 1e-4

_SIDE = 1000.0
"""Side of the box over the size of the can: what a can reaches, in seconds of rolling."""


def side_of(can: Can) -> float:
    """Return the side of the box that is the ground of a can, m."""
    return _SIDE * can.bounding_radius


RIGID = 1e15
"""N/m: beyond what SAP lets through for any can of up to some tons."""

OF_THE_PLANT = (
    "discrete_contact_approximation",
    "sap_near_rigid_threshold",
    "stiction_tolerance",
)
OF_A_GEOMETRY = ("point_stiffness", "hunt_crossley_dissipation", "relaxation_time")

GROUND = Setting(
    "ground",
    "HalfSpace",
    "Box",
    "Shape of the ground; on a half-space a can that is nearly flat touches in its middle.",
    choices=("HalfSpace", "Box"),
)
COMPLIANT = "compliant"
HYDROELASTIC = (
    Setting.as_shipped(
        "compliance_type",
        "undefined",
        "Of the can: `compliant` is hydroelastic contact, by a surface, with a rigid ground.",
        choices=("undefined", COMPLIANT),
    ),
    Setting.as_shipped(
        "hydroelastic_modulus",
        1e7,
        "Pressure of hydroelastic contact at the axis of the can, Pa; none at its surface.",
        positive=True,
    ),
    Setting.as_shipped(
        "resolution_hint",
        0.02,
        "Longest side of the polygon that is the can in hydroelastic contact, m.",
        positive=True,
    ),
)
STICTION = Setting.as_shipped(
    "stiction_tolerance",
    1e-4,
    "Slip speed from which friction is nearly all there is, m/s; SAP has a law of its own.",
    positive=True,
)

SETTINGS = (
    Setting(
        "discrete_contact_approximation",
        "lagged",
        "sap",
        "Problem that is solved in a step; `lagged` takes friction from the load of the last one.",
        choices=("sap", "similar", "lagged"),
    ),
    Setting.as_shipped(
        "sap_near_rigid_threshold",
        1.0,
        "Shortest time in which a contact of SAP yields, over the timestep and 2 pi.",
    ),
    STICTION,
    Setting(
        "point_stiffness",
        1e6,
        RIGID,
        "Stiffness of each geometry, N/m; that of the contact is half of it.",
        positive=True,
    ),
    Setting(
        "hunt_crossley_dissipation",
        50.0,
        0.0,
        "Damping over the spring's force, s/m; SAP has its relaxation time instead.",
    ),
    Setting(
        "relaxation_time",
        0.1,
        lambda timestep: timestep,
        "Damping over stiffness of each geometry under SAP, s; that of the contact is twice it.",
    ),
    GROUND,
    *HYDROELASTIC,
    ETA_SETTING,
)


def is_hydroelastic(chosen: Mapping[str, Value]) -> bool:
    """Whether the can touches by a surface; of an engine without the setting, by a point."""
    return chosen.get("compliance_type") == COMPLIANT


_LEAST_HINT = 1e-3
"""Of the radius: what is finer takes Drake minutes to make."""


def hydroelastic_mesh(can: Can, chosen: Mapping[str, Value]) -> Mesh:
    """Return the prism that Drake makes of a can for its surfaces of contact.

    Raises
    ------
    InvalidSettingError
        If its sides would be too short to be made.
    """
    hint = float(chosen["resolution_hint"])  # type: ignore[arg-type] # a number, as it was checked
    least = _LEAST_HINT * can.radius
    if hint < least:
        raise InvalidSettingError("resolution_hint", hint, f"{least:.3g} m or more, for this can")
    return prism(max(3, math.ceil(2.0 * math.pi * can.radius / hint)))


_SUNK = 1e-4
"""Of the radius: how deep a can at rest sinks where it is to slide."""


def sliding_stiffness(scene: Scene) -> float:
    """Return the stiffness of a geometry at which a can sinks by a ten thousandth of its radius."""
    weight = scene.can.mass * max(scene.gravity, 1.0)
    return 2.0 * weight / (_SUNK * scene.can.radius)


def for_effects(case: Case) -> Mapping[str, Value]:
    """Return the settings that the effects of a scene decide."""
    spring, scene = case.scene.effects.compliance, case.scene
    if spring is not None:
        return {
            "discrete_contact_approximation": "sap",
            "point_stiffness": 2.0 * spring.stiffness,
            "relaxation_time": 0.5 * spring.damping / spring.stiffness,
        }
    if scene.effects.slip is not None and case.profile != "default":
        return {
            "discrete_contact_approximation": "similar",
            "point_stiffness": sliding_stiffness(scene),
            "hunt_crossley_dissipation": 50.0,
        }
    return {}


_PASTE = """\
from pydrake.geometry import AddCompliantHydroelasticProperties, AddContactMaterial
from pydrake.geometry import AddRigidHydroelasticProperties, ProximityProperties
from pydrake.geometry import Box, Cylinder, HalfSpace
from pydrake.math import RigidTransform
from pydrake.multibody.plant import AddMultibodyPlant, CoulombFriction, MultibodyPlantConfig
from pydrake.systems.framework import DiagramBuilder

builder = DiagramBuilder()
config = MultibodyPlantConfig(contact_model={model!r}, {config})
plant, scene_graph = AddMultibodyPlant(config, builder)

def material():
    \"\"\"Return the contact properties of the can, and those of the ground.\"\"\"
    properties = ProximityProperties()
    AddContactMaterial(
        dissipation={dissipation!r},
        point_stiffness={stiffness!r},
        friction=CoulombFriction({mu!r}, {mu!r}),
        properties=properties,
    )
{relaxation}    return properties

{ground}
of_ground, of_can, world = material(), material(), plant.world_body()
{hydroelastic}plant.RegisterCollisionGeometry(world, place, ground, "ground", of_ground)
# of a body `can` whose frame is at its centre, the third axis along the can's:
# shape = Cylinder({radius!r}, {height!r})
# plant.RegisterCollisionGeometry(can, RigidTransform(), shape, "can", of_can)
"""

_HYDROELASTIC = """\
AddRigidHydroelasticProperties(of_ground)
AddCompliantHydroelasticProperties({resolution_hint!r}, {hydroelastic_modulus!r}, of_can)
"""

_GROUNDS = {
    "HalfSpace": "ground, place = HalfSpace(), RigidTransform()",
    "Box": "side = {side!r}\n"
    "ground, place = Box(side, side, side), RigidTransform([0.0, 0.0, -side / 2.0])",
}


def as_python(case: Case, chosen: Mapping[str, Value], config: Mapping[str, Value]) -> str:
    """Return settings as a program that builds a plant with the ground.

    Parameters
    ----------
    case : Case
    chosen : mapping of str to Value
        Every setting in force.
    config : mapping of str to Value
        Fields of `MultibodyPlantConfig`.
    """
    can = case.scene.can
    relaxation = ""
    if "relaxation_time" in chosen:
        time = chosen["relaxation_time"]
        relaxation = f'    properties.AddProperty("material", "relaxation_time", {time!r})\n'
    compliant = is_hydroelastic(chosen)
    return _PASTE.format(
        model="hydroelastic" if compliant else "point",
        hydroelastic=_HYDROELASTIC.format(**chosen) if compliant else "",
        config=", ".join(f"{name}={value!r}" for name, value in config.items()),
        dissipation=chosen["hunt_crossley_dissipation"],
        stiffness=chosen["point_stiffness"],
        mu=declared_friction(case.scene),
        relaxation=relaxation,
        ground=_GROUNDS[str(chosen["ground"])].format(side=side_of(can)),
        radius=can.radius,
        height=2.0 * can.half_height,
    )


SHIPPED_LAW = (
    ("point_stiffness", 1e6),
    ("hunt_crossley_dissipation", 50.0),
)

_HALF_SPACE = ("ground", "HalfSpace")
_SURFACE = ("compliance_type", COMPLIANT)

POINTS = (
    Variant(name="box of 60 m"),
    Variant(name="half-space", settings=(_HALF_SPACE,)),
)
COLLIDERS = (
    *POINTS,
    Variant(name="hydroelastic", settings=(_SURFACE,)),
    Variant(name="hydroelastic, half-space", settings=(_SURFACE, _HALF_SPACE)),
    Variant(name="hydroelastic, sides of 2 mm", settings=(_SURFACE, ("resolution_hint", 2e-3))),
)
"""Where the can touches at points, and by surfaces."""

VARIANTS = (
    *COMMON,
    Variant(
        name="similar",
        settings=(("discrete_contact_approximation", "similar"), *SHIPPED_LAW),
        imposes="a spring of 5e5 N/m",
    ),
    Variant(
        name="lagged",
        profile="default",  # which lets friction of another load pass
        settings=(("ground", "Box"),),
        imposes="a spring of 5e5 N/m, friction of the last step's load",
    ),
    Variant(
        name="half-space",
        settings=(("ground", "HalfSpace"),),
        imposes="a contact at the middle of the base below 4.5e-4 rad",
    ),
    Variant(
        name="spring as shipped",
        settings=(("point_stiffness", 1e6), ("relaxation_time", 0.1)),
        imposes="a spring of 5e5 N/m that relaxes in 0.2 s",
        thorough=True,
    ),
)

MODEL_DIFFERENCES = (
    ModelDifference(
        name="ground",
        settings=("ground",),
        sentence="On a half-space the contact of a nearly flat can is the middle of its base.",
    ),
    ModelDifference(
        name="contact law",
        settings=(
            "discrete_contact_approximation",
            "point_stiffness",
            "hunt_crossley_dissipation",
            "relaxation_time",
        ),
        sentence="The contact is a spring, and friction is bounded by the load of the last step.",
    ),
    ModelDifference(
        name="timestep",
        settings=(TIMESTEP,),
        sentence="Steps of 1 ms are long beside the bounce.",
    ),
)
