"""The choices of the reference, and the ways to solve a scene that are worth a row in a study."""

from harness.engines.base import Setting
from harness.engines.variants import Variant

SETTINGS = (
    Setting(
        name="model",
        default="auto",
        matched="auto",
        meaning="Which equations; auto takes the smallest that carries the scene.",
    ),
    Setting(
        name="method",
        default="auto",
        matched="auto",
        meaning="How they are integrated; auto takes the model's own method.",
    ),
    Setting(
        name="rtol",
        default=1e-12,
        matched=1e-12,
        meaning="Relative tolerance of the integrator.",
    ),
)

_TOLERANCES = (1e-3, 1e-6, 1e-9, 1e-12)

WITHOUT_LOCUS = frozenset({"reduced", "asymptotic"})
"""Models that know the angles alone."""

VARIANTS = (
    Variant(name="exact bounce", settings=(("model", "exact"),), along=""),
    Variant(name="fast integrator", settings=(("model", "rolling"),), along=""),
    *(
        Variant(
            name=f"rolling, {method}",
            settings=(("model", "rolling"), ("method", method)),
            along="rtol",
            values=_TOLERANCES,
            thorough=method not in {"DOP853", "LSODA"},
        )
        for method in ("RK45", "DOP853", "LSODA", "Radau", "BDF")
    ),
    *(
        Variant(
            name=f"{model} model",
            settings=(("model", model),),
            along="",
            imposes="the terms that the model leaves out: model form",
        )
        for model in ("reduced", "asymptotic")
    ),
)
"""Ways to solve a scene; an implicit method in the raw variables is slow where it is stiff."""
