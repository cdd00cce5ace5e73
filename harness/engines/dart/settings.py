"""DART's settings that matter to a rolling can, what it ships with, and what `matched` takes.

As shipped FCL finds the contacts, a boxed LCP by Dantzig's method takes friction as two directions
of their own, up to sqrt(2) mu between them and 33 degrees astray, and what has been slow for half a
second is put to sleep. `matched` takes DART's own detector, which knows a cylinder on a plane to
the last bit, and Gauss-Seidel sweeps on Coulomb's cone until nothing changes. A setting has the
name of the option in DART, or of the method that sets it.

What Python cannot set stays as it is in every profile: a hundredth of the penetration is taken away
in a step, at 1 mm/s at most, as `rockingcan check dart --capabilities` finds; an impact that would
give back less than 0.1 m/s gives back nothing, and any other is off by 3e-5 of itself.

The differences between DART as shipped and matched are in the order in which they are removed: the
geometry of the contact, its solver, what acts on a body at rest, the timestep last.
"""

import math
from collections.abc import Mapping

from harness.engines import (
    COMMON,
    ETA_SETTING,
    FRICTIONS,
    TIMESTEP,
    Case,
    ModelDifference,
    Setting,
    SolverEffort,
    Value,
    Variant,
    bounded_separately,
    outline_gap,
    prism,
    rim_within,
)

DEFAULT_TIMESTEP = 1e-3
MATCHED_TIMESTEP = 1e-4

BULLET = "BulletCollisionDetector"
FCL = "FCLCollisionDetector"
DETECTORS = (
    "DARTCollisionDetector",
    FCL,
    BULLET,
    "OdeCollisionDetector",
)
DANTZIG, NSGS, FBF = "DantzigBoxedLcpSolver", "NsgsFrictionSolver", "FbfFrictionSolver"

SHAPE_TYPE, MESH = "primitiveShapeType", "MESH"
_SIDES = 16
"""Of the prism that is FCL's mesh of a cylinder."""

MOST_ITERATIONS = {NSGS: "maxSweeps", FBF: "maxOuterIterations"}
"""What the solvers of the cone call the most of their iterations."""

_CONVERGED = 1e-12

SETTINGS = (
    Setting(
        "collisionDetector",
        "FCLCollisionDetector",
        "DARTCollisionDetector",
        "Whose geometry finds the contacts; DART's own is exact for a cylinder on a plane.",
        choices=DETECTORS,
    ),
    Setting.as_shipped(
        SHAPE_TYPE,
        "PRIMITIVE",
        "Of FCL's detector: the can is a cylinder, or a mesh of 16 sides.",
        choices=("PRIMITIVE", MESH),
    ),
    Setting(
        "boxedLcpSolver",
        DANTZIG,
        NSGS,
        "Finds the impulses: a boxed LCP with friction in two directions, or on Coulomb's cone.",
        choices=(DANTZIG, NSGS, FBF),
    ),
    Setting(
        "tolerance",
        1e-5,
        _CONVERGED,
        "Change of the impulses at which the solvers of the cone stop, relative.",
        positive=True,
    ),
    Setting("maxSweeps", 100, 1000, "Most iterations of the solvers of the cone in a step."),
    Setting.as_shipped(
        "law",
        "Coulomb",
        "Law of NsgsFrictionSolver: a cone without dilation, an associated one, or a box.",
        choices=("Coulomb", "Associated", "Box"),
    ),
    Setting.as_shipped(
        "splitImpulseEnabled",
        value=False,
        meaning="Penetration is taken away by a correction of positions, without speed.",
    ),
    Setting(
        "deactivation",
        default=True,
        matched=False,
        meaning="A can that has been slow for half a second is put to sleep and stands still.",
    ),
    ETA_SETTING,
)

_LOST = 0.01
"""Restitution below which the impact of the parity table, at 10 m/s, gives nothing back."""

_ADDED = 1.1e-4
"""Of that impact: the penetration of a step is taken away at 1 mm/s."""

_MARGIN = 0.041
"""Of the least half width of the can: Bullet's detector rounds it by a little less."""


def imposed_in(case: Case, chosen: Mapping[str, Value]) -> dict[str, float]:
    """Return the rows of parity in which DART goes its own way, each with its share.

    A small rebound is lost. Dantzig's method has friction in two directions of their own, bounded
    by the load that there would be without any; Bullet's detector touches elsewhere than below the
    centre, where that is any other. A mesh has no points between its corners.
    """
    can, effects = case.scene.can, case.scene.effects
    within = outline_gap(prism(_SIDES)) * can.radius if chosen[SHAPE_TYPE] == MESH else 0.0
    rows, shipped = dict[str, float](), case.profile == "default"
    bullet = shipped and chosen["collisionDetector"] == BULLET
    if effects.restitution is not None:
        declared = effects.restitution.coefficient
        missed = declared if declared < _LOST else 0.0
        rows["restitution"] = (missed + _ADDED) / (declared or 1.0)
    if chosen["boxedLcpSolver"] == DANTZIG or chosen["law"] == "Box":
        rows |= dict.fromkeys(FRICTIONS, math.inf) if bullet else bounded_separately(case.scene)
        if not shipped:
            del rows[FRICTIONS[0]]
    if bullet:
        within = _MARGIN * min(can.radius, can.half_height)
    return rows | (rim_within(can, within) if within else {})


COLLIDERS = (
    *(Variant(name=word, settings=(("collisionDetector", word),)) for word in DETECTORS),
    Variant(
        name=f"{FCL}, mesh of 16 sides", settings=(("collisionDetector", FCL), (SHAPE_TYPE, MESH))
    ),
)

VARIANTS = (
    *COMMON,
    *(
        Variant(
            name=f"{count} sweeps at most",
            settings=(("maxSweeps", count),),
            thorough=count != 5,  # noqa: PLR2004 - the middle one
        )
        for count in (2, 5, 10)
    ),
    Variant(
        name="Dantzig",
        settings=(("boxedLcpSolver", DANTZIG),),
        imposes="friction of two directions of their own",
    ),
    Variant(name="split impulse", settings=(("splitImpulseEnabled", True),)),
    Variant(
        name="FCL's contacts",
        settings=(("collisionDetector", "FCLCollisionDetector"),),
        imposes="a contact at the middle of the base below 4.5e-4 rad",
    ),
)

MODEL_DIFFERENCES = (
    ModelDifference(
        name="collision detector",
        settings=("collisionDetector",),
        sentence="FCL puts the contact of a can that is nearly flat at the middle of its base.",
    ),
    ModelDifference(
        name="solver",
        settings=("boxedLcpSolver", "tolerance", "maxSweeps"),
        sentence="Friction is of two directions of their own, up to 1.41 of the declared.",
    ),
    ModelDifference(
        name="sleeping",
        settings=("deactivation",),
        sentence="A can that has been slow for half a second stands still.",
    ),
    ModelDifference(
        name="timestep",
        settings=(TIMESTEP,),
        sentence="Steps of 1 ms are long beside the bounce.",
    ),
)

# impulses change by round-off alone at 1e-15; sweeps end there before 10,000
_TOLERANCE = ("tolerance", 1e-15)

SOLVER_EFFORTS = (
    *(
        SolverEffort(
            name=f"{count} sweep{'s' if count > 1 else ''}",
            settings=(_TOLERANCE, ("maxSweeps", count)),
        )
        for count in (1, 2, 5, 10)
    ),
    SolverEffort(name="tolerance 1e-5, as shipped", settings=(("tolerance", 1e-5),)),
    SolverEffort(name="converged", settings=(_TOLERANCE, ("maxSweeps", 10_000))),
)
