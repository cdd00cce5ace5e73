"""A scene as the reference poses it: dimensionless, lengths in R, times in sqrt(R/g)."""

import math

from harness.engines.stepping.horizon import natural_time
from models.scene import Scene
from reference import Effects, Gravity, Mass, Parameters, Problem, carries

HONOURS = frozenset(
    {"slip", "drilling", "rolling_resistance", "damping", "rim", "tilt", "shake", "point_mass"}
)
"""Effects that a reference model carries: those of a rigid can that stays on the plane."""

_BEYOND = {
    "compliance": "The reference is rigid: it does not know how a compliant contact gives way.",
    "restitution": "The reference stays on the plane: it knows no impact that gives anything back.",
}


def refusal(scene: Scene) -> str:
    """Return in a sentence why a scene has no motion on its rim; nothing if it has one."""
    if scene.gravity == 0.0:
        return "Without gravity nothing holds the can to the plane, so it does not roll."
    if scene.release.height > 0.0:
        return "The can is released above the plane, and rolling says nothing of its landing."
    if scene.release.height < 0.0:
        return "The can is released inside the plane, where no rigid can is."
    for name, sentence in _BEYOND.items():
        if name in scene.effects.declared():
            return sentence
    return ""


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
    )


def carried(scene: Scene, model: str) -> bool:
    """Whether a model knows all the effects of a scene."""
    return not scene.effects.declared() or carries(model, problem(scene))


def effects(scene: Scene) -> Effects:
    """Return the effects of a scene that the reference carries, dimensionless."""
    declared, T, R = scene.effects, natural_time(scene), scene.can.radius
    slip, drilling, resistance = declared.slip, declared.drilling, declared.rolling_resistance
    damping, rim, point = declared.damping, declared.rim, declared.point_mass
    return Effects(
        mu=None if slip is None else slip.mu,
        drilling=0.0 if drilling is None else drilling.length / R,
        rolling_resistance=0.0 if resistance is None else resistance.length / R,
        linear_damping=0.0 if damping is None else damping.linear * T,
        angular_damping=0.0 if damping is None else damping.angular * T,
        rim=0.0 if rim is None else rim.radius / R,
        gravity=_gravity(scene),
        mass=None
        if point is None
        else Mass(share=point.mass / scene.can.mass, x=point.x / R, y=point.y / R, z=point.z / R),
    )


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
