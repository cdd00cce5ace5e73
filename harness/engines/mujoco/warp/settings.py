"""MuJoCo Warp's settings that matter to a rolling can, as it ships and as `matched` takes them.

They are those of MuJoCo that MuJoCo Warp takes, with the same values. It raises a tolerance below
1e-6 to 1e-6, since it computes in single precision.
"""

from dataclasses import replace

from harness.engines import COMMON, ETA_SETTING, SolverEffort, Variant
from harness.engines.mujoco import settings as of_mujoco
from harness.engines.mujoco.colliders import CYLINDER_ON_PLANE, OF_CCD

_CHOICES = {
    "solver": ("CG", "Newton"),
    "shapes": (CYLINDER_ON_PLANE, "mesh-plane", "cylinder-box", "mesh-box"),
}
"""Where MuJoCo Warp has fewer words than MuJoCo."""

_MEANINGS = {"shapes": "Shapes that MuJoCo Warp has pairs for; a box is 10 m wide."}

_LEFT_OUT = {"build", "mesh", *OF_CCD}
"""Words of the adapter of MuJoCo alone."""

SETTINGS = (
    *(
        replace(
            setting,
            choices=_CHOICES.get(setting.name, setting.choices),
            meaning=_MEANINGS.get(setting.name, setting.meaning),
        )
        for setting in of_mujoco.SETTINGS
        if setting.name not in _LEFT_OUT and setting is not ETA_SETTING
    ),
    ETA_SETTING,
)

COLLIDERS = (
    Variant(name=CYLINDER_ON_PLANE),
    Variant(name="mesh-plane", settings=(("shapes", "mesh-plane"),)),
    Variant(name="cylinder-box of 10 m", settings=(("shapes", "cylinder-box"),)),
    Variant(name="mesh-box of 10 m", settings=(("shapes", "mesh-box"),)),
)

VARIANTS = (
    *COMMON,
    Variant.of("integrator", "RK4"),
    Variant.of("cone", "pyramidal", imposes="a friction cone that is a pyramid"),
    Variant(name="1 solver iteration", settings=(("iterations", 1),)),
)

MODEL_DIFFERENCES = tuple(
    replace(
        difference, settings=tuple(name for name in difference.settings if name not in _LEFT_OUT)
    )
    for difference in of_mujoco.MODEL_DIFFERENCES
)

LEAST_TOLERANCE = 1e-6
"""What MuJoCo Warp makes of a tolerance that is smaller."""

SOLVER_EFFORTS = (
    *(
        SolverEffort(
            name=f"{count} iteration{'s' if count > 1 else ''}", settings=(("iterations", count),)
        )
        for count in (1, 2, 3)
    ),
    SolverEffort(name="tolerance 1e-4", settings=(("tolerance", 1e-4),)),
    SolverEffort(name="converged", settings=(("tolerance", LEAST_TOLERANCE), ("iterations", 200))),
)
