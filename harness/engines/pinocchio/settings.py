"""Pinocchio's settings that matter to a rolling can, what it ships with, and what `matched` takes.

Pinocchio has no stepping: the step is `World.step` of this folder, semi-implicit and with what an
overlap or a gap asks of the velocities in a step. Of that step are `correction` and the timesteps;
a solver's and coal's settings have the names that they have there.

The differences between Pinocchio as shipped and matched are in the order in which they are removed:
where a contact is seen, its solver, what is done about an overlap, the timestep last.
"""

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
MATCHED_TIMESTEP = 1e-4

ADMM, PGS = "ADMM", "PGS"

_FASTEST = 10.0
"""m/s: what closes at this speed is seen a step before it touches."""

SETTINGS = (
    Setting(
        "solver",
        ADMM,
        PGS,
        "Finds the impulses on Coulomb's cone: splitting, or sweeps from contact to contact.",
        choices=(ADMM, PGS),
    ),
    Setting(
        "tolerance",
        1e-6,
        1e-12,
        "Of feasibility and complementarity, absolute and relative, at which the solver stops.",
        positive=True,
    ),
    Setting.as_shipped("max_iterations", 1000, "Most iterations of the solver in a step."),
    Setting(
        "security_margin",
        0.0,
        lambda timestep: _FASTEST * timestep,
        "Gap at which a contact is seen, m, and kept from closing by more within the step.",
    ),
    Setting(
        "correction", 0.2, 1.0, "Share of an overlap taken away in a step; of this adapter's step."
    ),
    ETA_SETTING,
)

VARIANTS = (
    *COMMON,
    Variant.of("solver", ADMM),
    *(
        Variant(
            name=f"{count} iterations at most",
            settings=(("max_iterations", count),),
            thorough=count != 5,  # noqa: PLR2004 - the middle one
        )
        for count in (2, 5, 20)
    ),
    Variant(name="contacts by overlap", settings=(("security_margin", 0.0),)),
    Variant.of("correction", 0.2, thorough=True),
)

MODEL_DIFFERENCES = (
    ModelDifference(
        name="contact margin",
        settings=("security_margin",),
        sentence="A rim that the error of a step lifts off has no contact until it overlaps again.",
    ),
    ModelDifference(
        name="solver",
        settings=("solver", "tolerance"),
        sentence="Impulses are off by a millionth.",
    ),
    ModelDifference(
        name="overlap",
        settings=("correction",),
        sentence="An overlap is taken away over some steps.",
    ),
    ModelDifference(
        name="timestep",
        settings=(TIMESTEP,),
        sentence="Steps of 1 ms are long beside the bounce.",
    ),
)

_PRECISE = ("tolerance", 1e-15)

SOLVER_EFFORTS = (
    *(
        SolverEffort(
            name=f"{count} iteration{'s' if count > 1 else ''}",
            settings=(_PRECISE, ("max_iterations", count)),
        )
        for count in (1, 2, 5, 20)
    ),
    SolverEffort(name="tolerance 1e-6, as shipped", settings=(("tolerance", 1e-6),)),
    SolverEffort(name="converged", settings=(_PRECISE, ("max_iterations", 10_000))),
)
