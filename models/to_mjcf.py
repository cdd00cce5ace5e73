"""The scene as a MuJoCo model: a pure function from a scene to MJCF text.

The model holds the scene and nothing else; settings of the solver (integrator, cone, solref, ...)
are arguments. MuJoCo meets a cylinder and a plane analytically, so
the ground is a plane. The body frame has the centre of the can at its origin and z along the
symmetry axis; a point mass moves the centre of mass, not the frame. MJCF has no element for the
shaking of the plane, nor for damping of each degree of freedom by itself: a comment names them, and
the program that steps the model applies them. `models.mjcf_contact` has the effects at the contact.
"""

import xml.etree.ElementTree as ET
from collections.abc import Iterator, Mapping
from types import MappingProxyType

from models.gravity import gravity_vector
from models.kinematics import to_body
from models.mass import body as rigid_body
from models.mjcf_contact import SHIPPED_TIMESTEP, cone, contact_rows, numbers, pair, surface
from models.rim import release_state
from models.scene import Scene

_NOTHING: Mapping[str, str] = MappingProxyType({})

NET_SENSOR = "net_contact"
"""Name of the sensor of the resultant of all contacts, 7 numbers, all zero without a contact:

====== ======= =================================================================================
0      found   number of contacts
1:4    force   of the plane on the can, N, in the world: MuJoCo's frame for a resultant is the
               world, not that of a contact; N is its last component
4:7    pos     mean of the contacts, weighted by the size of their forces: the contact locus, m
====== ======= =================================================================================

The sensors belong to the state before the step, as everything in `mjData` but `qpos` and `qvel`.
"""

DEPTH_SENSOR = "deepest_contact"
"""Name of the sensor of the deepest contact, 1 number: the gap, m, negative in penetration; zero
also when there is no contact at all, which `NET_SENSOR` tells."""


def mjcf(
    scene: Scene,
    *,
    option: Mapping[str, str] = _NOTHING,
    flag: Mapping[str, str] = _NOTHING,
    geom: Mapping[str, str] = _NOTHING,
    contact_sensors: bool = False,
    filled_sensors: bool = False,
    every_sensor: bool = False,
    spring_timestep: float | None = None,
) -> str:
    """Return the scene as MJCF.

    Parameters
    ----------
    scene : Scene
    option, flag : mapping of str to str
        Attributes of `option` and of `option/flag`, by MuJoCo's names.
    geom : mapping of str to str
        Attributes of both geoms, such as `solref`; MuJoCo combines the two of a contact, so both
        get the same.
    contact_sensors : bool
        Add the sensors `NET_SENSOR` and `DEPTH_SENSOR`, in this order.
    filled_sensors : bool
        Have these sensors filled by the program that steps the model: for a version of MuJoCo that
        has no sensors of contacts.
    every_sensor : bool
        After them add all that MuJoCo can tell of a body and of the energy, to see what it costs.
    spring_timestep : float, optional
        s; where given, the contact of `geom` has a law of its own, with friction for this timestep:
        see `models.mjcf_contact`. A scene with compliance or restitution has such a contact anyway.

    Returns
    -------
    str
        A model with body, free joint and geom `can`, geom `ground`, and a keyframe `release` that
        holds the release velocity as well.
    """
    can = scene.can
    pose, twist = release_state(can, scene.release)
    root = ET.Element("mujoco", model=scene.name)
    for sentence in _beyond_mjcf(scene):
        root.append(ET.Comment(f" {sentence} "))
    gravity = numbers(*gravity_vector(scene).tolist())
    said = {"gravity": gravity} | cone(scene) | dict(option)
    options = ET.SubElement(root, "option", said)
    if flag:
        ET.SubElement(options, "flag", dict(flag))

    world = ET.SubElement(root, "worldbody")
    material = surface(scene, spring_timestep) | dict(geom)
    ET.SubElement(world, "geom", {"name": "ground", "type": "plane", "size": "0 0 1"} | material)
    body = ET.SubElement(
        world,
        "body",
        name="can",
        pos=numbers(*pose.position),
        quat=numbers(*pose.quaternion),
    )
    ET.SubElement(body, "freejoint", name="can")
    ET.SubElement(body, "inertial", _inertial(scene))
    size = numbers(can.radius, can.half_height)
    ET.SubElement(body, "geom", {"name": "can", "type": "cylinder", "size": size} | material)

    rows = contact_rows(scene, spring_timestep)
    if rows is not None:
        contact = ET.SubElement(root, "contact")
        ET.SubElement(contact, "pair", pair(material, rows))
    if contact_sensors:
        _add_sensors(root, filled=filled_sensors, every=every_sensor)
    keyframe = ET.SubElement(root, "keyframe")
    ET.SubElement(
        keyframe,
        "key",
        name="release",
        qpos=numbers(*pose.position, *pose.quaternion),
        qvel=numbers(*twist.velocity, *to_body(pose.quaternion, twist.angular_velocity)),
    )
    ET.indent(root)
    return ET.tostring(root, encoding="unicode") + "\n"


