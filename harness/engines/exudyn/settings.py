"""Exudyn's settings that matter to a rolling can, what it ships with, and what `matched` takes.

The can is a rigid body with Euler parameters whose lower rim is an `ObjectJointRollingDisc`: three
constraints on the velocity of the rim's lowest point. As shipped the generalised-alpha method with
a spectral radius of 0.9 integrates them, with a Jacobian that is kept from step to step. `matched`
takes the trapezoidal rule in the form of index 2, which damps nothing, and Newton's method to
round-off. A setting has the name of the option in `SimulationSettings`, or of the argument of
`SolveDynamic`.

Multipliers are free of inertia and ring: at the start of each run of steps Exudyn's initial
accelerations leave out that the contact point moves on, by |omega x r'|, and the trapezoidal rule
keeps that error from step to step, with alternating sign. The mean of the two ends of a step is the
force that moved the can, and is what is told.
"""

import math

from harness.engines import (
    COMMON,
    ETA_SETTING,
    TIMESTEP,
    ModelDifference,
    Setting,
    SolverEffort,
    Variant,
)

DEFAULT_TIMESTEP = 1e-3
"""s: that of its examples; `SimulationSettings` alone has 10 ms, which a model is to replace."""

MATCHED_TIMESTEP = 1e-4

IMPOSED = {"angular damping": 1e-4, "spin kept": math.inf}
"""Rows of parity in which Exudyn goes its own way in every profile, each with its share.
GeneralizedAlpha loses six millionths of a spin in a second at steps of 10 ms, in proportion to
them; at 1e4 rad/s, where a can turns by radians in a step, Newton's method fails and leaves no
number."""

SETTINGS = (
    Setting(
        "solverType",
        "GeneralizedAlpha",
        "TrapezoidalIndex2",
        "Time integration; explicit methods take no joint.",
        choices=("GeneralizedAlpha", "TrapezoidalIndex2"),
    ),
    Setting.as_shipped(
        "spectralRadius",
        0.9,
        "Of GeneralizedAlpha: below 1 what oscillates from step to step is damped.",
        positive=True,
    ),
    Setting(
        "useModifiedNewton",
        default=True,
        matched=False,
        meaning="The Jacobian of an earlier step is used while the iterations still contract.",
    ),
    Setting(
        "relativeTolerance",
        1e-8,
        1e-12,
        "Residual at which Newton's method stops, over the one at first.",
        positive=True,
    ),
    Setting(
        "absoluteTolerance",
        1e-10,
        1e-13,
        "Residual at which Newton's method stops whatever it was at first.",
        positive=True,
    ),
    Setting.as_shipped("maxIterations", 25, "Most iterations of Newton's method in a step."),
    ETA_SETTING,
)

VARIANTS = (
    *COMMON,
    Variant.of("solverType", "GeneralizedAlpha"),
    Variant.of("relativeTolerance", 1e-6, thorough=True),
    Variant(name="modified Newton", settings=(("useModifiedNewton", True),)),
)

MODEL_DIFFERENCES = (
    ModelDifference(
        name="time integration",
        settings=("solverType",),
        sentence="What oscillates from step to step is damped.",
    ),
    ModelDifference(
        name="Newton's method",
        settings=("useModifiedNewton", "relativeTolerance", "absoluteTolerance"),
        sentence="Rolling is imposed up to a tolerance, with the Jacobian of an earlier step.",
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
            name=f"tolerance {tolerance:g}",
            settings=(("relativeTolerance", tolerance), ("absoluteTolerance", tolerance / 100.0)),
        )
        for tolerance in (1e-2, 1e-4, 1e-6)
    ),
    SolverEffort(
        name="tolerance 1e-8, as shipped",
        settings=(("relativeTolerance", 1e-8), ("absoluteTolerance", 1e-10)),
    ),
    SolverEffort(
        name="converged",
        settings=(("relativeTolerance", 1e-13), ("absoluteTolerance", 1e-14)),
    ),
)
