"""Problems with one number changed, of which differences are taken."""

import math
from dataclasses import replace

from reference import Gravity, Problem
from reference.analysis.stepped_constants import SCALARS

RELEASE = ("phi", "phi_dot", "psi_dot", "theta_dot")


def varied(problem: Problem, name: str, by: float) -> Problem:
    """Return a problem with one number changed."""
    effects, mass = problem.effects, problem.effects.mass
    if name in RELEASE:
        return replace(problem, **{name: getattr(problem, name) + by})
    if name in {"a", "c", "h"}:
        can = replace(problem.parameters, **{name: getattr(problem.parameters, name) + by})
        return replace(problem, parameters=can)
    if name in SCALARS:
        field = SCALARS[name]
        return replace(problem, effects=replace(effects, **{field: getattr(effects, field) + by}))
    if name.startswith("point_mass."):
        assert mass is not None
        field = name.removeprefix("point_mass.").replace("mass", "share")
        mass = replace(mass, **{field: getattr(mass, field) + by})
        return replace(problem, effects=replace(effects, mass=mass))
    x, y, z = effects.gravity.constant
    angle, direction = math.atan2(math.hypot(x, y), -z), math.atan2(y, x)
    angle, direction = angle + by * (name == "tilt.angle"), direction + by * (name != "tilt.angle")
    return replace(problem, effects=replace(effects, gravity=tilted(angle, direction)))


def tilted(angle: float, direction: float) -> Gravity:
    """Return the gravity of a plane that is tilted by an angle, down in a direction."""
    down = math.sin(angle)
    level = (down * math.cos(direction), down * math.sin(direction))
    return Gravity(constant=(*level, -math.cos(angle)))
