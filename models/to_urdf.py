"""The scene as URDF, for PyBullet: a pure function from a scene to the text of its can.

URDF has no world: where the can is released, gravity and the solver are the caller's business; the
ground is a true plane in a file of its own. The frame of the link has the centre of the can at its
origin and z along the symmetry axis; a point mass moves the frame of `inertial`, whose axes are
then the principal ones, since PyBullet finds those of a full tensor to six digits only.
"""

import math
import xml.etree.ElementTree as ET
from collections.abc import Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from models.effects import NO_SLIP_FRICTION, Effects
from models.gravity import gravity_vector
from models.mass import body
from models.mjcf_contact import numbers
from models.scene import Scene

GROUND_FRICTION = 1.0
"""Bullet multiplies the coefficients of a pair: with 1 on the ground the can's is the pair's."""

GROUND_RESTITUTION = 1.0
"""Multiplied likewise, and 0 for a can that declares none."""


def urdf(scene: Scene, mesh: str = "") -> str:
    """Return the can of a scene as URDF.

    Parameters
    ----------
    scene : Scene
    mesh : str
        Name of a file of a mesh in metres that stands for the cylinder; empty for none.

    Returns
    -------
    str
        A robot named after the scene with the one link `can`, its declared moments, and friction
        of the pair on its contact.
    """
    can = scene.can
    root, link = _robot(scene.name, "can", _contact(scene.effects))
    for number, sentence in enumerate(_beyond_urdf(scene)):
        root.insert(number, ET.Comment(f" {sentence} "))
    inertial = ET.SubElement(link, "inertial")
    rigid, origin = body(scene), {"xyz": "0 0 0", "rpy": "0 0 0"}
    moments, axes = rigid.principal()
    if scene.effects.point_mass is not None:
        origin = {"xyz": numbers(*rigid.centre.tolist()), "rpy": numbers(*_roll_pitch_yaw(axes))}
    ET.SubElement(inertial, "origin", origin)
    ET.SubElement(inertial, "mass", value=repr(rigid.mass))
    ixx, iyy, izz = map(repr, moments.tolist())
    ET.SubElement(inertial, "inertia", ixx=ixx, ixy="0", ixz="0", iyy=iyy, iyz="0", izz=izz)
    for role in ("visual", "collision"):
        shape = ET.SubElement(link, role, name="can")
        ET.SubElement(shape, "origin", xyz="0 0 0", rpy="0 0 0")
        geometry = ET.SubElement(shape, "geometry")
        if mesh:
            ET.SubElement(geometry, "mesh", filename=mesh)
            continue
        ET.SubElement(
            geometry,
            "cylinder",
            radius=repr(can.radius),
            length=repr(2.0 * can.half_height),
        )
    return _text(root)


def ground_urdf() -> str:
    """Return the ground as URDF: the plane z = 0, immovable, with friction `GROUND_FRICTION`."""
    contact = {"lateral_friction": GROUND_FRICTION, "restitution": GROUND_RESTITUTION}
    root, link = _robot("ground", "ground", contact)
    inertial = ET.SubElement(link, "inertial")
    ET.SubElement(inertial, "mass", value="0")  # Bullet's way to say that it never moves
    ET.SubElement(inertial, "inertia", ixx="0", ixy="0", ixz="0", iyy="0", iyz="0", izz="0")
    collision = ET.SubElement(link, "collision", name="ground")
    ET.SubElement(ET.SubElement(collision, "geometry"), "plane", normal="0 0 1")
    return _text(root)


def _roll_pitch_yaw(axes: NDArray[np.float64]) -> tuple[float, float, float]:
    """Return the angles of a rotation about fixed x, then y, then z, rad; pitch short of pi/2."""
    R = axes.tolist()
    return (
        math.atan2(R[2][1], R[2][2]),
        math.atan2(-R[2][0], math.hypot(R[2][1], R[2][2])),
        math.atan2(R[1][0], R[0][0]),
    )


def _contact(effects: Effects) -> dict[str, float]:
    """Return the constants of the can's contact, those of declared effects and no others."""
    slip, drilling, rolling = effects.slip, effects.drilling, effects.rolling_resistance
    constants = {"lateral_friction": NO_SLIP_FRICTION if slip is None else slip.mu}
    if drilling is not None:
        constants["spinning_friction"] = drilling.length
    if rolling is not None:
        constants["rolling_friction"] = rolling.length
    if effects.restitution is not None:
        constants["restitution"] = effects.restitution.coefficient
    if effects.compliance is not None:
        constants["stiffness"] = effects.compliance.stiffness
        constants["damping"] = effects.compliance.damping
    return constants


def _beyond_urdf(scene: Scene) -> Iterator[str]:
    """Yield what the file of a can cannot say, in sentences."""
    effects = scene.effects
    if effects.tilt is not None:
        x, y, z = gravity_vector(scene).tolist()
        yield f"The plane is tilted: setGravity({x!r}, {y!r}, {z!r})."
    shake, damping = effects.shake, effects.damping
    if shake is not None:
        yield (
            f"The plane is shaken at {shake.frequency!r} Hz, by {shake.horizontal!r} m along "
            f"the direction {shake.direction!r} rad and {shake.vertical!r} m vertically, phase "
            f"{shake.phase!r} rad: the harness applies it, as a gravity set before each step."
        )
    if damping is not None:
        linear, angular = -math.expm1(-damping.linear), -math.expm1(-damping.angular)
        yield (
            "Motion is damped: loadURDF(useMaximalCoordinates=True) and "
            f"changeDynamics(linearDamping={linear!r}, angularDamping={angular!r})."
        )
    if effects.rim is not None:
        yield (
            "The rim is an arc: loadURDF(flags=URDF_USE_IMPLICIT_CYLINDER) and "
            f"changeDynamics(collisionMargin={effects.rim.radius!r})."
        )


def _robot(
    name: str, link_name: str, constants: Mapping[str, float]
) -> tuple[ET.Element, ET.Element]:
    """Return a robot and its one link, whose contact carries the constants."""
    root = ET.Element("robot", name=name)
    link = ET.SubElement(root, "link", name=link_name)
    contact = ET.SubElement(link, "contact")
    for key, value in constants.items():
        ET.SubElement(contact, key, value=repr(value))
    return root, link


def _text(root: ET.Element) -> str:
    ET.indent(root)
    return '<?xml version="1.0"?>\n' + ET.tostring(root, encoding="unicode") + "\n"
