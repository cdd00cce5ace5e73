"""PyBullet's settings that matter to a rolling can, what it ships with, and what `matched` takes.

Shipped, a URDF cylinder is a polygon with 32 sides inside a margin of 1 mm, its moments are those
of its bounding box, it is damped, and its velocities are clamped. `matched` undoes all of it: the
implicit cylinder with no margin, the moments of the file, no damping, a clamp out of reach, no
slop, and an ERP that takes penetration away within a step or two. What a scene declares comes on
top, in every profile.

The flags of `loadURDF` appear under the names of its constants; what belongs to
`setPhysicsEngineParameter` or to `changeDynamics` under the names of their arguments. A setting of
None is not handed to PyBullet at all.
"""

import math
from collections.abc import Mapping
from types import MappingProxyType

from harness.core.case import Case, Value
from harness.engines.base import Setting, resolve
from harness.engines.stepping.schedule import ETA_SETTING
from models.scene import Scene

DEFAULT_TIMESTEP = 1.0 / 240.0
MATCHED_TIMESTEP = 1e-4

OUT_OF_REACH = 1e6
"""rad/s and m/s: a velocity clamp that no scene meets."""

SEQUENTIAL_IMPULSE = "CONSTRAINT_SOLVER_LCP_SI"

URDF_FLAGS = (
    Setting(
        "URDF_USE_IMPLICIT_CYLINDER",
        default=False,
        matched=True,
        meaning="A true cylinder; else a prism with 32 sides that rolls on its corners.",
    ),
    Setting(
        "URDF_USE_INERTIA_FROM_FILE",
        default=False,
        matched=True,
        meaning="The declared moments; else those of the shape, of its bounding box for a prism.",
    ),
    Setting(
        "URDF_ENABLE_SLEEPING",
        default=False,
        matched=False,
        meaning="A can that has been slow for two seconds is put to sleep and stands still.",
    ),
    Setting(
        "useMaximalCoordinates",
        default=False,
        matched=False,
        meaning="btRigidBody with an implicit gyroscopic term; else btMultiBody, explicit.",
    ),
)

SOLVER = (
    Setting(
        "numSubSteps",
        0,
        0,
        "Parts that a timestep is stepped in, of 2 or more; forces are the last one's.",
    ),
    Setting(
        "constraintSolverType",
        SEQUENTIAL_IMPULSE,
        SEQUENTIAL_IMPULSE,
        "Algorithm that finds the contact impulses.",
        choices=(SEQUENTIAL_IMPULSE, "CONSTRAINT_SOLVER_LCP_PGS", "CONSTRAINT_SOLVER_LCP_DANTZIG"),
    ),
    Setting(
        "useSplitImpulse",
        0,
        0,
        "Pushes a deep penetration out without speed (1); of maximal coordinates alone.",
    ),
    Setting(
        "splitImpulsePenetrationThreshold",
        None,
        None,
        "Distance below which an impulse is split, m, negative.",
    ),
    Setting(
        "numSolverIterations", 50, 50, "Most sweeps of the sequential impulse solver in a step."
    ),
    Setting(
        "solverResidualThreshold",
        1e-7,
        1e-14,
        "Squared velocity residual at which the sweeps stop.",
    ),
    Setting("contactERP", None, 0.8, "Share of the penetration taken away in a step."),
    Setting(
        "frictionERP", None, None, "Share of the slip taken back in a step, with friction anchors."
    ),
    Setting("globalCFM", None, None, "Softness mixed into every constraint."),
    Setting("contactSlop", None, 0.0, "Penetration that is left alone, m."),
    Setting(
        "contactBreakingThreshold",
        None,
        None,
        "Distance beyond which a cached contact is dropped, relative to the can's size.",
    ),
    Setting(
        "warmStartingFactor",
        None,
        None,
        "Share of the last step's impulses that the solver starts from.",
    ),
    Setting(
        "enableConeFriction",
        None,
        1,
        "Circular friction cone (1) or two independent directions (0).",
    ),
    Setting(
        "restitutionVelocityThreshold",
        None,
        None,
        "Speed below which an impact gives nothing back, m/s.",
    ),
)

