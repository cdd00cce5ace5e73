"""One effect of each kind, for tests of what files, compiled worlds and energies make of each.

Every number is other than zero and than any default, so that none can be left out unseen. The point
mass is as heavy as the can of `gentle-rock`.
"""

import math
from dataclasses import replace
from typing import Any

from models import (
    AirFilm,
    Compliance,
    ContourFriction,
    Damping,
    Drilling,
    Effects,
    PointMass,
    Restitution,
    RollingResistance,
    RoundedRim,
    Scene,
    Shake,
    Slip,
    Tilt,
)

EFFECTS: dict[str, Any] = {
    "slip": Slip(mu=0.3),
    "compliance": Compliance(stiffness=2e4, damping=5.0),
    "restitution": Restitution(coefficient=0.5),
    "drilling": Drilling(length=1e-3),
    "rolling_resistance": RollingResistance(length=5e-4),
    "contour_friction": ContourFriction(coulomb=0.02, viscous=0.01),
    "air_film": AirFilm(viscosity=0.1, density=1.2),
    "damping": Damping(linear=0.5, angular=0.3),
    "rim": RoundedRim(radius=2e-3),
    "tilt": Tilt(angle=0.1, direction=math.pi / 2.0),
    "shake": Shake(frequency=15.0, horizontal=5e-4, vertical=3e-4, direction=0.3, phase=0.4),
    "point_mass": PointMass(mass=0.043, x=0.02, y=0.005, z=-0.01),
}


def effects_of(*names: str) -> Effects:
    """Return the effects of these names together."""
    return Effects(**{name: EFFECTS[name] for name in names})


def declaring(scene: Scene, *names: str) -> Scene:
    """Return a scene that declares the effects of these names."""
    return replace(scene, effects=effects_of(*names))
