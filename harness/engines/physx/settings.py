"""PhysX's settings that matter to a rolling can, what it ships with, and what `matched` takes.

As shipped a body loses a twentieth of its spin in a second, spins at 100 rad/s at most, yields in
its contacts and falls asleep. Friction acts at anchors of a patch, which are kept while they are
within 4 cm of the plane: under a rolling rim they are left behind, and what was rolled over drags.
`matched` keeps none, and projects over the whole step: substeps leave an acceleration of 0.02 g
that no timestep takes away. A setting has the name of the attribute in the schemas of PhysX, or of
the key of its configuration that is for a whole process.
"""

from collections.abc import Mapping

from harness.engines import (
    COMMON,
    ETA_SETTING,
    FRICTIONS,
    MESH_SETTING,
    TIMESTEP,
    TWO_DIRECTIONS,
    Case,
    Mesh,
    ModelDifference,
    Precision,
    Setting,
    SolverEffort,
    Value,
    Variant,
    outline_gap,
    prism,
    rim_within,
)

DEFAULT_TIMESTEP = 1.0 / 60.0
"""s: `physxScene:timeStepsPerSecond` 60."""

MATCHED_TIMESTEP = 1e-4

FREE = 1e9
"""A clamp on a speed that no can reaches."""


_NONE_KEPT = 1e-9
"""m: a rim rises by more behind its contact in a step of a microsecond, at a metre a second."""

ANCHORS = ("frictionOffsetThreshold", "frictionCorrelationDistance")
"""Settings, m, that decide which anchors of friction are kept."""

CUSTOM_GEOMETRY = "COLLISION_CYLINDER_CUSTOM_GEOMETRY"

_SIDES = 30
"""Of the prism that PhysX makes of a cylinder."""

_KEPT = 62
"""Corners of the largest prism whose hull PhysX keeps; of more it makes another hull."""

SETTINGS = (
    Setting(
        "frictionOffsetThreshold",
        0.04,
        _NONE_KEPT,
        "m: how far from the plane a contact may be to be an anchor of friction.",
        positive=True,
    ),
    Setting(
        "frictionCorrelationDistance",
        0.025,
        _NONE_KEPT,
        "m: how far apart contacts may be to share an anchor of friction.",
        positive=True,
    ),
    Setting(
        "solverType",
        "TGS",
        "PGS",
        "Gauss-Seidel over substeps of a step, or projected over the step.",
        choices=("TGS", "PGS"),
    ),
    Setting("solverPositionIterationCount", 16, 4, "Iterations of the solver in a step."),
    Setting.as_shipped(
        "solverVelocityIterationCount", 1, "Iterations without the correction of penetration."
    ),
    Setting.as_shipped(
        "enableExternalForcesEveryIteration",
        value=True,
        meaning="Gravity acts in each iteration of TGS by its share.",
    ),
    Setting("cfmScale", 0.025, 0.0, "Softness of contacts: share by which they yield."),
    Setting.as_shipped(
        "collisionSystem",
        "PCM",
        "Contacts that are kept from step to step, or found anew by separating axes.",
        choices=("PCM", "SAT"),
    ),
    Setting(
        "contactOffset",
        0.02,
        1e-4,
        "m: distance at which a contact is found.",
        positive=True,
    ),
    Setting.as_shipped(
        CUSTOM_GEOMETRY,
        value=True,
        meaning="A cylinder is exact; else it is a convex mesh. One for all worlds in a process.",
    ),
    MESH_SETTING,
    Setting("angularDamping", 0.05, 0.0, "1/s: share of the spin that is lost."),
    Setting(
        "maxAngularVelocity",
        5729.58,
        FREE,
        "deg/s: clamp on the spin.",
        positive=True,
    ),
    Setting(
        "maxDepenetrationVelocity",
        3.0,
        FREE,
        "m/s: clamp on the speed at which an overlap is pushed out.",
        positive=True,
    ),
    Setting.as_shipped(
        "enableGyroscopicForces",
        value=True,
        meaning="The gyroscopic term, without which a spin keeps its direction in the body.",
    ),
    Setting(
        "disableSleeping",
        default=False,
        matched=True,
        meaning="A can that is slow is not put to sleep.",
    ),
    ETA_SETTING,
)

