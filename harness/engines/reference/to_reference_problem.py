"""A scene, or many releases at once, as the reference poses them, dimensionless.

Lengths are in R, times in sqrt(R/g). Releases of many cans are solved together by the exact bounce:
a formula for whole arrays of releases has no trajectory and is no engine.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from harness.core.simulation import Outcome
from harness.engines.stepping.horizon import natural_time
from harness.engines.world import Floats
from models.contact_effects import Restitution as ImpactLaw
from models.scene import Scene
from reference import (
    Compliance,
    Effects,
    Gravity,
    Mass,
    Parameters,
    Problem,
    Restitution,
    carries,
    exact_bounces,
)
from reference import Outcome as Ending
from reference.integrable.frobenius import CanConstants, frobenius_series, horner, terms_needed
from reference.integrable.turning_points import OUTCOMES
from reference.numerics.compiled import available
from reference.problem.problem import LEAST

HONOURS = frozenset(
    {
        *("slip", "slip.mu_static", "slip.patch", "drilling", "rolling_resistance"),
        *("contour_friction", "air_film"),
        *("compliance", "compliance.exponent", "restitution", "restitution.law"),
        *("damping", "rim", "tilt", "shake", "point_mass"),
    }
)
"""Effects that a reference model carries, and constants of theirs that not every engine has."""

_RATES = ("phi_dot", "psi_dot", "theta_dot")

BEYOND_DOUBLES = "Its numbers are beyond what a double holds."


def refusal(scene: Scene) -> str:
    """Return in a sentence why a scene has no exact motion; nothing if it has one."""
    if scene.gravity == 0.0:
        return "Without gravity nothing holds the can to the plane, so it does not roll."
    if scene.release.height < 0.0:
        return "The can is released inside the plane: at height 0 a soft contact bears the can."
    scales = {"phi": 1.0, **dict.fromkeys(_RATES, natural_time(scene))}
    numbers = {
        name: np.array(scale * getattr(scene.release, name)) for name, scale in scales.items()
    }
    inside = representable(Releases(np.array(natural_time(scene)), numbers))
    return "" if inside else BEYOND_DOUBLES


def problem(scene: Scene, seconds: float | None = None) -> Problem:
    """Return a scene as a problem, up to its own horizon or for so many seconds."""
    T, can, release = natural_time(scene), scene.can, scene.release
    horizon = scene.horizon.seconds if seconds is None else seconds
    return Problem(
        parameters=Parameters(a=can.a, c=can.c, h=can.h),
        phi=release.phi,
        psi=release.psi,
        theta=release.theta,
        phi_dot=release.phi_dot * T,
        psi_dot=release.psi_dot * T,
        theta_dot=release.theta_dot * T,
        bounces=scene.horizon.bounces if horizon is None else None,
        duration=None if horizon is None else horizon / T,
        effects=effects(scene),
        height=release.height / can.radius,
    )


def carried(scene: Scene, model: str) -> bool:
    """Whether a model knows all the effects of a scene."""
    posed = problem(scene)
    return not posed.effects.declared() or carries(model, posed)


def effects(scene: Scene) -> Effects:
    """Return the effects of a scene that the reference carries, dimensionless."""
    declared, T, R = scene.effects, natural_time(scene), scene.can.radius
    slip, drilling, resistance = declared.slip, declared.drilling, declared.rolling_resistance
    damping, rim, point = declared.damping, declared.rim, declared.point_mass
    rebound = declared.restitution
    if rebound is None and declared.compliance is None and scene.release.height > 0.0:
        # what is dropped lands; unless declared, without giving anything back
        rebound = ImpactLaw(coefficient=0.0)
    return Effects(
        mu=None if slip is None else slip.mu,
        mu_static=None if slip is None else slip.mu_static,
        patch=0.0 if slip is None or slip.patch is None else slip.patch / R,
        **_along_the_rim(scene),
        drilling=0.0 if drilling is None else drilling.length / R,
        rolling_resistance=0.0 if resistance is None else resistance.length / R,
        linear_damping=0.0 if damping is None else damping.linear * T,
        angular_damping=0.0 if damping is None else damping.angular * T,
        rim=0.0 if rim is None else rim.radius / R,
        gravity=_gravity(scene),
        mass=None
        if point is None
        else Mass(share=point.mass / scene.can.mass, x=point.x / R, y=point.y / R, z=point.z / R),
        compliance=_compliance(scene),
        restitution=None
        if rebound is None
        else Restitution(coefficient=rebound.coefficient, law=rebound.law),
    )


def _compliance(scene: Scene) -> Compliance | None:
    """Return how the contact gives way, in weights per radius; None of a rigid one."""
    law, R = scene.effects.compliance, scene.can.radius
    if law is None:
        return None
    unit = R**law.exponent / (scene.can.mass * scene.gravity)
    # of a linear damper the constant, of another that over the power of the depth
    damping = R / (scene.can.mass * scene.gravity) if law.linear else unit * R
    return Compliance(
        stiffness=law.stiffness * unit,
        damping=law.damping * damping / natural_time(scene),
        exponent=law.exponent,
    )


def _along_the_rim(scene: Scene) -> dict[str, float]:
    """Return the strengths of the laws that oppose theta', dimensionless.

    Those of air are such that a film takes the power pi mu g R^2/phi^2 of steady rolling, and a
    boundary layer as much where it is as thick as the gap (`reference.equations.dissipation`).
    """
    contour, air = scene.effects.contour_friction, scene.effects.air_film
    T, can = natural_time(scene), scene.can
    out: dict[str, float] = {}
    if contour is not None:
        out |= {"contour": contour.coulomb, "contour_damping": contour.viscous * T / can.mass}
    if air is not None:
        film = math.pi / 4.0 * air.viscosity * can.radius * T / can.mass
        if air.density == 0.0:
            out["film"] = film
        else:
            layer = math.sqrt(air.viscosity * T / air.density)
            out["boundary_layer"] = film * can.radius / layer
    return out


def _gravity(scene: Scene) -> Gravity:
    tilt, shake = scene.effects.tilt, scene.effects.shake
    constant = (0.0, 0.0, -1.0)
    if tilt is not None:
        down, across = math.sin(tilt.angle), tilt.direction
        constant = (down * math.cos(across), down * math.sin(across), -math.cos(tilt.angle))
    if shake is None:
        return Gravity(constant=constant)
    rate = 2.0 * math.pi * shake.frequency
    push = rate * rate / scene.gravity
    return Gravity(
        constant=constant,
        amplitude=(
            push * shake.horizontal * math.cos(shake.direction),
            push * shake.horizontal * math.sin(shake.direction),
            push * shake.vertical,
        ),
        rate=rate * natural_time(scene),
        phase=shake.phase,
    )


_SENTENCES = {Ending.FINISHED: Outcome.FINISHED.value, Ending.OVERTURNED: Outcome.OVERTURNED.value}

SENTENCES = tuple(
    _SENTENCES.get(ending, f"{Outcome.NO_SOLUTION.value} ({ending.value})") for ending in OUTCOMES
)
"""How a release can end, by its code."""


@dataclass(frozen=True, slots=True, eq=False)
class Releases:
    """Releases of cans, dimensionless.

    Parameters
    ----------
    time : ndarray, shape () or (n,)
        Natural time sqrt(R/g), s.
    numbers : mapping of str to ndarray, shape () or (n,)
        The arguments of `exact_bounces`: `a`, `c`, `h`, `phi` and the rates. Those of the can may
        be one number for all, which is fastest.
    """

    time: Floats
    numbers: Mapping[str, Floats]

    @classmethod
    def of(cls, gravity: Floats, radius: Floats, **numbers: Floats) -> "Releases":
        """Return releases whose gravity, radius and rates are in SI units and rad/s."""
        time = np.sqrt(radius / gravity)
        return cls(time, {**numbers, **{name: numbers[name] * time for name in _RATES}})


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Batch:
    """The first bounces of n releases.

    Parameters
    ----------
    code : ndarray of int, shape (n,)
        Index into `SENTENCES`.
    numbers : mapping of str to ndarray, shape (n,)
        By the keys of `harness.metrics.quantities`; NaN where there is no bounce.
    """

    code: NDArray[np.int8]
    numbers: Mapping[str, Floats]

    @property
    def bounced(self) -> NDArray[np.bool_]:
        """Where there is a bounce, shape (n,)."""
        return np.asarray(self.code == OUTCOMES.index(Ending.FINISHED), dtype=np.bool_)


def representable(releases: Releases) -> NDArray[np.bool_]:
    """Return where a double holds the squares of nutation and rates, shape (n,)."""
    inside = releases.numbers["phi"] >= LEAST
    for name in _RATES:
        inside = inside & (np.abs(releases.numbers[name]) < 1 / LEAST)
    return inside


def compiles() -> bool:
    """Whether `bounces_of` can be asked for compiled kernels here."""
    return available()


def bounces_of(releases: Releases, *, compiled: bool = False) -> Batch:
    """Solve releases exactly.

    Parameters
    ----------
    releases : Releases
    compiled : bool
        By compiled kernels, whose numbers differ from those of the arrays by round-off: a caller
        that keeps numbers tells which of the two computed them (`path_taken`), and mixes none.

    Raises
    ------
    ValueError
        If a can or a release is none or not representable.
    ModuleNotFoundError
        If compiled kernels are asked for and numba is not installed.
    """
    time, cycles = releases.time, exact_bounces(**releases.numbers, compiled=compiled)
    none = ~cycles.bounced
    numbers = {
        "period_s": cycles.period * time,
        "angle_of_turn_deg": np.degrees(cycles.angle_of_turn),
        "rotation_turn_deg": np.degrees(cycles.rotation_turn),
        "phi_min_rad": cycles.phi_min,
        "peak_psi_dot_rad_s": cycles.peak_psi_dot / time,
    }
    return Batch(
        code=cycles.code,
        numbers={name: np.where(none, np.nan, values) for name, values in numbers.items()},
    )


def epsilon_of(releases: Releases) -> Floats:
    """Return B_-2 squared of releases, rates in sqrt(g/R), shape (n,).

    Equation (eq01:epsilon_zeta); B_-2 is the first integral B of `reference.integrable.frobenius`,
    exactly.
    """
    phi, psi_dot, theta_dot = np.broadcast_arrays(
        *(releases.numbers[name] for name in ("phi", "psi_dot", "theta_dot"))
    )
    a, c, h = np.broadcast_arrays(*(np.atleast_1d(releases.numbers[name]) for name in "ach"))
    can = CanConstants(a=a, c=c, h=h)
    series = frobenius_series(can, terms_needed(float(phi.max())))
    b, spin = np.sin(phi) ** 2 * psi_dot, psi_dot + theta_dot
    B = b * horner(series.s1, phi) - spin * horner(series.b1, phi)
    return np.asarray(B * B, dtype=np.float64)
