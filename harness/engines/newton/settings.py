"""Newton's settings that matter to a rolling can, what it ships with, and what `matched` takes.

Newton is several solvers with one way to contacts. Taken are those that tell the forces of a
contact: Steel, which sweeps over constraints of velocity, and XPBD, which moves positions. What a
solver is not handed it chooses itself. As shipped Steel loses a twentieth of a spin in a second,
lets points bear a load that are still above the plane, and both end after a few sweeps. A setting
has the name of the argument of the solver, of the shape or of the model.
"""

from collections.abc import Mapping

import numpy as np

from harness.engines import (
    COMMON,
    ETA_SETTING,
    MESH_SETTING,
    SMALLEST_TILT,
    TIMESTEP,
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
from models.gravity import gravity_vector

DEFAULT_TIMESTEP = 1.0 / 600.0
"""s: a sixtieth of a second in ten substeps, as its examples take it."""

MATCHED_TIMESTEP = 1e-4

SHAPE, SIDES = "add_shape", 32
"""The setting of the shape, and the sides of the prism that is a mesh."""

CYLINDER, CONVEX_HULL, MESH = "add_shape_cylinder", "add_shape_convex_hull", "add_shape_mesh"
"""Methods of the builder of a model, one for each kind of shape."""

STEEL, XPBD = "SolverSteel", "SolverXPBD"

_TOUCHING = 5e-8
"""m: some roundings of the height of a can. A rim that they lift bears its load, and the next point
of the rim that is a contact, some micrometres above the plane, does not."""

SETTINGS = (
    Setting.as_shipped(
        "solver",
        STEEL,
        "Sweeps over constraints of velocity, or over corrections of positions.",
        choices=(STEEL, XPBD),
    ),
    Setting(
        "iterations",
        None,
        100,
        "Sweeps of a step.",
        unset="12 of SolverSteel and 2 of SolverXPBD",
    ),
    Setting.as_shipped(
        "baumgarte", 0.2, "SolverSteel: share of an overlap that a step takes away.", positive=True
    ),
    Setting("cfm", 1e-6, 0.0, "SolverSteel: softness of a constraint."),
    Setting(
        "friction_anchor_beta",
        None,
        0.0,
        "SolverSteel: share of the way back to an anchor of friction that a step takes.",
        unset="chosen by the solver",
    ),
    Setting(
        "contact_gap_gate",
        None,
        _TOUCHING,
        "m, SolverSteel: distance up to which a contact may bear a load.",
        unset="every contact that was found",
    ),
    Setting(
        "rigid_contact_relaxation",
        0.8,
        1.0,
        "SolverXPBD: share of a correction that is applied.",
        positive=True,
    ),
    Setting.as_shipped(
        "rigid_contact_con_weighting",
        value=True,
        meaning="SolverXPBD: a correction is divided by the number of contacts of a body.",
    ),
    Setting(
        "rigid_body_angular_damping",
        0.05,
        0.0,
        "SolverSteel, 1/s: share of the spin that is lost.",
    ),
    Setting.as_shipped(
        SHAPE,
        CYLINDER,
        "Shape of the can: its cylinder, or a prism of 32 sides as a hull or a mesh.",
        choices=(CYLINDER, CONVEX_HULL, MESH),
    ),
    MESH_SETTING,
    Setting("gap", 0.1, 1e-3, "m: distance at which a contact is found.", positive=True),
    ETA_SETTING,
)

SLOWEST = 1e-4
"""m/s and rad/s: XPBD makes none of a velocity and of a spin below it."""

_RIM, _VELOCITY = 10.0, 16.0
"""Roundings of the direction to the rim's lowest point, and of a velocity in a step."""


def imposed_in(case: Case, chosen: Mapping[str, Value], timestep: float) -> dict[str, float]:
    """Return the rows of parity in which Newton goes its own way, each with its share.

    Its formula of the rim's lowest point loses digits, and a mesh has no points between its
    corners. As shipped Steel damps a spin, at a rate
    that is known to the round-off of a velocity over the timestep, s; of XPBD nothing falls from
    rest by steps in which gravity adds less than `SLOWEST`.
    """
    epsilon = Precision.SINGLE.epsilon
    rows = {"rim deviation": _RIM * epsilon / SMALLEST_TILT}
    mesh: Mesh | None = chosen[MESH_SETTING.name]  # type: ignore[assignment] # as it was checked
    if mesh is not None or chosen[SHAPE] != CYLINDER:
        gap = outline_gap(mesh or prism(SIDES))
        for row, share in rim_within(case.scene.can, gap * case.scene.can.radius).items():
            rows[row] = rows.get(row, 0.0) + share
    if chosen["solver"] == XPBD:
        gained = float(np.linalg.norm(gravity_vector(case.scene))) * timestep
        still = ("gravity", "gravity along x", "gravity along y") if gained < SLOWEST else ()
        return rows | dict.fromkeys(still, 1.0)
    if case.profile == "default":
        damping = float(chosen["rigid_body_angular_damping"])  # type: ignore[arg-type] # a number
        rows["angular damping"] = damping + _VELOCITY * epsilon / timestep
        rows["spin kept"] = 1.0  # of 1e4 rad/s: half of it in steps of 100 radians
    return rows


COLLIDERS = (
    Variant(name="cylinder"),
    Variant(name="convex hull of 32 sides", settings=((SHAPE, CONVEX_HULL),)),
    Variant(name="mesh of 32 sides", settings=((SHAPE, MESH),)),
)
MESH_COLLIDERS = (
    Variant(name="convex hull", settings=((SHAPE, CONVEX_HULL),)),
    Variant(name="mesh", settings=((SHAPE, MESH),)),
)

VARIANTS = (
    *COMMON,
    Variant(
        name="XPBD",
        settings=(("solver", XPBD), ("iterations", 20)),
        imposes="corrections of positions, from which velocities follow",
    ),
    *(
        Variant(name=f"{count} sweeps", settings=(("iterations", count),), thorough=True)
        for count in (1, 12)
    ),
)

MODEL_DIFFERENCES = (
    ModelDifference(
        name="solver",
        settings=("iterations", "cfm", "friction_anchor_beta"),
        sentence="Twelve sweeps are too few, and a constraint yields.",
    ),
    ModelDifference(
        name="points ahead of the rim",
        settings=("contact_gap_gate", "gap"),
        sentence="Points bear a load that the rim comes to in this step or has left.",
    ),
    ModelDifference(
        name="damping",
        settings=("rigid_body_angular_damping",),
        sentence="A twentieth of the spin is lost in a second.",
    ),
    ModelDifference(
        name="timestep",
        settings=(TIMESTEP,),
        sentence="Steps of 1.7 ms are long beside the bounce.",
    ),
)

SOLVER_EFFORTS = (
    *(
        SolverEffort(
            name=f"{count} sweep{'s' if count > 1 else ''}", settings=(("iterations", count),)
        )
        for count in (1, 2, 5, 12, 50)
    ),
    SolverEffort(name="converged", settings=(("iterations", 500),)),
)
