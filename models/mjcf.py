"""The scene as a MuJoCo model: a pure function from a scene to MJCF text.

The model says what the scene says and no more; how the engine is to solve it (integrator, cone,
solref, ...) is handed in by whoever runs it. MuJoCo meets a cylinder and a plane analytically, so
the ground is a plane. The body frame has the centre of the can at its origin and z along the
symmetry axis; a point mass moves the centre of mass, not the frame. What MJCF has no word for, the
shaking of the plane, is said in a comment and applied by whoever steps the model.
"""

import xml.etree.ElementTree as ET
from collections.abc import Iterator, Mapping
from types import MappingProxyType

from models.effects import NO_SLIP_FRICTION, Effects
from models.gravity import gravity_vector
from models.kinematics import to_body
from models.mass import body as rigid_body
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

    Returns
    -------
    str
        A model with body, free joint and geom `can`, geom `ground`, and a keyframe `release` that
        holds the release velocity as well.
    """
    can = scene.can
    pose, twist = release_state(can, scene.release)
    root = ET.Element("mujoco", model=scene.name)
    for sentence in _beyond_mjcf(scene.effects):
        root.append(ET.Comment(f" {sentence} "))
    gravity = numbers(*gravity_vector(scene).tolist())
    options = ET.SubElement(root, "option", {"gravity": gravity} | dict(option))
    if flag:
        ET.SubElement(options, "flag", dict(flag))

    world = ET.SubElement(root, "worldbody")
    surface = _surface(scene.effects) | dict(geom)
    ET.SubElement(world, "geom", {"name": "ground", "type": "plane", "size": "0 0 1"} | surface)
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
    ET.SubElement(body, "geom", {"name": "can", "type": "cylinder", "size": size} | surface)

    if contact_sensors:
        _add_sensors(root)
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


def numbers(*values: float) -> str:
    """Return numbers as an attribute, each to its last digit."""
    return " ".join(repr(float(value)) for value in values)


def contact_dimension(effects: Effects) -> int:
    """Return MuJoCo's `condim`: 1 normal, 3 friction, 4 drilling too, 6 rolling resistance too."""
    if effects.slip is not None and effects.slip.mu == 0.0:
        return 1
    if effects.rolling_resistance is not None:
        return 6
    return 3 if effects.drilling is None else 4


def _surface(effects: Effects) -> dict[str, str]:
    """Return the attributes of both geoms; lengths of effects that are off have no part in it."""
    slip, drilling, rolling = effects.slip, effects.drilling, effects.rolling_resistance
    mu = NO_SLIP_FRICTION if slip is None else slip.mu
    condim = contact_dimension(effects)
    # MuJoCo's own where the contact has no such row; a row that is only a neighbour's gets none
    torsion, roll = (0.0, 0.0) if condim > 3 else (0.005, 0.0001)  # noqa: PLR2004 - a condim
    torsion = torsion if drilling is None else drilling.length
    roll = roll if rolling is None else rolling.length
    return {"friction": numbers(mu, torsion, roll), "condim": str(condim)}


def _inertial(scene: Scene) -> dict[str, str]:
    """Return the attributes of `inertial`: the can's, or of the can and its point mass."""
    can, whole = scene.can, rigid_body(scene)
    if scene.effects.point_mass is None:
        A, C = can.transverse_inertia, can.axial_inertia
        return {"pos": "0 0 0", "mass": numbers(can.mass), "diaginertia": numbers(A, A, C)}
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = whole.inertia.tolist()
    return {
        "pos": numbers(*whole.centre.tolist()),
        "mass": numbers(whole.mass),
        "fullinertia": numbers(xx, yy, zz, xy, xz, yz),
    }


def _beyond_mjcf(effects: Effects) -> Iterator[str]:
    """Yield what a file cannot say, in sentences."""
    shake = effects.shake
    if shake is not None:
        yield (
            f"The plane is shaken at {shake.frequency!r} Hz, by {shake.horizontal!r} m along "
            f"the direction {shake.direction!r} rad and {shake.vertical!r} m vertically, phase "
            f"{shake.phase!r} rad: the harness applies it, as a force on the centre of mass."
        )


def _add_sensors(root: ET.Element) -> None:
    sensors = ET.SubElement(root, "sensor")
    for name, reduce, data in (
        (NET_SENSOR, "netforce", "found force pos"),
        (DEPTH_SENSOR, "mindist", "dist"),
    ):
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
