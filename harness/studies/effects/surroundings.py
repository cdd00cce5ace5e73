"""How strong an effect is that a scene does not declare: that of a drinks can on a kitchen table.

An effect is missing in a scene if, at the strength that it has where the can is, it changes the
outcome. How strong it is there nobody knows but the author of the scene: these are orders of
magnitude, printed beside every verdict, and each can be replaced on the command line.
"""

from dataclasses import replace
from typing import Any

from harness.errors import InvalidSettingError
from models.body_effects import Damping, PointMass, Shake, Tilt
from models.can import Can
from models.contact_effects import (
    Compliance,
    Drilling,
    Restitution,
    RollingResistance,
    RoundedRim,
    Slip,
)
from models.effects import KINDS
from models.errors import ModelError

_ALUMINIUM_ON_WOOD = 0.4
_STIFFNESS = 1e7  # N/m: under its weight of 0.4 N a can sinks in by 40 nm
_BLUNT = 0.02  # the radius of the rolled bead of a can's base, some 0.7 mm, over R
_PATCH = 3e-5  # m: half of a contact patch of 0.2 mm times a friction of 0.3
_DRAG = 0.01  # 1/s: at 1 m/s air takes 1e-4 m/s^2 per m/s off a can of 40 g, tenfold for safety
_OFF_LEVEL = 1e-3  # rad: a millimetre on a metre
_TRAFFIC_HZ, _TRAFFIC_M = 30.0, 1e-6  # a floor's vibration where people walk
_SEAM = 1e-3  # mass of a lacquered seam on the wall of the can, over the can's own


def surroundings(can: Can) -> dict[str, Any]:
    """Return an effect of each kind, as strong as for a can of this size on a table."""
    return {
        "slip": Slip(mu=_ALUMINIUM_ON_WOOD),
        "compliance": Compliance(stiffness=_STIFFNESS, damping=0.0),
        "restitution": Restitution(coefficient=0.5),
        "drilling": Drilling(length=_PATCH),
        "rolling_resistance": RollingResistance(length=_PATCH),
        "damping": Damping(linear=_DRAG, angular=_DRAG),
        "rim": RoundedRim(radius=_BLUNT * min(can.radius, can.half_height)),
        "tilt": Tilt(angle=_OFF_LEVEL),
        "shake": Shake(frequency=_TRAFFIC_HZ, vertical=_TRAFFIC_M, horizontal=_TRAFFIC_M),
        "point_mass": PointMass(mass=_SEAM * can.mass, x=can.radius),
    }


def assumed(can: Can, words: tuple[tuple[str, float], ...]) -> dict[str, Any]:
    """Return the surroundings with some constants replaced.

    Parameters
    ----------
    can : Can
    words : tuple of (str, float)
        Such as ("slip.mu", 0.3).

    Raises
    ------
    InvalidSettingError
        If there is no such effect or constant, or it cannot have that value.
    """
    found = surroundings(can)
    for key, value in words:
        name, _, constant = key.partition(".")
        if name not in KINDS:
            raise InvalidSettingError("--assume", key, f"effects are {', '.join(KINDS)}")
        constants = found[name].__dataclass_fields__
        if constant not in constants:
            allowed = ", ".join(f"{name}.{known}" for known in constants)
            raise InvalidSettingError("--assume", key, allowed)
        try:
            found[name] = replace(found[name], **{constant: value})
        except ModelError as error:
            raise InvalidSettingError("--assume", f"{key}={value}", str(error)) from None
    return found
