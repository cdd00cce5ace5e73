"""The constants of the can and of its effects, each moved by an imaginary step.

Derivatives by them are exact to round-off, as those by the state
(`reference.analysis.linearisation`).
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from reference.analysis.linearisation import STEP
from reference.equations.newton_euler import GeneralEquations
from reference.integrable.frobenius import CanConstants
from reference.problem.effects import Effects, Gravity, Mass
from reference.problem.problem import Problem


@dataclass(frozen=True, slots=True, kw_only=True)
class _SteppedEffects(Effects):
    def __post_init__(self) -> None:
        """Take constants that were accepted before, and are stepped into the complex plane."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _SteppedGravity(Gravity):
    def __post_init__(self) -> None:
        """Likewise."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _SteppedMass(Mass):
    def __post_init__(self) -> None:
        """Likewise."""


SCALARS = {
    "slip.mu": "mu",
    "slip.mu_static": "mu_static",
    "slip.patch": "patch",
    "drilling.length": "drilling",
    "rolling_resistance.length": "rolling_resistance",
    "damping.linear": "linear_damping",
    "damping.angular": "angular_damping",
    "rim.radius": "rim",
    "contour_friction.coulomb": "contour",
    "contour_friction.viscous": "contour_damping",
    "air_film.film": "film",
    "air_film.boundary_layer": "boundary_layer",
}
"""Constants of effects that are one number of `Effects` each; of air as the equations have it."""
NOT_AT_ZERO = frozenset(
    {"slip.patch", "contour_friction.coulomb", "air_film.film", "air_film.boundary_layer"}
)
"""Those by which there is no derivative at zero: another law holds there."""
OF_MASS = {"mass": "share", "x": "x", "y": "y", "z": "z"}
OF_SHAKING = ("x", "y", "z", "rate", "phase")


def constants(effects: Effects) -> tuple[str, ...]:
    """Return the constants of the declared effects, by the keys of a scene file, dimensionless."""
    declared = effects.declared()
    absent = {name for name in NOT_AT_ZERO if getattr(effects, SCALARS[name]) == 0.0}
    if effects.mu_static is None:
        absent.add("slip.mu_static")
    names = [name for name in SCALARS if name.split(".")[0] in declared and name not in absent]
    if "tilt" in declared:
        names += ["tilt.angle", "tilt.direction"]
    if "shake" in declared:
        names += [f"shake.{name}" for name in OF_SHAKING]
    if "point_mass" in declared:
        names += [f"point_mass.{name}" for name in OF_MASS]
    return tuple(names)


def stepped(problem: Problem, name: str) -> GeneralEquations:
    """Return the equations of a problem with one constant moved by an imaginary step."""
    p, effects = problem.parameters, problem.effects
    values: dict[str, Any] = {field: getattr(effects, field) for field in Effects.__slots__}
    can: dict[str, Any] = {field: getattr(p, field) for field in ("a", "c", "h")}
    effect, _, constant = name.partition(".")
    if name in can:
        can[name] += 1j * STEP
    elif name in SCALARS:
        values[SCALARS[name]] += 1j * STEP
    elif effect == "point_mass" and effects.mass is not None:
        mass: dict[str, Any] = {field: getattr(effects.mass, field) for field in Mass.__slots__}
        mass[OF_MASS[constant]] += 1j * STEP
        values["mass"] = _SteppedMass(**mass)
    else:
        values["gravity"] = _stepped_gravity(effects.gravity, effect, constant)
    parameters: Any = CanConstants(**{field: np.asarray(value) for field, value in can.items()})
    return GeneralEquations(parameters=parameters, effects=_SteppedEffects(**values))


def _stepped_gravity(gravity: Gravity, effect: str, constant: str) -> Gravity:
    values: dict[str, Any] = {field: getattr(gravity, field) for field in Gravity.__slots__}
    if effect == "tilt":
        x, y, z = gravity.constant
        level = float(np.hypot(x, y))
        turned = (
            (-y, x, 0.0) if constant == "direction" else (-z * x / level, -z * y / level, level)
        )
        pairs = zip(gravity.constant, turned, strict=True)
        values["constant"] = tuple(old + 1j * STEP * new for old, new in pairs)
    elif constant in {"rate", "phase"}:
        values[constant] += 1j * STEP
    else:
        steps = [1j * STEP * (constant == axis) for axis in "xyz"]
        values["amplitude"] = tuple(
            old + new for old, new in zip(gravity.amplitude, steps, strict=True)
        )
    return _SteppedGravity(**values)
