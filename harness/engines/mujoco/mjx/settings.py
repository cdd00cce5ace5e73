"""MJX's settings that matter to a rolling can, what it ships with, and what `matched` takes.

They are those of MuJoCo that MJX takes, with the same values, and one of JAX: as shipped JAX
computes in single precision, and `matched` in double.
"""

from dataclasses import replace

from harness.engines import COMMON, ETA_SETTING, ModelDifference, Setting, SolverEffort, Variant
from harness.engines.mujoco import settings as of_mujoco
from harness.engines.mujoco.colliders import CYLINDER_ON_PLANE, OF_CCD

X64 = "jax_enable_x64"
"""JAX's own name of the switch to double precision."""

_CHOICES = {
    "integrator": ("Euler", "RK4", "implicitfast"),
    "solver": ("CG", "Newton"),
    "shapes": (CYLINDER_ON_PLANE, "mesh-plane", "mesh-box"),
}
"""Where MJX has fewer words than MuJoCo."""

_MEANINGS = {"shapes": "Shapes that MJX has functions for; a box is 600 m wide."}

_LEFT_OUT = {"noslip_iterations", "noslip_tolerance", "build", "mesh", *OF_CCD}
"""What MJX has no word for."""

SETTINGS = (
    Setting(
        X64,
        default=False,
        matched=True,
        meaning="Double precision instead of single; of JAX, which ships in single.",
    ),
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

SINGLE = ((X64, False),)

COLLIDERS = (
    Variant(name="double precision"),
    Variant(name="single precision", settings=SINGLE),
    Variant(name="mesh-plane", settings=(("shapes", "mesh-plane"),)),
    Variant(name="mesh-box of 600 m", settings=(("shapes", "mesh-box"),)),
)

VARIANTS = (
    *COMMON,
    Variant(name="single precision", settings=SINGLE, imposes="numbers of 24 bits"),
    Variant.of("integrator", "RK4"),
    Variant.of("cone", "pyramidal", imposes="a friction cone that is a pyramid"),
)

DIFFERENTIABLE = Variant.of("cone", "pyramidal")
"""What MJX differentiates: the elliptic cone's line search has a root of zero in it."""

MODEL_DIFFERENCES = (
    ModelDifference(
        name="precision",
        settings=(X64,),
        sentence="Numbers have 24 bits, and the direction of the rim is lost near the flat state.",
    ),
    *(
        replace(
            difference,
            settings=tuple(name for name in difference.settings if name not in _LEFT_OUT),
        )
        for difference in of_mujoco.MODEL_DIFFERENCES
    ),
)

SOLVER_EFFORTS: tuple[SolverEffort, ...] = of_mujoco.SOLVER_EFFORTS
