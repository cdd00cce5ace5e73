"""Effects that a scene adds to the ideal can; an absent effect is None, its ideal limit.

The ideal can is rigid, rolls without slipping, loses nothing, and stands on a level plane at rest.
An effect is a small frozen class that holds the constants of its law, in SI units, and says what
the law supposes: those of the contact are in `models.contact_effects`, those of the can and its
surroundings in `models.body_effects`.
"""

from dataclasses import astuple, dataclass, fields
from types import MappingProxyType
from typing import Any

from models.body_effects import Damping, PointMass, Shake, Tilt
from models.can import Can
from models.contact_effects import (
    ADDED_LATER,
    AirFilm,
    Compliance,
    ContourFriction,
    Drilling,
    Restitution,
    RollingResistance,
    RoundedRim,
    Slip,
)
from models.errors import InvalidValueError

NO_SLIP_FRICTION = 2.0
"""Coefficient of friction of an engine model whose scene declares no slip.

An engine has no no-slip constraint, so it gets twice the friction that rolling calls for: 1.021 in
the bounces of the scene `wobble`, the most of any whose plane need not pull; the paper's release
needs 0.508. With 1 that scene slips. More changes little: from 2 to 5, psi after two bounces of
`wobble` at a timestep of 1e-5 moves by 1e-8 degrees in MuJoCo and by 0.011 in PyBullet.
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Effects:
    """The effects of a scene; an effect left out is the ideal limit.

    Parameters
    ----------
    slip : Slip, optional
        Coulomb friction; left out, the can never slips.
    compliance : Compliance, optional
        A contact that gives way; left out, it is rigid.
    restitution : Restitution, optional
        How much an impact gives back; left out, nothing: the rim stays on the plane.
    drilling : Drilling, optional
        Friction against turning about the normal; left out, none.
    rolling_resistance : RollingResistance, optional
        Friction against rolling; left out, none.
    contour_friction : ContourFriction, optional
        Friction of the contact point along the rim; left out, none.
    air_film : AirFilm, optional
        Air between a disk and the plane; left out, none.
    damping : Damping, optional
        Drag; left out, none.
    rim : RoundedRim, optional
        A rim that is an arc; left out, it is sharp.
    tilt : Tilt, optional
        A plane that is not level.
    shake : Shake, optional
        A plane that moves.
    point_mass : PointMass, optional
        A mass in addition to the can's own.

    Raises
    ------
    InvalidValueError
        If something is not the effect that its name says, or two effects contradict each other.
    """

    slip: Slip | None = None
    compliance: Compliance | None = None
    restitution: Restitution | None = None
    drilling: Drilling | None = None
    rolling_resistance: RollingResistance | None = None
    contour_friction: ContourFriction | None = None
    air_film: AirFilm | None = None
    damping: Damping | None = None
    rim: RoundedRim | None = None
    tilt: Tilt | None = None
    shake: Shake | None = None
    point_mass: PointMass | None = None

    def __post_init__(self) -> None:
        """Refuse what is not an effect, and effects of which one excludes the other."""
        for name, kind in KINDS.items():
            effect = getattr(self, name)
            if effect is not None and not isinstance(effect, kind):
                raise InvalidValueError(name, effect, f"a {kind.__name__} or None")
        self._check_friction()
        if self.compliance is not None and self.restitution is not None:
            allowed = "left out beside `compliance`: its damping says what a contact gives back"
            value = self.restitution.coefficient
            raise InvalidValueError("restitution.coefficient", value, allowed)

    def _check_friction(self) -> None:
        """Refuse laws of friction of which one excludes the other."""
        contour = self.contour_friction
        if self.slip is not None and self.slip.mu == 0.0:
            allowed = "left out beside `slip` with mu 0: a plane without friction does not resist"
            for name in ("drilling", "rolling_resistance"):
                if (law := getattr(self, name)) is not None:
                    raise InvalidValueError(f"{name}.length", law.length, allowed)
            if contour is not None and contour.coulomb > 0.0:
                raise InvalidValueError("contour_friction.coulomb", contour.coulomb, allowed)
        if self.rolling_resistance is not None and contour is not None and contour.coulomb > 0.0:
            allowed = "zero beside `rolling_resistance`: both are a dry moment against rolling"
            raise InvalidValueError("contour_friction.coulomb", contour.coulomb, allowed)
        if self.slip is not None and self.slip.patch is not None and self.drilling is not None:
            allowed = "zero beside `drilling`: a patch has its own friction against drilling"
            raise InvalidValueError("slip.patch", self.slip.patch, allowed)

    def declared(self) -> tuple[str, ...]:
        """Return the names of the effects that are present, in the order of the fields."""
        return tuple(field.name for field in fields(self) if getattr(self, field.name) is not None)

    def demanded(self) -> tuple[str, ...]:
        """Return the effects that are present, and constants that an engine may not know."""
        return self.declared() + tuple(
            f"{name}.{each.name}"
            for name in self.declared()
            for each in fields(getattr(self, name))
            if each.metadata == ADDED_LATER
            and getattr(getattr(self, name), each.name) != each.default
        )


KINDS: MappingProxyType[str, type[Any]] = MappingProxyType(
    {
        "slip": Slip,
        "compliance": Compliance,
        "restitution": Restitution,
        "drilling": Drilling,
        "rolling_resistance": RollingResistance,
        "contour_friction": ContourFriction,
        "air_film": AirFilm,
        "damping": Damping,
        "rim": RoundedRim,
        "tilt": Tilt,
        "shake": Shake,
        "point_mass": PointMass,
    }
)
"""The effects there are, by their keys in a scene file."""

MODELLING_CHOICES = MappingProxyType({name: kind.modelling_choice for name, kind in KINDS.items()})
"""What each effect supposes beyond its name, a sentence each: another model might choose otherwise.
Pages of reports and answers of the command line quote it."""


def modelling_choices(effects: Effects) -> tuple[str, ...]:
    """Return a sentence for each effect that is declared, in the order of the fields."""
    return tuple(MODELLING_CHOICES[name] for name in effects.declared())


OPTIONAL_CONSTANTS = tuple(
    f"{name}.{each.name}"
    for name, kind in KINDS.items()
    for each in fields(kind)
    if each.metadata == ADDED_LATER
)
"""Constants that an engine may not know though it knows the effect: it names them as honoured."""

IDEAL = Effects()
"""No effect at all: rigid, no slip, no loss, level, at rest."""


def constants_of(effect: Any) -> dict[str, float | str]:  # noqa: ANN401 - of any kind
    """Return the constants of an effect by name, without those added later at their defaults."""
    return {
        each.name: value
        for each, value in zip(fields(effect), astuple(effect), strict=True)
        if not (each.metadata == ADDED_LATER and value == each.default)
    }


def check_fits(effects: Effects, can: Can) -> None:
    """Refuse effects that do not fit into a can.

    Raises
    ------
    InvalidValueError
        A point mass outside the can, a rim rounded by more than the can has, or a patch of contact
        as wide as the can; the key is the effect's and the quantity's, such as ``point_mass.z``.
    """
    rim, mass = effects.rim, effects.point_mass
    if rim is not None and rim.radius >= min(can.radius, can.half_height):
        allowed = f"less than the can's radius {can.radius:g} and half height {can.half_height:g}"
        raise InvalidValueError("rim.radius", rim.radius, allowed)
    patch = None if effects.slip is None else effects.slip.patch
    if patch is not None and patch >= can.radius:
        raise InvalidValueError("slip.patch", patch, f"less than the can's radius {can.radius:g}")
    if mass is None:
        return
    if abs(mass.z) > can.half_height:
        allowed = f"inside the can: at most {can.half_height:g} from its centre"
        raise InvalidValueError("point_mass.z", mass.z, allowed)
    if mass.x * mass.x + mass.y * mass.y > can.radius**2:
        # the larger of the two is to blame, and the other one may be as well
        blamed, other = ("x", "y") if abs(mass.x) >= abs(mass.y) else ("y", "x")
        away = "" if getattr(mass, other) == 0.0 else f", with {other} at {getattr(mass, other):g}"
        allowed = f"inside the can: at most {can.radius:g} from its axis{away}"
        raise InvalidValueError(f"point_mass.{blamed}", getattr(mass, blamed), allowed)
