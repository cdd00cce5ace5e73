"""Derivatives of the exact first bounce by the keys of a scene, in their units.

Everything is dimensionless in `reference`: lengths in R, times in T = sqrt(R/g). Gravity and radius
act through these units alone, so that derivatives by them follow from those by all else.
"""

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, fields

import numpy as np

from harness.engines.reference.to_reference_problem import Releases, problem, refusal
from harness.engines.world import Floats
from models.scene import Scene
from reference.analysis.nutation_tangents import nutation_tangents
from reference.analysis.sensitivity import sensitivity
from reference.integrable.derivatives import QUANTITIES, batch_tangents
from reference.integrable.tangents import BY
from reference.numerics.jets import Jet, jet_cos, jet_exp, jet_log, jet_sin, jet_sqrt

NAMES = {
    "period": "period_s",
    "angle_of_turn": "angle_of_turn_deg",
    "phi_min": "phi_min_rad",
    "peak_psi_dot": "peak_psi_dot_rad_s",
    "peak_friction_ratio": "peak_friction_ratio",
}
"""Quantities of the reference, by their keys in answers."""

_UNITS = {"period": (1.0, 1), "angle_of_turn": (180.0 / np.pi, 0), "peak_psi_dot": (1.0, -1)}
"""Units of the quantities that have one: a factor, and the power of the natural time."""

