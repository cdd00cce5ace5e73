"""What collides in MuJoCo: shapes of the can and of the ground, and how they are collided.

A cylinder on a plane has a formula. Other pairs of shapes have an iterative collider, of which
MuJoCo has two; they are settings under its own names.
"""

from collections.abc import Mapping

import mujoco

from harness.engines import MESH_SETTING, Mesh, Setting, Value, Variant, prism

CYLINDER_ON_PLANE = "cylinder-plane"
SHAPES = Setting.as_shipped(
    "shapes",
    CYLINDER_ON_PLANE,
    "Shapes that collide: the can as a cylinder or a mesh, the ground as a plane or a box.",
    choices=(CYLINDER_ON_PLANE, "mesh-plane", "cylinder-box", "mesh-box"),
)
"""The harness's own word too."""

_SIDES = 32
"""Of the prism that is the mesh where no other is given."""

_SHIPPED = mujoco.MjModel.from_xml_string("<mujoco/>").opt


def can_be_disabled(flag: str) -> bool:
    """Return whether the version that is installed does what a flag says unless it is disabled."""
    return hasattr(mujoco.mjtDisableBit, f"mjDSBL_{flag.upper()}")


def is_flag(name: str) -> bool:
    """Return whether the version that is installed has a flag of this name."""
    return can_be_disabled(name) or hasattr(mujoco.mjtEnableBit, f"mjENBL_{name.upper()}")


def _as_shipped(flag: str) -> str:
    """Return a flag of the version that is installed: earlier ones have to be asked for more."""
    return "enable" if can_be_disabled(flag) else "disable"


CCD_OPTIONS = (
    (
        Setting.as_shipped(
            "ccd_tolerance",
            _SHIPPED.ccd_tolerance,
            "Of the collider of boxes and meshes, m; a cylinder on a plane has a formula.",
            positive=True,
        ),
        Setting.as_shipped(
            "ccd_iterations", _SHIPPED.ccd_iterations, "Most steps of that collider."
        ),
    )
    if hasattr(_SHIPPED, "ccd_tolerance")  # it had another name
    else ()
)
CCD_FLAGS = tuple(
    Setting.as_shipped(name, _as_shipped(name), meaning, choices=("enable", "disable"))
    for name, meaning in (
        ("nativeccd", "MuJoCo's own collider of boxes and meshes; else libccd."),
        ("multiccd", "Points of that collider beside the deepest."),
    )
    if is_flag(name)
)
"""Attributes of `option` and of `option/flag`."""

OF_CCD = tuple(setting.name for setting in (*CCD_OPTIONS, *CCD_FLAGS))

_TIGHT = (("ccd_tolerance", 1e-12), ("ccd_iterations", 200))
_DEEPEST, _LIBCCD = (("multiccd", "disable"),), (("nativeccd", "disable"),)

COLLIDERS = tuple(
    Variant(
        name=f"{word}, {how}" if how else word,
        settings=settings if word == CYLINDER_ON_PLANE else ((SHAPES.name, word), *settings),
    )
    for word, how, settings in (
        *((word, "", ()) for word in SHAPES.choices),
        ("cylinder-box", "no multiccd", _DEEPEST),
        ("cylinder-box", "tolerance 1e-12 m", _TIGHT),
        ("cylinder-box", "tolerance 1e-12 m, no multiccd", (*_TIGHT, *_DEEPEST)),
        ("cylinder-box", "libccd", _LIBCCD),
        ("mesh-box", "libccd", _LIBCCD),
    )
)
MESH_COLLIDERS = tuple(each for each in COLLIDERS if each.name.startswith("mesh"))


def shapes_in(chosen: Mapping[str, Value]) -> str:
    """Return the word for the shapes that collide, of an engine that may not have the setting."""
    return str(chosen.get(SHAPES.name, CYLINDER_ON_PLANE))


def mesh_in(chosen: Mapping[str, Value]) -> Mesh | None:
    """Return the mesh that the can is; None for a cylinder."""
    mesh = chosen.get(MESH_SETTING.name)
    if mesh is None and shapes_in(chosen).startswith("mesh"):
        return prism(_SIDES)
    return mesh  # type: ignore[return-value] # points, as it was checked