_ROUNDINGS = 16.0
"""Of a velocity in a step on a slope: twice the most that was found."""


def imposed_in(case: Case, chosen: Mapping[str, Value], timestep: float) -> dict[str, float]:
    """Return the rows of parity in which PhysX goes its own way, each with its share.

    Friction is of two directions, and a mesh has no points between its corners. As shipped a spin
    is damped, and all of a fast one clamped away; a rate of damping, 1/s, is known to the round-off
    of a velocity over the timestep, s.
    """
    rows = dict.fromkeys(FRICTIONS, TWO_DIRECTIONS)
    mesh: Mesh | None = chosen[MESH_SETTING.name]  # type: ignore[assignment] # as it was checked
    if mesh is not None or not chosen[CUSTOM_GEOMETRY]:
        hull = prism(_SIDES) if mesh is None else mesh
        gap = outline_gap(hull) if len(hull) <= 3 * _KEPT else 1.0
        rows |= rim_within(case.scene.can, gap * case.scene.can.radius)
    if case.profile == "default":
        known = _ROUNDINGS * Precision.SINGLE.epsilon / timestep
        damping = float(chosen["angularDamping"])  # type: ignore[arg-type] # a number
        rows |= {"angular damping": damping + known, "linear damping": known, "spin kept": 1.0}
    return rows


_SEPARATING = ("collisionSystem", "SAT")
_SHIPPED_OFFSET = ("contactOffset", 0.02)
_CONVEX_MESH = (CUSTOM_GEOMETRY, False)

COLLIDERS = (
    Variant(name="cylinder"),
    Variant(name="cylinder, contact offset 20 mm", settings=(_SHIPPED_OFFSET,)),
    Variant(name="cylinder, SAT", settings=(_SEPARATING,)),
    Variant(name="convex mesh of 30 sides", settings=(_CONVEX_MESH,)),
    Variant(
        name="convex mesh of 30 sides, contact offset 20 mm",
        settings=(_CONVEX_MESH, _SHIPPED_OFFSET),
    ),
    Variant(name="convex mesh of 30 sides, SAT", settings=(_CONVEX_MESH, _SEPARATING)),
)
MESH_COLLIDERS = (
    Variant(name="convex hull"),
    Variant(name="convex hull, SAT", settings=(_SEPARATING,)),
)

VARIANTS = (
    *COMMON,
    Variant(
        name="anchors of 4 cm",
        settings=(("frictionOffsetThreshold", 0.04), ("frictionCorrelationDistance", 0.025)),
        imposes="anchors of friction that stay behind a rolling rim",
    ),
    Variant(name="TGS", settings=(("solverType", "TGS"),)),
    *(
        Variant(
            name=f"{count} iterations",
            settings=(("solverPositionIterationCount", count),),
            thorough=True,
        )
        for count in (1, 16)
    ),
)

MODEL_DIFFERENCES = (
    ModelDifference(
        name="anchors of friction",
        settings=ANCHORS,
        sentence="What a rim has rolled over keeps its anchor of friction, and drags.",
    ),
    ModelDifference(
        name="solver",
        settings=(
            "solverType",
            "solverPositionIterationCount",
            "cfmScale",
            "maxDepenetrationVelocity",
            "contactOffset",
        ),
        sentence="Contacts yield, and what they push out in substeps moves the can.",
    ),
    ModelDifference(
        name="damping and clamps",
        settings=("angularDamping", "maxAngularVelocity"),
        sentence="A twentieth of the spin is lost in a second, and all beyond 100 rad/s.",
    ),
    ModelDifference(
        name="sleeping",
        settings=("disableSleeping",),
        sentence="A can that has been slow stands still.",
    ),
    ModelDifference(
        name="timestep",
        settings=(TIMESTEP,),
        sentence="Steps of 17 ms are longer than the bounce.",
    ),
)

SOLVER_EFFORTS = tuple(
    SolverEffort(
        name="converged" if count == 128 else f"{count} iteration{'s' if count > 1 else ''}",  # noqa: PLR2004 - the last
        settings=(("solverPositionIterationCount", count),),
    )
    for count in (1, 2, 4, 16, 128)
)
