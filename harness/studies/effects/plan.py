"""Which scenes are run: the one declared, with each effect taken away, and with each one added.

How strong an effect is that a scene does not declare: that of a drinks can on a kitchen table.

An effect is missing in a scene if, at the strength that it has where the can is, it changes the
outcome. How strong it is there nobody knows but the author of the scene: these are orders of
magnitude, printed beside every verdict, and each can be replaced on the command line.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from itertools import combinations
from types import MappingProxyType
from typing import Any

from harness.core.case import Case
from harness.core.errors import InvalidSettingError, UnsupportedEffectError
from harness.engines.ladder import takes_timestep
from harness.engines.registry import check_effects, engine
from harness.studies.effects.friction import FrictionLadder, friction_ladder
from models.body_effects import Damping, PointMass, Shake, Tilt
from models.can import Can
from models.contact_effects import (
    AirFilm,
    Compliance,
    ContourFriction,
    Drilling,
    Restitution,
    RollingResistance,
    RoundedRim,
    Slip,
)
from models.effects import IDEAL, KINDS, Effects
from models.errors import ModelError
from models.scene import Scene

_ALUMINIUM_ON_WOOD = 0.4
_STIFFNESS = 1e7  # N/m: under its weight of 0.4 N a can sinks in by 40 nm
_BLUNT = 0.02  # the radius of the rolled bead of a can's base, some 0.7 mm, over R
_PATCH = 3e-5  # m: half of a contact patch of 0.2 mm times a friction of 0.3
_ALONG_THE_RIM = 1e-3  # dry contour friction of a can whose patch is a thousandth of its radius
_AIR = 1.8e-5  # Pa s: the viscosity of air at 20 degrees
_DRAG = 0.01  # 1/s: at 1 m/s air takes 1e-4 m/s^2 per m/s off a can of 40 g, tenfold for safety
_OFF_LEVEL = 1e-3  # rad: a millimetre on a metre
_TRAFFIC_HZ, _TRAFFIC_M = 30.0, 1e-6  # a floor's vibration where people walk
_SEAM = 1e-3  # mass of a lacquered seam on the wall of the can, over the can's own


def assumed_strengths(can: Can) -> dict[str, Any]:
    """Return an effect of each kind, as strong as for a can of this size on a table."""
    return {
        "slip": Slip(mu=_ALUMINIUM_ON_WOOD),
        "compliance": Compliance(stiffness=_STIFFNESS, damping=0.0),
        "restitution": Restitution(coefficient=0.5),
        "drilling": Drilling(length=_PATCH),
        "rolling_resistance": RollingResistance(length=_PATCH),
        "contour_friction": ContourFriction(coulomb=_ALONG_THE_RIM),
        "air_film": AirFilm(viscosity=_AIR),
        "damping": Damping(linear=_DRAG, angular=_DRAG),
        "rim": RoundedRim(radius=_BLUNT * min(can.radius, can.half_height)),
        "tilt": Tilt(angle=_OFF_LEVEL),
        "shake": Shake(frequency=_TRAFFIC_HZ, vertical=_TRAFFIC_M, horizontal=_TRAFFIC_M),
        "point_mass": PointMass(mass=_SEAM * can.mass, x=can.radius),
    }


def replaced_strengths(can: Can, words: tuple[tuple[str, float], ...]) -> dict[str, Any]:
    """Return the assumed strengths with the constants named in `words` replaced.

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
    strengths = assumed_strengths(can)
    for key, value in words:
        name, _, constant = key.partition(".")
        if name not in KINDS:
            raise InvalidSettingError("--assume", key, f"effects are {', '.join(KINDS)}")
        constants = [field.name for field in fields(strengths[name])]
        if constant not in constants:
            allowed = ", ".join(f"{name}.{known}" for known in constants)
            raise InvalidSettingError("--assume", key, allowed)
        try:
            strengths[name] = replace(strengths[name], **{constant: value})
        except ModelError as error:
            raise InvalidSettingError("--assume", f"{key}={value}", str(error)) from None
    return strengths


MOST_FACTORS = 3
"""Declared effects of which every subset is run; of more, one at a time from both ends."""

Subset = frozenset[str]
"""Names of the effects that are in force."""


@dataclass(frozen=True, slots=True, kw_only=True)
class EffectsPlan:
    """What the study varies.

    Parameters
    ----------
    scene : Scene
    engines : tuple of str
        Who moves the can, the reference first.
    timestep : float, optional
        Of the engines, s; their own if left out.
    strengths : mapping of str to effect
        Of each effect: as the scene declares it, else as its surroundings have it.
    tolerance : float
        deg of turn below which a change does not count; of the other quantities in proportion.
    """

    scene: Scene
    engines: tuple[str, ...]
    timestep: float | None
    strengths: Mapping[str, Any]
    tolerance: float

    @property
    def declared(self) -> Subset:
        """The effects of the scene itself."""
        return frozenset(self.scene.effects.declared())

    @property
    def factorial(self) -> bool:
        """Whether every subset of the declared effects is run."""
        return len(self.declared) <= MOST_FACTORS

    def subsets(self) -> Iterator[Subset]:
        """Yield the sets of effects that are run: first the scene's own."""
        own = self.declared
        yield own
        if self.factorial:
            for size in range(len(own)):
                yield from map(frozenset, combinations(sorted(own), size))
        else:
            yield frozenset()
            for name in sorted(own):
                yield frozenset((name,))
                yield own - {name}
        for name in KINDS:
            if name not in own:
                yield own | {name}

    def case(self, engine_name: str, subset: Subset) -> Case | None:
        """Return the case of an engine under these effects; None if it cannot be run.

        Effects may contradict each other, or an engine not represent them. An effect that an engine
        adds to every scene alike is no choice of the scene's: it is run neither with nor without.
        """
        if (subset - self.declared) & frozenset(engine(engine_name).capabilities.imposes):
            return None
        try:
            effects = Effects(**{name: self.strengths[name] for name in subset})
            scene = replace(self.scene, effects=effects if subset else IDEAL)
            check_effects(engine_name, scene)
        except (ModelError, UnsupportedEffectError):
            return None
        steps = engine_name != "reference" and takes_timestep(engine_name)
        timestep = self.timestep if steps else None
        return Case(scene=scene, engine=engine_name, timestep=timestep)

    def cases(self) -> tuple[Case, ...]:
        """Return the cases with and without effects, each once."""
        cases = (self.case(name, subset) for name in self.engines for subset in self.subsets())
        return tuple(dict.fromkeys(case for case in cases if case is not None))

    @property
    def friction(self) -> FrictionLadder:
        """The ladder of friction."""
        return friction_ladder(self.scene, self.engines, self.timestep)


def plan_effects(
    scene: Scene,
    engines: Sequence[str],
    *,
    timestep: float | None = None,
    words: tuple[tuple[str, float], ...] = (),
    tolerance: float = 0.1,
) -> EffectsPlan:
    """Return the plan for a scene.

    Raises
    ------
    InvalidSettingError
        If an assumption makes no sense, or a timestep is given and no engine takes one.
    """
    able = [name for name in engines if name != "reference" and takes_timestep(name)]
    if timestep is not None and not able:
        raise InvalidSettingError(
            "--timestep", timestep, f"none: {', '.join(engines)} choose their own steps"
        )
    strengths = replaced_strengths(scene.can, words)
    strengths |= {name: getattr(scene.effects, name) for name in scene.effects.declared()}
    return EffectsPlan(
        scene=scene,
        engines=tuple(engines),
        timestep=timestep,
        strengths=MappingProxyType(strengths),
        tolerance=tolerance,
    )
