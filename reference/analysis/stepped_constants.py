"""The constants of the can and of its effects, each moved by an imaginary step.

Derivatives by them are exact to round-off, as those by the state
(`reference.analysis.linearisation`).
"""

from collections.abc import Mapping
from dataclasses import fields
from typing import Any, TypeVar

import numpy as np

from reference.analysis.linearisation import STEP, Quantity, UndecidedError
from reference.analysis.unilateral_tangents import UnilateralEquations
from reference.compliant.equations import CompliantEquations
from reference.equations.contact_laws import Mode
from reference.equations.newton_euler import GeneralEquations
from reference.integrable.frobenius import CanConstants
from reference.problem.can import Parameters
from reference.problem.effects import LINEAR, Effects, Gravity
from reference.problem.problem import Problem
from reference.problem.states import Floats

Constants = TypeVar("Constants")

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
    can: dict[str, Any] = {field: getattr(p, field) for field in ("a", "c", "h")}
    effect, _, constant = name.partition(".")
    if name in can:
        can[name] += 1j * STEP
    elif name in SCALARS:
        effects = _moved(effects, SCALARS[name])
    elif effect == "point_mass":
        effects = _changed(effects, mass=_moved(effects.mass, OF_MASS[constant]))
    elif effect in {"compliance", "restitution"}:
        effects = _changed(effects, **{effect: _moved(getattr(effects, effect), constant)})
    else:
        effects = _changed(effects, gravity=_stepped_gravity(effects.gravity, effect, constant))
    parameters: Any = CanConstants(**{field: np.asarray(value) for field, value in can.items()})
    return equations_of_contact(parameters, effects)


def _moved(given: Constants, name: str) -> Constants:
    """Return constants of which one is moved by an imaginary step."""
    return _changed(given, **{name: getattr(given, name) + 1j * STEP})


def _changed(given: Constants, **changes: object) -> Constants:
    """Return constants of which some are changed, to what their class would refuse as complex."""
    copy = object.__new__(type(given))
    for field in fields(given):  # type: ignore[arg-type] # each is a dataclass
        value = changes.get(field.name, getattr(given, field.name))
        object.__setattr__(copy, field.name, value)
    return copy


def _stepped_gravity(gravity: Gravity, effect: str, constant: str) -> Gravity:
    if effect == "tilt":
        x, y, z = gravity.constant
        level = float(np.hypot(x, y))
        turned = (
            (-y, x, 0.0) if constant == "direction" else (-z * x / level, -z * y / level, level)
        )
        pairs = zip(gravity.constant, turned, strict=True)
        return _changed(gravity, constant=tuple(old + 1j * STEP * new for old, new in pairs))
    if constant in {"rate", "phase"}:
        return _moved(gravity, constant)
    axes = [1j * STEP * (constant == axis) for axis in "xyz"]
    amplitude = tuple(old + new for old, new in zip(gravity.amplitude, axes, strict=True))
    return _changed(gravity, amplitude=amplitude)


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
