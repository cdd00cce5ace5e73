"""The constants of the can and of its effects, each moved by an imaginary step.

Derivatives by them are exact to round-off, as those by the state
(`reference.analysis.linearisation`).
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from reference.analysis.linearisation import STEP, Quantity, UndecidedError
from reference.analysis.unilateral_tangents import UnilateralEquations
from reference.compliant.equations import CompliantEquations
from reference.equations.contact_laws import Mode
from reference.equations.newton_euler import GeneralEquations
from reference.integrable.frobenius import CanConstants
from reference.problem.can import Parameters
from reference.problem.effects import LINEAR, Compliance, Effects, Gravity, Mass, Restitution
from reference.problem.problem import Problem
from reference.problem.states import Floats


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


@dataclass(frozen=True, slots=True, kw_only=True)
class _SteppedRestitution(Restitution):
    def __post_init__(self) -> None:
        """Likewise."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _SteppedCompliance(Compliance):
    def __post_init__(self) -> None:
        """Likewise."""

    def depth_under(self, load: float) -> float:
        """Return the depth that bears a load, complex as the law is."""
        depth: Any = (load / self.stiffness) ** (1 / self.exponent)
        return depth  # type: ignore[no-any-return]


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
OF_COMPLIANCE = ("stiffness", "damping", "exponent")


def equations_of_contact(parameters: Parameters, effects: Effects) -> GeneralEquations:
    """Return the equations of a can on its contact, of the largest model that is declared."""
    if effects.restitution is not None:
        return UnilateralEquations(parameters=parameters, effects=effects)
    if effects.compliance is None:
        return GeneralEquations(parameters=parameters, effects=effects)
    return CompliantEquations(parameters=parameters, effects=effects, law=effects.compliance)


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
    if effects.compliance is not None:
        # a power of the depth has another damping than a linear contact
        names += [
            f"compliance.{name}"
            for name in OF_COMPLIANCE
            if name != "exponent" or effects.compliance.exponent > LINEAR
        ]
    if effects.restitution is not None and effects.restitution.coefficient > 0.0:
        # without restitution there is no sequence of impacts
        names.append("restitution.coefficient")
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
    elif effect == "compliance" and effects.compliance is not None:
        law: dict[str, Any] = {key: getattr(effects.compliance, key) for key in OF_COMPLIANCE}
        law[constant] += 1j * STEP
        values["compliance"] = _SteppedCompliance(**law)
    elif effect == "restitution" and effects.restitution is not None:
        given = effects.restitution
        moved: Any = given.coefficient + 1j * STEP
        values["restitution"] = _SteppedRestitution(coefficient=moved, law=given.law)
    else:
        values["gravity"] = _stepped_gravity(effects.gravity, effect, constant)
    parameters: Any = CanConstants(**{field: np.asarray(value) for field, value in can.items()})
    return equations_of_contact(parameters, _SteppedEffects(**values))


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


def by_varied(
    varied: Mapping[int, GeneralEquations], count: int, quantity: Quantity, y: Floats, mode: Mode
) -> Floats:
    """Return the derivatives of a quantity of states by numbers, at a fixed state.

    Parameters
    ----------
    varied : mapping of int to GeneralEquations
        With one of the numbers stepped each, by its place among them.
    count : int
        Of the numbers, m.
    quantity : Quantity
        Of shape (..., n).
    y : ndarray, shape (rows, n)
    mode : Mode

    Returns
    -------
    ndarray, shape (..., m, n)
        Not a number by what there is no derivative by.

    Raises
    ------
    UndecidedError
        If there is none by any of them.
    """
    slopes: dict[int, Floats] = {}
    reason = UndecidedError()
    for place, each in varied.items():
        try:
            slopes[place] = quantity(each, y.astype(complex), mode).imag / STEP
        except UndecidedError as error:
            reason = error
    if not slopes:
        raise reason
    shape = next(iter(slopes.values())).shape
    out = np.zeros((*shape[:-1], count, shape[-1]))
    for place in varied:
        out[..., place, :] = slopes.get(place, np.nan)
    return out
