"""PyBullet's settings that matter to a rolling can, what it ships with, and what `matched` takes.

Shipped, a URDF cylinder is a polygon with 32 sides inside a margin of 1 mm, its moments are those
of its bounding box, it is damped, and its velocities are clamped. `matched` undoes all of it: the
implicit cylinder with no margin, the moments of the file, no damping, a clamp out of reach, no
slop, and an ERP that takes penetration away within a step or two. What a scene declares comes on
top, in every profile.

The flags of `loadURDF` appear under the names of its constants; what belongs to
`setPhysicsEngineParameter` or to `changeDynamics` under the names of their arguments. A setting of
None is not handed to PyBullet at all; what it then does is from its sources.

The variants are settings worth a price, each one change to `matched`. A margin makes another rim
than the scene's, which only profile `default` lets pass: so that variant is the engine as shipped
with all differences removed but this.

The differences between PyBullet as shipped and matched are in the order in which they are removed:
the body first (its rim, its moments), then what acts on a body in flight, then the contact and its
solver, the timestep last.
"""

import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from harness.engines import (
    COMMON,
    ETA_SETTING,
    FRICTIONS,
    MESH_SETTING,
    TIMESTEP,
    TWO_DIRECTIONS,
    Case,
    ModelDifference,
    Setting,
    SolverEffort,
    Value,
    Variant,
    bounded_separately,
    outline_gap,
    prism,
    probed_depth,
    rim_within,
)
from models.scene import Scene

DEFAULT_TIMESTEP = 1.0 / 240.0
MATCHED_TIMESTEP = 1e-4

OUT_OF_REACH = 1e6
"""rad/s and m/s: a velocity clamp that no scene meets."""

SEQUENTIAL_IMPULSE, DANTZIG = "CONSTRAINT_SOLVER_LCP_SI", "CONSTRAINT_SOLVER_LCP_DANTZIG"

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
    Setting.as_shipped(
        "URDF_ENABLE_SLEEPING",
        value=False,
        meaning="A can that has been slow for two seconds is put to sleep and stands still.",
    ),
    Setting.as_shipped(
        "useMaximalCoordinates",
        value=False,
        meaning="btRigidBody with an implicit gyroscopic term; else btMultiBody, explicit.",
    ),
)

SOLVER = (
    Setting.as_shipped(
        "numSubSteps",
        0,
        "Parts of a timestep, 2 or more; parity asks one of them, forces are the last one's.",
    ),
    Setting.as_shipped(
        "constraintSolverType",
        SEQUENTIAL_IMPULSE,
        "Algorithm that finds the contact impulses.",
        choices=(SEQUENTIAL_IMPULSE, "CONSTRAINT_SOLVER_LCP_PGS", DANTZIG),
    ),
    Setting.as_shipped(
        "useSplitImpulse",
        0,
        "Pushes a deep penetration out without speed (1); of maximal coordinates alone.",
    ),
    Setting.as_shipped(
        "splitImpulsePenetrationThreshold",
        None,
        "Distance below which an impulse is split, m, negative.",
        unset="-0.04 m",
    ),
    Setting.as_shipped(
        "numSolverIterations", 50, "Most sweeps of the sequential impulse solver in a step."
    ),
    Setting(
        "solverResidualThreshold",
        1e-7,
        1e-14,
        "Squared velocity residual at which the sweeps stop.",
    ),
    Setting(
        "contactERP",
        None,
        0.8,
        "Share of the penetration taken away in a step.",
        unset="0.08 (erp2)",
    ),
    Setting.as_shipped(
        "frictionERP",
        None,
        "Share of the slip taken back in a step, with friction anchors.",
        unset="0.2",
    ),
    Setting.as_shipped("globalCFM", None, "Softness mixed into every constraint.", unset="0"),
    Setting("contactSlop", None, 0.0, "Penetration that is left alone, m.", unset="1e-5 m"),
    Setting.as_shipped(
        "contactBreakingThreshold",
        None,
        "Distance beyond which a cached contact is dropped, relative to the can's size.",
        unset="0.02",
    ),
    Setting.as_shipped(
        "warmStartingFactor",
        None,
        "Share of the last step's impulses that the solver starts from.",
        unset="0.1",
    ),
    Setting(
        "enableConeFriction",
        None,
        1,
        "Circular friction cone (1) or two independent directions (0).",
        unset="1",
    ),
    Setting.as_shipped(
        "restitutionVelocityThreshold",
        None,
        "Speed below which an impact gives nothing back, m/s.",
        unset="0.2",
    ),
)