RELEASE = ("phi", "psi_dot", "theta_dot", "phi_dot")
CAN = ("a", "c", "h", "radius")
SHAKE = ("frequency", "horizontal", "vertical", "direction", "phase")
_RATES = ("phi_dot", "psi_dot", "theta_dot")
OTHER_LAW_AT = {
    "effects.contour_friction.coulomb": 0.0,
    "effects.air_film.density": 0.0,
    "effects.compliance.exponent": 1.0,
    "effects.restitution.coefficient": 0.0,
}
"""Keys by which there is no derivative where they have these values."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Derivatives:
    """Derivatives of the first bounce of a scene.

    Parameters
    ----------
    slopes : mapping
        For each quantity the derivative by each key of the scene, in the units of both; None where
        there is none.
    why : mapping of str to str
        Why there is none, by quantity.
    method : str
        How they were computed.
    caveats : tuple of str
        Sentences: which are of one side, that those beside a separatrix are large, and by what
        there are none.
    """

    slopes: Mapping[str, Mapping[str, float | None]]
    why: Mapping[str, str]
    method: str
    caveats: tuple[str, ...]


def derivatives_of(scene: Scene) -> Derivatives:
    """Return the derivatives of the first bounce of a scene by its own numbers."""
    numbers = scene_numbers(scene)
    reason = refusal(scene)
    if reason:
        none: dict[str, float | None] = dict.fromkeys(numbers)
        return Derivatives(
            slopes=dict.fromkeys(NAMES.values(), none),
            why=dict.fromkeys(NAMES.values(), reason),
            method="none",
            caveats=(),
        )
    own = sensitivity(problem(scene))
    by_key, time = _dimensionless(scene, numbers)
    by_scene = np.stack([by_key[each].slope for each in own.by])
    slopes: dict[str, Mapping[str, float | None]] = {}
    absent = {key: value for key, value in OTHER_LAW_AT.items() if numbers.get(key) == value}
    for name in QUANTITIES:
        scale, power = _UNITS.get(name, (1.0, 0))
        unit = scale * time.value**power
        unknown = ~np.isfinite(own.derivatives[name])
        slope = unit * np.where(unknown, 0.0, own.derivatives[name]) @ by_scene
        slope[by_scene[unknown].any(axis=0)] = np.nan
        slope = slope + own.values[name] * power * unit / time.value * time.slope
        slopes[NAMES[name]] = {
            key: float(each) if np.isfinite(each) and key not in absent else None
            for key, each in zip(numbers, slope, strict=True)
        }
    known = len(own.why) < len(NAMES)
    caveats = [
        f"By {key} there is no derivative where it is {value:g}: another law holds there."
        for key, value in absent.items()
    ]
    return Derivatives(
        slopes=slopes,
        why={NAMES[name]: sentence for name, sentence in own.why.items()},
        method=own.method,
        caveats=(*own.caveats, *caveats) if known else (),
    )


def nutation_derivatives(scene: Scene, times: Floats) -> list[dict[str, float | None]]:
    """Return the derivatives of phi at fixed times by a scene's own numbers.

    Parameters
    ----------
    scene : Scene
        That the reference carries.
    times : ndarray, shape (n,)
        s, ascending.

    Returns
    -------
    list of dict
        For each time by key, in rad over the unit of the key; None after the motion has ended.
    """
    by_key, time = _dimensionless(scene, numbers := scene_numbers(scene))
    by, rates, slopes = nutation_tangents(problem(scene), times / time.value)
    own = slopes @ np.stack([by_key[each].slope for each in by])
    # a fixed time in seconds is another one in units that change
    own = own - np.outer(rates * times / time.value**2, time.slope)
    return [
        {
            key: float(each) if np.isfinite(each) else None
            for key, each in zip(numbers, row, strict=True)
        }
        for row in own
    ]


def many_derivatives(
    releases: Releases, gravity: Floats, radius: Floats, names: Collection[str]
) -> dict[tuple[str, str], Floats]:
    """Return the derivatives of whole bounces of many releases of ideal cans.

    Parameters
    ----------
    releases : Releases
    gravity, radius : ndarray, shape () or (n,)
        Of the scenes, in SI units.
    names : collection of str
        Which of the values of `NAMES`.

    Returns
    -------
    dict of (str, str) to ndarray, shape (n,)
        By quantity and key of the scene, in the units of both; not a number where there is none.
    """
    shape = np.broadcast_shapes(*(np.shape(value) for value in releases.numbers.values()))
    given = {
        name: np.broadcast_to(value, shape).ravel() for name, value in releases.numbers.items()
    }
    time = np.broadcast_to(releases.time, shape).ravel()
    wanted = [name for name in QUANTITIES if NAMES[name] in names]
    out: dict[tuple[str, str], Floats] = {}
    for name, jet in batch_tangents(wanted, **{key: given[key] for key in BY}).items():
        scale, power = _UNITS.get(name, (1.0, 0))
        unit = scale * time**power
        by = {key: unit * jet.slope[:, place] for place, key in enumerate(BY)}
        by_time = power * unit / time * jet.value
        by_time += sum(by[rate] * given[rate] / time for rate in _RATES)
        columns = {f"release.{key}": by[key] * (time if key in _RATES else 1) for key in RELEASE}
        columns |= {f"can.{key}": by[key] for key in ("a", "c", "h")}
        columns["can.radius"] = by_time * time / (2 * radius)
        columns["gravity"] = -by_time * time / (2 * gravity)
        out |= {(NAMES[name], key): column for key, column in columns.items()}
    return out


def scene_numbers(scene: Scene) -> dict[str, float]:
    """Return the numbers of a scene by which derivatives are taken, by their keys in its file."""
    release, can = scene.release, scene.can
    out = {f"release.{name}": getattr(release, name) for name in RELEASE}
    if release.height > 0.0:
        out["release.height"] = release.height
    out |= {f"can.{name}": getattr(can, name) for name in CAN} | {"gravity": scene.gravity}
    for name in scene.effects.declared():
        effect = getattr(scene.effects, name)
        for field in fields(effect):
            value = getattr(effect, field.name)
            if isinstance(value, float):
                out[f"effects.{name}.{field.name}"] = value
    return out


def _dimensionless(scene: Scene, numbers: Mapping[str, float]) -> tuple[dict[str, Jet], Jet]:
    """Return the numbers of a scene's problem, and its natural time, in jets by the scene's own.

    Parameters
    ----------
    scene : Scene
    numbers : mapping of str to float
        Of `scene_numbers`.

    Returns
    -------
    dict of str to Jet
        By the names of `reference.analysis.sensitivity.Sensitivity.by`.
    Jet
        s.
    """
    unit = np.eye(len(numbers))
    jets = {
        key: Jet(np.asarray(value), unit[place])
        for place, (key, value) in enumerate(numbers.items())
    }
    R, g = jets["can.radius"], jets["gravity"]
    T = jet_sqrt(R / g)
    out = {"phi": jets["release.phi"]}
    out |= {name: T * jets[f"release.{name}"] for name in _RATES}
    out |= {name: jets[f"can.{name}"] for name in "ach"}
    if "release.height" in jets:
        out["height"] = jets["release.height"] / R
    scaled: dict[str, Callable[[Jet], Jet]] = {
        "slip.mu": lambda x: x,
        "slip.mu_static": lambda x: x,
        "slip.patch": lambda x: x / R,
        "drilling.length": lambda x: x / R,
        "rolling_resistance.length": lambda x: x / R,
        "damping.linear": lambda x: x * T,
        "damping.angular": lambda x: x * T,
        "rim.radius": lambda x: x / R,
        "contour_friction.coulomb": lambda x: x,
        "contour_friction.viscous": lambda x: x * T / scene.can.mass,
        "restitution.coefficient": lambda x: x,
        "tilt.angle": lambda x: x,
        "tilt.direction": lambda x: x,
        "point_mass.mass": lambda x: x / scene.can.mass,
        "point_mass.x": lambda x: x / R,
        "point_mass.y": lambda x: x / R,
        "point_mass.z": lambda x: x / R,
    }
    for key, scale in scaled.items():
        if f"effects.{key}" in jets:
            out[key] = scale(jets[f"effects.{key}"])
    if scene.effects.compliance is not None:
        stiffness, damping, n = (
            jets[f"effects.compliance.{name}"] for name in ("stiffness", "damping", "exponent")
        )
        weight = scene.can.mass * g
        power = jet_exp(n * jet_log(R)) / weight
        out["compliance.stiffness"] = stiffness * power
        if scene.effects.compliance.linear:
            out["compliance.damping"] = damping * R / weight / T
        else:
            out["compliance.damping"] = damping * power * R / T
            out["compliance.exponent"] = n
    if scene.effects.air_film is not None:
        viscosity, density = (jets[f"effects.air_film.{name}"] for name in ("viscosity", "density"))
        film = np.pi / 4 / scene.can.mass * viscosity * R * T
        if density.value == 0.0:
            out["air_film.film"] = film
        else:
            out["air_film.boundary_layer"] = film * R / jet_sqrt(viscosity * T / density)
    if scene.effects.shake is not None:
        shake = {field: jets[f"effects.shake.{field}"] for field in SHAKE}
        rate = 2 * np.pi * shake["frequency"]
        push = rate * rate / g
        level, across = push * shake["horizontal"], shake["direction"]
        out["shake.x"], out["shake.y"] = level * jet_cos(across), level * jet_sin(across)
        out["shake.z"] = push * shake["vertical"]
        out["shake.rate"], out["shake.phase"] = rate * T, shake["phase"]
    return out, T
