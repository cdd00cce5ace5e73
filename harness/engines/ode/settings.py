"""ODE's settings that matter to a rolling can, what it ships with, and what `matched` takes.

A setting has the name of the function that sets it, `dWorldSet...` or `dBodySet...`, or of the
flag. As shipped mu is no coefficient but a force in newtons, and a body turns in a step by the
first order of its spin. `matched` takes the friction in proportion to the normal force, the exact
turn, and hard constraints.

Whose geometry finds the contact is left to ODE: below 4.5e-4 rad its collider knows four points of
the base, and none until the middle of the base is in the plane. `contacts = rim` hands over the
lowest point of the rim instead, as any program that uses ODE may.

The differences between ODE as shipped and matched are in the order in which they are removed: what
the contact may bear, how it yields, how a body turns, the timestep last.
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
)

DEFAULT_TIMESTEP = 1e-3
"""s: ODE has none; this is what Gazebo steps it by."""

MATCHED_TIMESTEP = 1e-4

STEP, QUICK_STEP = "dWorldStep", "dWorldQuickStep"
COLLIDE, RIM = "dCollide", "rim"
FORCE, PROPORTION = "dContactApprox0", "dContactApprox1"

SETTINGS = (
    Setting.as_shipped(
        "step",
        STEP,
        "Direct solution of the LCP by Dantzig's method, or successive over-relaxation.",
        choices=(STEP, QUICK_STEP),
    ),
    Setting(
        "friction",
        FORCE,
        PROPORTION,
        "Whether mu bounds the friction as a force in N, or as a share of the normal force.",
        choices=(FORCE, PROPORTION),
    ),
    Setting.as_shipped(
        "contacts",
        COLLIDE,
        "Whose geometry finds the contact: ODE's, or the lowest point of the rim handed over.",
        choices=(COLLIDE, RIM),
    ),
    Setting.as_shipped("ERP", 0.2, "Share of the penetration taken away in a step."),
    Setting("CFM", 1e-10, 0.0, "Softness mixed into every constraint, s/kg."),
    Setting(
        "ContactMaxCorrectingVel",
        None,
        None,
        "Greatest speed at which a penetration is pushed out, m/s.",
        positive=True,
        adaptive=None,
        unset="no bound",
    ),
    Setting(
        "ContactSurfaceLayer",
        0.0,
        1e-7,
        "Penetration that is left alone, m; without it the error of a step lifts the rim off.",
    ),
    Setting.as_shipped(
        "GyroscopicMode", value=True, meaning="Whether the gyroscopic term is there at all."
    ),
    Setting(
        "FiniteRotationMode",
        default=False,
        matched=True,
        meaning="Whether a body turns in a step by its spin exactly, or to the first order.",
    ),
    Setting("QuickStepNumIterations", 20, 1000, "Sweeps of dWorldQuickStep in a step."),
    Setting.as_shipped("QuickStepW", 1.3, "Over-relaxation of dWorldQuickStep.", positive=True),
    ETA_SETTING,
)


def imposed_in(case: Case, chosen: Mapping[str, Value]) -> dict[str, float]:
    """Return the rows of parity in which ODE goes its own way, each with its share.

    Friction is a pyramid about the cone; as a force it has any ratio to the load. Of what an impact
    goes into the plane within its step a share is given back, if that is more than restitution is.
    """
    rows, law = dict[str, float](), case.scene.effects.restitution
    erp = float(chosen["ERP"])  # type: ignore[arg-type] # a number
    if law is not None and law.coefficient < erp:
        rows["restitution"] = (erp - law.coefficient) / (law.coefficient or 1.0)
    if chosen["friction"] == FORCE:
        return rows | dict.fromkeys(FRICTIONS, math.inf)
    return rows | bounded_separately(case.scene)


_RIM = ("contacts", RIM)
_QUICK = ("step", QUICK_STEP)

COLLIDERS = (
    Variant(name="cylinder"),
    Variant(name="rim point given", settings=(_RIM,)),
)

VARIANTS = (
    *COMMON,
    Variant(
        name="rim point given",
        settings=(_RIM,),
        imposes="the lowest point of the rim for a contact, whatever the collider of ODE finds",
    ),
    Variant(
        name="rim point given, adaptive",
        profile="adaptive",
        settings=(_RIM,),
        imposes="the lowest point of the rim for a contact, whatever the collider of ODE finds",
    ),
    *(
        Variant(
            name=f"{count} sweeps",
            settings=(_QUICK, ("QuickStepNumIterations", count)),
            thorough=count != 20,  # noqa: PLR2004 - what it ships with
        )
        for count in (5, 20, 100)
    ),
    Variant(name="no surface layer", settings=(("ContactSurfaceLayer", 0.0),), thorough=True),
)

MODEL_DIFFERENCES = (
    ModelDifference(
        name="friction",
        settings=("friction",),
        sentence="Friction is bounded by mu as a force in newtons, whatever the load.",
    ),
    ModelDifference(
        name="yield",
        settings=("CFM", "ContactSurfaceLayer"),
        sentence="The contact yields a little, and the error of a step breaks it.",
    ),
    ModelDifference(
        name="turn in a step",
        settings=("FiniteRotationMode",),
        sentence="In a step a body turns to the first order of its spin.",
    ),
    ModelDifference(
        name="timestep",
        settings=(TIMESTEP,),
        sentence="Steps of 1 ms are long beside the bounce.",
    ),
)

SOLVER_EFFORTS = (
    *(
        SolverEffort(
            name=f"{count} sweep{'s' if count > 1 else ''}",
            settings=(_QUICK, ("QuickStepNumIterations", count)),
        )
        for count in (1, 2, 5, 20, 100)
    ),
    SolverEffort(name="direct", settings=(("step", STEP),)),
)