DYNAMICS = (
    Setting(
        "collisionMargin",
        None,
        0.0,
        "Radius of the fillet that rounds the rim, m.",
        unset="0.001 m",
    ),
    Setting(
        "linearDamping",
        None,
        0.0,
        "Rate at which velocity is lost, 1/s, and again with its square.",
        unset="0.04",
    ),
    Setting(
        "angularDamping", None, 0.0, "Rate at which angular velocity is lost, 1/s.", unset="0.04"
    ),
    Setting(
        "maxJointVelocity",
        None,
        OUT_OF_REACH,
        "Clamp on each component of velocity and angular velocity.",
        unset="100",
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
    decided: dict[str, Value] = {}
    if effects.damping is not None:
        decided["useMaximalCoordinates"] = True
        decided["linearDamping"] = -math.expm1(-effects.damping.linear)
        decided["angularDamping"] = -math.expm1(-effects.damping.angular)
    if effects.rim is not None:
        decided["URDF_USE_IMPLICIT_CYLINDER"] = True
        decided["collisionMargin"] = effects.rim.radius
    if effects.restitution is not None:
        decided["restitutionVelocityThreshold"] = 0.0
        decided["contactBreakingThreshold"] = _IN_TOUCH
        decided["contactERP"] = 0.0
    return decided


SETTINGS = (*URDF_FLAGS, *SOLVER, *DYNAMICS, MESH_SETTING, ETA_SETTING)


PROCESS_WIDE: Mapping[str, float] = MappingProxyType({"contactBreakingThreshold": 0.02})
"""Settings that PyBullet keeps in a global variable, with the value it ships: one world's choice
reaches every world after it in the process, so that each world must say its own."""


def given(group: tuple[Setting, ...], chosen: Mapping[str, Value]) -> dict[str, Any]:
    """Return the settings of a group that are handed to PyBullet."""
    return {s.name: chosen[s.name] for s in group if chosen[s.name] is not None}


def urdf_flags(chosen: Mapping[str, Value]) -> list[str]:
    """Return the flags of `loadURDF` that are set, as PyBullet names them."""
    return [s.name for s in URDF_FLAGS if s.name.startswith("URDF_") and chosen[s.name]]


_MARGIN, _DAMPING, _SLOP = 0.001, 0.04, 1e-5
"""m, 1/s, m: collisionMargin, both dampings and contactSlop where PyBullet is not handed them."""

_MOMENTS = (
    "transverse inertia A",
    "axial inertia C",
    *(f"inertia {axes}" for axes in ("xx", "yy", "zz", "xy", "xz", "yz")),
)
_BETWEEN = FRICTIONS[1]
_ARMS = ("arm of drilling", "arm of rolling resistance")


def imposed_in(case: Case, chosen: Mapping[str, Value]) -> dict[str, float]:
    """Return the rows of parity in which PyBullet goes its own way, each with its share.

    With friction of two directions in every profile; else as it ships.
    """
    scene, rows = case.scene, dict[str, float]()
    solver = chosen["constraintSolverType"]
    if solver != SEQUENTIAL_IMPULSE or chosen["enableConeFriction"] == 0:
        coupled = bounded_separately(scene)[_BETWEEN]
        rows[_BETWEEN] = coupled if solver == DANTZIG else TWO_DIRECTIONS
    if case.profile != "default":
        return rows
    if not chosen["URDF_USE_INERTIA_FROM_FILE"]:  # they are of the shape, whatever is declared
        rows |= dict.fromkeys(_MOMENTS, math.inf)
    corner, mesh = 0.0, chosen[MESH_SETTING.name]
    if mesh is not None or not chosen["URDF_USE_IMPLICIT_CYLINDER"]:
        # a prism turns about its corner, at an arm of any size beside a declared one
        rows |= dict.fromkeys(_ARMS, math.inf)
        corner = scene.can.radius * outline_gap(prism(32) if mesh is None else mesh)  # type: ignore[arg-type] # as checked
    rows |= rim_within(scene.can, _or(chosen["collisionMargin"], _MARGIN) + corner)
    if (soft := scene.effects.compliance) is not None:
        # the spring begins below the slop; the rest is for round-off
        share = _or(chosen["contactSlop"], _SLOP) / probed_depth(scene, soft.stiffness) + 1e-9
        rows["contact stiffness"] = share
        if share >= 1.0:  # all that is probed is within the slop
            rows["contact damping"] = 1.0
    return rows if chosen["useMaximalCoordinates"] else rows | _damped(scene, chosen)


def _damped(scene: Scene, chosen: Mapping[str, Value]) -> dict[str, float]:
    """Return the rows that a multibody's damping, d (1 + |v|) v, and its clamp change."""
    linear, angular = (_or(chosen[f"{n}Damping"], _DAMPING) for n in ("linear", "angular"))
    rows = {
        # at 1 m/s and 1 rad/s twice as much as at rest, and the second order of the step
        "linear damping": 2.02 * linear,
        "angular damping": 2.02 * angular,
        # at 1e4 it turns round what the clamp leaves; a gyroscopic term is clamped likewise
        "speed kept": math.inf,
        "spin kept": math.inf,
        "misfit of the gyroscopic acceleration": math.inf,
    }
    if (shake := scene.effects.shake) is not None:
        rate, period = 2.0 * math.pi * shake.frequency, 1.0 / shake.frequency
        speed = scene.gravity * period + rate * max(shake.horizontal, shake.vertical)
        lost = linear * (1.0 + speed) * speed * period  # over a period of the fall
        rows["misfit of the shaking"] = lost
        for way in ("horizontal", "vertical"):
            size = getattr(shake, way) or scene.can.bounding_radius
            rows[f"{way} shaking"] = lost / rate / size
    return rows


def _or(chosen: Value, shipped: float) -> float:
    """Return a setting, or what PyBullet has where it is not handed one."""
    return shipped if chosen is None else float(chosen)  # type: ignore[arg-type] # a number


_ALL_BUT_THE_MARGIN = tuple(
    (setting.name, setting.matched)
    for setting in SETTINGS
    if setting.matched not in {None, setting.default} and not callable(setting.matched)
)

SHIPPED_ERP = 0.08
"""What contactERP is where PyBullet is not handed one."""

_PRISM = ("URDF_USE_IMPLICIT_CYLINDER", False)
_MILLIMETRE = ("collisionMargin", _MARGIN)

COLLIDERS = (
    Variant(name="implicit cylinder"),
    Variant(name="implicit cylinder, margin 1 mm", settings=(_MILLIMETRE,)),
    Variant(name="convex hull of 32 sides", settings=(_PRISM,)),
    Variant(name="convex hull of 32 sides, margin 1 mm", settings=(_PRISM, _MILLIMETRE)),
)
MESH_COLLIDERS = (
    Variant(name="convex hull"),
    Variant(name="convex hull, margin 1 mm", settings=(_MILLIMETRE,)),
)

VARIANTS = (
    *COMMON,
    *(
        Variant(
            name=f"{count} sweeps at most",
            settings=(("numSolverIterations", count),),
            thorough=count != 5,  # noqa: PLR2004 - the middle one
        )
        for count in (2, 5, 10)
    ),
    *(
        Variant.of(
            "contactERP",
            share,
            imposes="penetration that is taken away slowly",
            thorough=share > SHIPPED_ERP,
        )
        for share in (SHIPPED_ERP, 0.2)
    ),
    Variant(
        name="margin of 1 mm",
        profile="default",
        settings=tuple((dict(_ALL_BUT_THE_MARGIN) | {"collisionMargin": 0.001}).items()),
        imposes="a rim rounded by a margin of 1 mm",
    ),
    Variant(
        name="friction of two directions",
        settings=(("enableConeFriction", 0),),
        imposes="a friction cone that is a pyramid",
    ),
    Variant(name="maximal coordinates", settings=(("useMaximalCoordinates", True),)),
)

MODEL_DIFFERENCES = (
    ModelDifference(
        name="rim shape",
        settings=("URDF_USE_IMPLICIT_CYLINDER", "collisionMargin"),
        sentence="The rim is a polygon with 32 corners inside a margin of 1 mm.",
    ),
    ModelDifference(
        name="inertia",
        settings=("URDF_USE_INERTIA_FROM_FILE",),
        sentence="The moments are those of the collision shape, not the declared ones.",
    ),
    ModelDifference(
        name="damping",
        settings=("linearDamping", "angularDamping"),
        sentence="Velocities decay at 0.04 per second.",
    ),
    ModelDifference(
        name="velocity clamp",
        settings=("maxJointVelocity",),
        sentence="No component of velocity exceeds 100 m/s or rad/s.",
    ),
    ModelDifference(
        name="stabilisation",
        settings=("contactERP", "contactSlop"),
        sentence="A slop of 0.01 mm is left alone and what is deeper taken away at 8 % a step.",
    ),
    ModelDifference(
        name="solver",
        settings=("solverResidualThreshold", "enableConeFriction"),
        sentence="The sweeps stop at a squared residual of 1e-7.",
    ),
    ModelDifference(
        name="timestep",
        settings=(TIMESTEP,),
        sentence="Steps of 1/240 s are long beside the bounce.",
    ),
)

# a squared residual of 1e-30 is round-off of velocities of 1 m/s; sweeps end there before 1000
_RESIDUAL = ("solverResidualThreshold", 1e-30)

SOLVER_EFFORTS = (
    SolverEffort(name="1 sweep", settings=(_RESIDUAL, ("numSolverIterations", 1))),
    SolverEffort(name="2 sweeps", settings=(_RESIDUAL, ("numSolverIterations", 2))),
    SolverEffort(name="5 sweeps", settings=(_RESIDUAL, ("numSolverIterations", 5))),
    SolverEffort(name="10 sweeps", settings=(_RESIDUAL, ("numSolverIterations", 10))),
    SolverEffort(name="residual 1e-7, as shipped", settings=(("solverResidualThreshold", 1e-7),)),
    SolverEffort(name="converged", settings=(_RESIDUAL, ("numSolverIterations", 1000))),
)
