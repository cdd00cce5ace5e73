"""Parameters of a scene that a sweep may vary: names as in a scene file, units, ranges, setting.

A can whose mass or radius varies keeps its groups a, c and h: it is the same can in another size.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from types import MappingProxyType
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from harness.core.errors import InvalidSettingError
from models.can import Can
from models.effects import KINDS, Effects
from models.scene import MOST_BOUNCES, Horizon, Scene

Floats = NDArray[np.float64]
Number = TypeVar("Number", float, Floats)


_UNITS = {"rad_s": "rad/s", "m_s2": "m/s^2", "kg_m2": "kg m^2", "n_m": "N/m", "ns_m": "N s/m"}
_UNITS |= {"per_s": "1/s", "hz": "Hz", "pa_s": "Pa s", "kg_m3": "kg/m^3"}
"""Units by the suffix of a column, where the two differ."""


@dataclass(frozen=True, slots=True)
class Parameter:
    """A number of a scene.

    Parameters
    ----------
    name : str
        As a scene file has it, tables and keys joined by dots.
    suffix : str
        Unit at the end of the name of its column; empty for a ratio.
    low, high : float
        Exclusive bounds.
    whole : bool
        Whether it is a count, with whole values alone.
    """

    name: str
    suffix: str
    low: float = -math.inf
    high: float = math.inf
    whole: bool = False

    @property
    def column(self) -> str:
        """Name of its column in a sweep, unit last."""
        stem = self.name.replace(".", "_")
        return f"{stem}_{self.suffix}" if self.suffix else stem

    @property
    def unit(self) -> str:
        """Unit on the axis of a figure; empty for a ratio."""
        return _UNITS.get(self.suffix, self.suffix)


_OF_EFFECTS = {
    "compliance.stiffness": "n_m",
    "compliance.damping": "ns_m",
    "slip.patch": "m",
    "drilling.length": "m",
    "rolling_resistance.length": "m",
    "contour_friction.viscous": "ns_m",
    "air_film.viscosity": "pa_s",
    "air_film.density": "kg_m3",
    "rim.radius": "m",
    "damping.linear": "per_s",
    "damping.angular": "per_s",
    "tilt.angle": "rad",
    "tilt.direction": "rad",
    "shake.frequency": "hz",
    "shake.horizontal": "m",
    "shake.vertical": "m",
    "shake.direction": "rad",
    "shake.phase": "rad",
    "point_mass.mass": "kg",
    "point_mass.x": "m",
    "point_mass.y": "m",
    "point_mass.z": "m",
}
"""Suffixes of the constants of effects; a constant that is not here is a ratio."""

_ALL = (
    Parameter("gravity", "m_s2", -math.ulp(0.0)),  # zero is allowed
    Parameter("can.mass", "kg", 0.0),
    Parameter("can.radius", "m", 0.0),
    Parameter("can.a", "", 0.0),
    Parameter("can.c", "", 0.0),
    Parameter("can.h", "", 0.0),
    Parameter("can.A", "kg_m2", 0.0),
    Parameter("can.C", "kg_m2", 0.0),
    Parameter("can.H", "m", 0.0),
    Parameter("release.phi", "rad", 0.0, math.pi / 2.0),
    Parameter("release.psi", "rad"),
    Parameter("release.theta", "rad"),
    Parameter("release.phi_dot", "rad_s"),
    Parameter("release.psi_dot", "rad_s"),
    Parameter("release.theta_dot", "rad_s"),
    Parameter("release.height", "m"),
    Parameter("horizon.bounces", "", 0.0, MOST_BOUNCES + 1.0, whole=True),
    Parameter("horizon.seconds", "s", 0.0),
    *(
        Parameter(f"effects.{effect}.{each.name}", _OF_EFFECTS.get(f"{effect}.{each.name}", ""))
        for effect, kind in KINDS.items()
        for each in fields(kind)
        if each.type in {float, float | None, "float"}
    ),
)

PARAMETERS: Mapping[str, Parameter] = MappingProxyType({each.name: each for each in _ALL})
"""Every parameter by name."""


def check_range(name: str, low: float, high: float) -> None:
    """Refuse an unknown parameter, or a range beyond the values that a scene can have.

    Raises
    ------
    InvalidSettingError
    """
    if name not in PARAMETERS:
        raise InvalidSettingError("--over", name, ", ".join(PARAMETERS))
    known = PARAMETERS[name]
    for end in (low, high):
        if not (math.isfinite(end) and known.low < end < known.high):
            above = "zero or greater" if -1.0 < known.low < 0.0 else f"greater than {known.low:g}"
            allowed = "a finite number" if math.isinf(known.low) else above
            if math.isfinite(known.high):
                allowed += f" and less than {known.high:.6g}"
            raise InvalidSettingError(f"--over {name}", end, allowed)


def dimensions(can: Can, values: Mapping[str, Number]) -> dict[str, Number | float]:
    """Return mass, radius, a, c and h of a can with some of its parameters replaced."""
    numbers: dict[str, Number | float] = {}
    mass = numbers["mass"] = values.get("can.mass", can.mass)
    radius = numbers["radius"] = values.get("can.radius", can.radius)
    for group, si in (("a", "A"), ("c", "C"), ("h", "H")):
        numbers[group] = values.get(f"can.{group}", getattr(can, group))
        if f"can.{si}" in values:
            unit = radius if group == "h" else mass * radius * radius
            numbers[group] = values[f"can.{si}"] / unit
    return numbers


def scene_at(scene: Scene, values: Mapping[str, float]) -> Scene:
    """Return a scene with some of its parameters replaced.

    Raises
    ------
    ModelError
        If no scene has these values together.
    """
    parts: dict[str, dict[str, float]] = {"can": {}, "release": {}, "horizon": {}}
    effects = scene.effects
    for name, value in values.items():
        table, _, key = name.partition(".")
        if table == "effects":
            effect, _, constant = key.partition(".")
            effects = _with(effects, effect, constant, value)
        elif key:
            parts[table][key] = value
    return replace(
        scene,
        gravity=values.get("gravity", scene.gravity),
        can=Can.from_groups(**dimensions(scene.can, values)) if parts["can"] else scene.can,
        release=replace(scene.release, **parts["release"]),
        effects=effects,
        horizon=_until(**parts["horizon"]) if parts["horizon"] else scene.horizon,
    )


def _until(bounces: float | None = None, seconds: float | None = None) -> Horizon:
    """Return a horizon of so many bounces, or of a time."""
    return Horizon(bounces=None if bounces is None else round(bounces), seconds=seconds)


def _with(effects: Effects, name: str, key: str, value: float) -> Effects:
    """Return effects with a constant of an effect replaced; an absent effect is created with it."""
    declared = getattr(effects, name)
    changed = KINDS[name](**{key: value}) if declared is None else replace(declared, **{key: value})
    return replace(effects, **{name: changed})
