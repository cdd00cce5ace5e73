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
        name="URDF_USE_IMPLICIT_CYLINDER",
        default=False,
        matched=True,
        meaning="A true cylinder; else a prism with 32 sides that rolls on its corners.",
    ),
    Setting(
        name="URDF_USE_INERTIA_FROM_FILE",
        default=False,
        matched=True,
        meaning="The declared moments; else those of the shape, of its bounding box for a prism.",
    ),
    Setting(
        name="URDF_ENABLE_SLEEPING",
        default=False,
        matched=False,
        meaning="A can that has been slow for two seconds is put to sleep and stands still.",
    ),
    Setting(
        name="useMaximalCoordinates",
        default=False,
        matched=False,
        meaning="btRigidBody with an implicit gyroscopic term; else btMultiBody, explicit.",
    ),
)

SOLVER = (
    Setting(
        name="numSubSteps",
        default=0,
        matched=0,
        meaning="Parts that a timestep is stepped in, of 2 or more; forces are the last one's.",
    ),
    Setting(
        name="constraintSolverType",
        default=SEQUENTIAL_IMPULSE,
        matched=SEQUENTIAL_IMPULSE,
        choices=(
            SEQUENTIAL_IMPULSE,
            "CONSTRAINT_SOLVER_LCP_PGS",
            "CONSTRAINT_SOLVER_LCP_DANTZIG",
        ),
        meaning="Algorithm that finds the contact impulses.",
    ),
    Setting(
        name="useSplitImpulse",
        default=0,
        matched=0,
        meaning="Pushes a deep penetration out without speed (1); of maximal coordinates alone.",
    ),
    Setting(
        name="splitImpulsePenetrationThreshold",
        default=None,
        matched=None,
        meaning="Distance below which an impulse is split, m, negative.",
    ),
    Setting(
        name="numSolverIterations",
        default=50,
        matched=50,
        meaning="Most sweeps of the sequential impulse solver in a step.",
    ),
    Setting(
        name="solverResidualThreshold",
        default=1e-7,
        matched=1e-14,
        meaning="Squared velocity residual at which the sweeps stop.",
    ),
    Setting(
        name="contactERP",
        default=None,
        matched=0.8,
        meaning="Share of the penetration taken away in a step.",
    ),
    Setting(
        name="frictionERP",
        default=None,
        matched=None,
        meaning="Share of the slip taken back in a step, with friction anchors.",
    ),
    Setting(
        name="globalCFM",
        default=None,
        matched=None,
        meaning="Softness mixed into every constraint.",
    ),
    Setting(
        name="contactSlop",
        default=None,
        matched=0.0,
        meaning="Penetration that is left alone, m.",
    ),
    Setting(
        name="contactBreakingThreshold",
        default=None,
        matched=None,
        meaning="Distance beyond which a cached contact is dropped, relative to the can's size.",
    ),
    Setting(
        name="warmStartingFactor",
        default=None,
        matched=None,
        meaning="Share of the last step's impulses that the solver starts from.",
    ),
    Setting(
        name="enableConeFriction",
        default=None,
        matched=1,
        meaning="Circular friction cone (1) or two independent directions (0).",
    ),
    Setting(
        name="restitutionVelocityThreshold",
        default=None,
        matched=None,
        meaning="Speed below which an impact gives nothing back, m/s.",
    ),
)

DYNAMICS = (
    Setting(
        name="collisionMargin",
        default=None,
        matched=0.0,
        meaning="Radius of the fillet that rounds the rim, m.",
    ),
    Setting(
        name="linearDamping",
        default=None,
        matched=0.0,
        meaning="Rate at which velocity is lost, 1/s, and again with its square.",
    ),
    Setting(
        name="angularDamping",
        default=None,
        matched=0.0,
        meaning="Rate at which angular velocity is lost, 1/s.",
    ),
    Setting(
        name="maxJointVelocity",
        default=None,
        matched=OUT_OF_REACH,
        meaning="Clamp on each component of velocity and angular velocity.",
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
    own, asked = dict(case.options), for_effects(case.scene)
    asked = {name: value for name, value in asked.items() if name not in own}
    return resolve(case, SETTINGS, timestep) | asked


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