DYNAMICS = (
    Setting("collisionMargin", None, 0.0, "Radius of the fillet that rounds the rim, m."),
    Setting(
        "linearDamping",
        None,
        0.0,
        "Rate at which velocity is lost, 1/s, and again with its square.",
    ),
    Setting("angularDamping", None, 0.0, "Rate at which angular velocity is lost, 1/s."),
    Setting(
        "maxJointVelocity",
        None,
        OUT_OF_REACH,
        "Clamp on each component of velocity and angular velocity.",
    ),
)

_IN_TOUCH = 1e-7
"""Of the breaking threshold, for impacts: a contact that is solved before it closes takes the
speed of approach out of the impact law, and one that is pushed out by ERP adds to it."""


def for_effects(scene: Scene) -> dict[str, Value]:
    """Return the settings that the effects of a scene decide, whatever the profile.

    PyBullet damps a multibody with d (1 + |v|) v, which is no law of the scene's, and a body in
    maximal coordinates by (1 - d)^dt, which is: d = 1 - exp(-rate).
    """
    effects = scene.effects
    found: dict[str, Value] = {}
    if effects.damping is not None:
        found["useMaximalCoordinates"] = True
        found["linearDamping"] = -math.expm1(-effects.damping.linear)
        found["angularDamping"] = -math.expm1(-effects.damping.angular)
    if effects.rim is not None:
        found["URDF_USE_IMPLICIT_CYLINDER"] = True
        found["collisionMargin"] = effects.rim.radius
    if effects.restitution is not None:
        found["restitutionVelocityThreshold"] = 0.0
        found["contactBreakingThreshold"] = _IN_TOUCH
        found["contactERP"] = 0.0
    return found


SETTINGS = (*URDF_FLAGS, *SOLVER, *DYNAMICS, ETA_SETTING)


def in_force(case: Case, timestep: float) -> dict[str, Value]:
    """Return every setting in force for a case: an option, else what an effect asks for."""
    return resolve(case, SETTINGS, timestep, for_effects(case.scene))


SHIPPED_VALUES = {
    "splitImpulsePenetrationThreshold": "-0.04 m",
    "contactERP": "0.08 (erp2)",
    "frictionERP": "0.2",
    "globalCFM": "0",
    "contactSlop": "1e-5 m",
    "contactBreakingThreshold": "0.02",
    "warmStartingFactor": "0.1",
    "enableConeFriction": "1",
    "restitutionVelocityThreshold": "0.2",
    "collisionMargin": "0.001 m",
    "linearDamping": "0.04",
    "angularDamping": "0.04",
    "maxJointVelocity": "100",
}
"""What PyBullet does with a setting that it is not handed, from its sources."""

PROCESS_WIDE: Mapping[str, float] = MappingProxyType({"contactBreakingThreshold": 0.02})
"""Settings that PyBullet keeps in a global variable, with the value it ships: one world's choice
reaches every world after it in the process, so that each world must say its own."""

IMPOSED_BY_DEFAULT = frozenset(
    {
        "transverse inertia A",
        "axial inertia C",
        "linear damping",
        "angular damping",
        "speed kept",
        "spin kept",
        "radius R",
        "half height H",
        "rim deviation",
        # the moments, whatever the point mass
        *(f"inertia {axes}" for axes in ("xx", "yy", "zz", "xy", "xz", "yz")),
        # damping, over a period of the shaking
        "horizontal shaking",
        "vertical shaking",
        "misfit of the shaking",
        # a prism turns about its corner
        "arm of drilling",
        "arm of rolling resistance",
    }
)
"""Quantities of the parity table in which PyBullet as it ships is not the scene's can."""
