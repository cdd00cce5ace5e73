"""The scene as SDF, for Gazebo and Drake: a pure function from a scene to the text of its world.

The world has gravity, the ground as a true plane, and the can where it is released: the frame of
its link has the centre of the can at its origin and z along the symmetry axis. SDF has no words for
how fast a model is let go, for the shaking of the plane, and for a damping of each degree of
freedom by itself: comments name what the program that steps the world has to apply.
"""

import xml.etree.ElementTree as ET
from collections.abc import Iterator

from models.effects import NO_SLIP_FRICTION, Effects
from models.gravity import gravity_vector
from models.mass import body
from models.mjcf_contact import numbers
from models.rim import released
from models.scene import Scene

VERSION = "1.9"
"""Of the format: the first in which a pose may be a quaternion."""


def sdf(scene: Scene) -> str:
    """Return the scene as SDF.

    Parameters
    ----------
    scene : Scene

    Returns
    -------
    str
        A world named after the scene with the models `ground` and `can`.
    """
    root = ET.Element("sdf", version=VERSION)
    for sentence in _beyond_sdf(scene):
        root.append(ET.Comment(f" {sentence} "))
    world = ET.SubElement(root, "world", name=scene.name)
    _text(world, "gravity", numbers(*gravity_vector(scene).tolist()))
    ground = ET.SubElement(world, "model", name="ground")
    _text(ground, "static", "true")
    plane = ET.SubElement(ET.SubElement(ground, "link", name="ground"), "collision", name="ground")
    shape = ET.SubElement(ET.SubElement(plane, "geometry"), "plane")
    _text(shape, "normal", "0 0 1")
    _surface(plane, scene.effects)
    can = ET.SubElement(world, "model", name="can")
    pose, _ = released(scene)
    w, x, y, z = pose.quaternion.tolist()
    _pose(can, (*pose.position.tolist(), x, y, z, w))
    link = ET.SubElement(can, "link", name="can")
    _inertial(link, scene)
    for role in ("collision", "visual"):
        own = ET.SubElement(link, role, name="can")
        cylinder = ET.SubElement(ET.SubElement(own, "geometry"), "cylinder")
        _text(cylinder, "radius", repr(scene.can.radius))
        _text(cylinder, "length", repr(2.0 * scene.can.half_height))
        if role == "collision":
            _surface(own, scene.effects)
    ET.indent(root)
    return f'<?xml version="1.0"?>\n{ET.tostring(root, encoding="unicode")}\n'


def _inertial(link: ET.Element, scene: Scene) -> None:
    """Add mass, centre of mass and moments, in the axes of the can."""
    rigid = body(scene)
    inertial = ET.SubElement(link, "inertial")
    _pose(inertial, (*rigid.centre.tolist(), 0.0, 0.0, 0.0, 1.0))
    _text(inertial, "mass", repr(rigid.mass))
    inertia = ET.SubElement(inertial, "inertia")
    for row, first in enumerate("xyz"):
        for column, second in enumerate("xyz"[row:], start=row):
            _text(inertia, f"i{first}{second}", repr(float(rigid.inertia[row, column])))


def _surface(collision: ET.Element, effects: Effects) -> None:
    """Add the constants of the contact, those of declared effects and no others."""
    surface = ET.SubElement(collision, "surface")
    friction = ET.SubElement(surface, "friction")
    mu = repr(NO_SLIP_FRICTION if effects.slip is None else effects.slip.mu)
    for engine, names in (("ode", ("mu", "mu2")), ("bullet", ("friction", "friction2"))):
        own = ET.SubElement(friction, engine)
        for name in names:
            _text(own, name, mu)
    if effects.restitution is not None:
        bounce = ET.SubElement(surface, "bounce")
        _text(bounce, "restitution_coefficient", repr(effects.restitution.coefficient))
        _text(bounce, "threshold", "0")


def _pose(owner: ET.Element, values: tuple[float, ...]) -> None:
    """Add a pose: position and quaternion, scalar last."""
    pose = ET.SubElement(owner, "pose", rotation_format="quat_xyzw")
    pose.text = numbers(*values)


def _text(owner: ET.Element, name: str, text: str) -> None:
    ET.SubElement(owner, name).text = text


_SAID = frozenset({"slip", "restitution", "tilt", "point_mass"})
"""Effects that the file has."""


def _beyond_sdf(scene: Scene) -> Iterator[str]:
    """Yield what the file of a scene cannot say, in sentences."""
    _, twist = released(scene)
    velocity, spin = (numbers(*each.tolist()) for each in (twist.velocity, twist.angular_velocity))
    yield f"At the release the velocity of the can's centre is ({velocity}) m/s in the world."
    yield f"At the release its angular velocity is ({spin}) rad/s in the world."
    for effect in scene.effects.declared():
        if effect not in _SAID:
            declared = getattr(scene.effects, effect)
            yield f"The effect is not in this file, and is to be applied: {declared!r}."