def _inertial(scene: Scene) -> dict[str, str]:
    """Return the attributes of `inertial`: the can's, or of the can and its point mass."""
    can, rigid = scene.can, rigid_body(scene)
    if scene.effects.point_mass is None:
        A, C = can.transverse_inertia, can.axial_inertia
        return {"pos": "0 0 0", "mass": numbers(can.mass), "diaginertia": numbers(A, A, C)}
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = rigid.inertia.tolist()
    return {
        "pos": numbers(*rigid.centre.tolist()),
        "mass": numbers(rigid.mass),
        "fullinertia": numbers(xx, yy, zz, xy, xz, yz),
    }


def dof_damping(scene: Scene) -> tuple[float, ...] | None:
    """Return MuJoCo's `dof_damping` of the free joint, N s/m and N m s, or None without damping.

    Its six degrees of freedom are the velocity of the can's centre in the world and the angular
    velocity in the body, so that -m linear v and -angular I omega are each a number times the
    velocity of a degree of freedom: the law to the letter.
    """
    can, damping = scene.can, scene.effects.damping
    if damping is None:
        return None
    A, C = can.transverse_inertia, can.axial_inertia
    across, along = damping.angular * A, damping.angular * C
    return (*(damping.linear * can.mass,) * 3, across, across, along)


def _beyond_mjcf(scene: Scene) -> Iterator[str]:
    """Yield a sentence for each part of a scene that MJCF cannot express."""
    shake, damping = scene.effects.shake, dof_damping(scene)
    if shake is not None:
        yield (
            f"The plane is shaken at {shake.frequency!r} Hz, by {shake.horizontal!r} m along "
            f"the direction {shake.direction!r} rad and {shake.vertical!r} m vertically, phase "
            f"{shake.phase!r} rad: the harness applies it, as a force on the centre of mass."
        )
    if damping is not None:
        yield f"Motion is damped: the harness sets dof_damping to {numbers(*damping)}."
    if scene.effects.rim is not None:
        yield "The effect rim is left out: MuJoCo has no rounded cylinder."
    rebound = scene.effects.restitution
    if rebound is not None:
        yield (
            f"The contact gives back {rebound.coefficient!r} of an impact at a timestep of "
            f"{SHIPPED_TIMESTEP!r} s: solref and solreffriction are tied to it."
        )


_OF_A_BODY = (
    *("framepos", "framequat", "framexaxis", "framelinvel", "frameangvel"),
    *("framelinacc", "frameangacc"),
)
_OF_ALL_BELOW = ("subtreecom", "subtreelinvel", "subtreeangmom")


def _add_sensors(root: ET.Element, *, filled: bool, every: bool) -> None:
    sensors = ET.SubElement(root, "sensor")
    for name, reduce, data, size in (
        (NET_SENSOR, "netforce", "found force pos", 7),
        (DEPTH_SENSOR, "mindist", "dist", 1),
    ):
        if filled:
            ET.SubElement(sensors, "user", name=name, dim=str(size), needstage="acc")
            continue
        ET.SubElement(
            sensors,
            "contact",
            name=name,
            geom1="ground",
            geom2="can",
            num="1",
            reduce=reduce,
            data=data,
        )
    if every:
        for kind in _OF_A_BODY:
            ET.SubElement(sensors, kind, name=kind, objtype="body", objname="can")
        for kind in _OF_ALL_BELOW:
            ET.SubElement(sensors, kind, name=kind, body="can")
        for kind in ("e_potential", "e_kinetic"):
            ET.SubElement(sensors, kind, name=kind)
