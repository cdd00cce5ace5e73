"""Problems with one number changed, of which differences are taken."""

import math
from dataclasses import replace

from reference import Gravity, Problem
from reference.analysis.stepped_constants import SCALARS

RELEASE = ("phi", "phi_dot", "psi_dot", "theta_dot")


def varied(problem: Problem, name: str, by: float) -> Problem:
    """Return a problem with one number changed."""
    effects = problem.effects
    if name in {*RELEASE, "height"}:
        return replace(problem, **{name: getattr(problem, name) + by})
    if name in {"a", "c", "h"}:
        can = replace(problem.parameters, **{name: getattr(problem.parameters, name) + by})
        return replace(problem, parameters=can)
    if name in SCALARS:
        field = SCALARS[name]
        return replace(problem, effects=replace(effects, **{field: getattr(effects, field) + by}))
    effect, _, key = name.partition(".")
    if effect in {"compliance", "restitution", "point_mass"}:
        field = "mass" if effect == "point_mass" else effect
        law, key = getattr(effects, field), "share" if key == "mass" else key
        law = replace(law, **{key: getattr(law, key) + by})
        return replace(problem, effects=replace(effects, **{field: law}))
    if effect == "shake":
        return replace(problem, effects=replace(effects, gravity=_shaken(effects.gravity, key, by)))
    x, y, z = effects.gravity.constant
    angle, direction = math.atan2(math.hypot(x, y), -z), math.atan2(y, x)
    angle, direction = angle + by * (name == "tilt.angle"), direction + by * (name != "tilt.angle")
    gravity = replace(effects.gravity, constant=tilted(angle, direction).constant)
    return replace(problem, effects=replace(effects, gravity=gravity))


def tilted(angle: float, direction: float) -> Gravity:
    """Return the gravity of a plane that is tilted by an angle, down in a direction."""
    down = math.sin(angle)
    level = (down * math.cos(direction), down * math.sin(direction))
    return Gravity(constant=(*level, -math.cos(angle)))


def _shaken(gravity: Gravity, key: str, by: float) -> Gravity:
    if key in {"rate", "phase"}:
        return replace(gravity, **{key: getattr(gravity, key) + by})
    x, y, z = (a + by * (key == axis) for a, axis in zip(gravity.amplitude, "xyz", strict=True))
    return replace(gravity, amplitude=(x, y, z))
