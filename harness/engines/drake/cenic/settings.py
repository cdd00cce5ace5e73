"""What a continuous plant of Drake ships with, and what `matched` takes.

CENIC solves the convex problem of the discrete plant at steps that it chooses: the difference of
one step and two halves of it is kept below `accuracy`. Its contacts are springs of the plant's
`point_stiffness` with friction of the present load; `matched` makes them stiff, since what is left
of a spring is model form, and no accuracy takes it away.

The differences between Drake as shipped and matched are in the order in which they are removed: the
geometry of the contact, its law, the accuracy last.
"""

import math
from collections.abc import Mapping

from harness.engines import FRICTIONS, Case, ModelDifference, Setting, Value, Variant
from harness.engines.drake.cenic import DESCRIPTION
from harness.engines.drake.settings import GROUND, STICTION, sliding_stiffness

SETTINGS = (
    Setting(
        "accuracy",
        1e-4,
        1e-8,
        "Error allowed in a step, of angles in rad and of lengths in m.",
        positive=True,
    ),
    Setting("max_step_size", 0.1, 0.01, "Longest step, s.", positive=True),
    STICTION,
    Setting(
        "point_stiffness",
        1e6,
        1e12,
        "Stiffness of each geometry, N/m; that of the contact is half of it.",
        positive=True,
    ),
    Setting.as_shipped("hunt_crossley_dissipation", 50.0, "Damping over the spring's force, s/m."),
    GROUND,
)

OF_THE_INTEGRATOR = ("accuracy", "max_step_size")


def imposed_in(case: Case, chosen: Mapping[str, Value]) -> dict[str, float]:
    """Return the rows of parity in which it goes its own way, each with its share.

    The load of the last step bounds friction, and of a stiff contact that load is round-off. Of one
    into which a can sinks it is known to a thousandth, or to a fifth where nothing presses. As
    shipped a speed is solved for to a few parts in 1e9: of a fast can's the gain by a tilt is lost.
    """
    scene = case.scene
    shipped = {"speed kept": 1e-8} if case.profile == "default" else {}
    if case.profile == "default" or chosen["point_stiffness"] > sliding_stiffness(scene):  # type: ignore[operator] # a number
        return dict.fromkeys(FRICTIONS, math.inf) | shipped
    return dict.fromkeys(FRICTIONS, 1e-3 if scene.gravity > 0.0 else 0.2)


def for_effects(case: Case) -> dict[str, Value]:
    """Return the settings that the effects of a scene decide: a can that slides sinks a little."""
    slides = case.scene.effects.slip is not None and case.profile != "default"
    return {"point_stiffness": sliding_stiffness(case.scene)} if slides else {}


VARIANTS = (
    Variant(
        name="as shipped",
        profile="default",
        along="accuracy",
        values=DESCRIPTION.accuracies,
        imposes="everything that the engine ships with",
    ),
    Variant(name="matched", along="accuracy", values=DESCRIPTION.accuracies),
    Variant(
        name="half-space",
        settings=(("ground", "HalfSpace"),),
        along="accuracy",
        values=DESCRIPTION.accuracies,
        imposes="a contact at the middle of the base below 4.5e-4 rad",
        thorough=True,
    ),
)

MODEL_DIFFERENCES = (
    ModelDifference(
        name="ground",
        settings=("ground",),
        sentence="On a half-space the contact of a nearly flat can is the middle of its base.",
    ),
    ModelDifference(
        name="spring",
        settings=("point_stiffness",),
        sentence="The contact is a spring of 5e5 N/m.",
    ),
    ModelDifference(
        name="accuracy",
        settings=("accuracy", "max_step_size"),
        sentence="A ten thousandth of a radian may be missed in every step.",
    ),
)
