"""Which scenes are run: the one declared, with each factor taken away, and with each one added.

A factor is an effect, a constant that a law may do without ("slip.patch"), or the height of the
release. A constant is added to its effect and goes with it.

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
    POISSON,
    AirFilm,
    Compliance,
    ContourFriction,
    Drilling,
    Restitution,
    RollingResistance,
    RoundedRim,
    Slip,
)
from models.effects import KINDS, OPTIONAL_CONSTANTS, Effects
from models.errors import ModelError
from models.quantity import positive
from models.scene import Scene

HEIGHT = "height"
"""Of the release above the plane, among the factors."""

FACTORS = (
    *(
        factor
        for effect in KINDS
        for factor in (effect, *(one for one in OPTIONAL_CONSTANTS if one.startswith(effect + ".")))
    ),
    HEIGHT,
)
"""What a scene may have or do without."""

_ALUMINIUM_ON_WOOD = 0.4
_STATIC = 1.25  # static friction over kinetic, of a dry pair
_STIFFNESS = 1e7  # N/m: under its weight of 0.4 N a can sinks in by 40 nm
_BLUNT = 0.02  # the radius of the rolled bead of a can's base, some 0.7 mm, over R
_PATCH_RADIUS = 1e-4  # m: half of a contact patch of 0.2 mm
_PATCH = 3e-5  # m: that radius times a friction of 0.3
_HERTZ = 1.5  # exponent of a smooth contact of two bodies
_ALONG_THE_RIM = 1e-3  # dry contour friction of a can whose patch is a thousandth of its radius
_AIR = 1.8e-5  # Pa s: the viscosity of air at 20 degrees
_DRAG = 0.01  # 1/s: at 1 m/s air takes 1e-4 m/s^2 per m/s off a can of 40 g, tenfold for safety
_OFF_LEVEL = 1e-3  # rad: a millimetre on a metre
_TRAFFIC_HZ, _TRAFFIC_M = 30.0, 1e-6  # a floor's vibration where people walk
_SEAM = 1e-3  # mass of a lacquered seam on the wall of the can, over the can's own
_DROP = 1e-3  # m: let go a millimetre above the table


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


def assumed_constants(slip: Slip) -> dict[str, float | str]:
    """Return the constants of a law that may be left out, and the height of a release, m."""
    return {
        "slip.mu_static": _STATIC * slip.mu,
        "slip.patch": _PATCH_RADIUS,
        "compliance.exponent": _HERTZ,
        "restitution.law": POISSON,
        HEIGHT: _DROP,
    }


def replaced_strengths(can: Can, words: tuple[tuple[str, float], ...]) -> dict[str, Any]:
    """Return the assumed strength of each factor with the constants named in `words` replaced.

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
    strengths, constants = assumed_strengths(can), dict[str, float | str]()
    # what a law may do without is checked against the constants that it needs
    for key, value in sorted(words, key=lambda word: word[0] in OPTIONAL_CONSTANTS):
        name, _, constant = key.partition(".")
        if name not in KINDS and key != HEIGHT:
            allowed = f"effects are {', '.join(KINDS)}; or {HEIGHT}"
            raise InvalidSettingError("--assume", key, allowed)
        try:
            if key == HEIGHT:
                constants[key] = positive(key, value)
                continue
            known = [field.name for field in fields(strengths[name])]
            if constant not in known:
                allowed = ", ".join(f"{name}.{one}" for one in known)
                raise InvalidSettingError("--assume", key, allowed)
            law = replace(strengths[name], **{constant: value})
        except ModelError as error:
            raise InvalidSettingError("--assume", f"{key}={value}", str(error)) from None
        if key in OPTIONAL_CONSTANTS:
            constants[key] = getattr(law, constant)
        else:
            strengths[name] = law
    return strengths | assumed_constants(strengths["slip"]) | constants


MOST_FACTORS = 3
"""Declared effects of which every subset is run; of more, one at a time from both ends."""

Subset = frozenset[str]
"""Names of the factors that are in force."""


def declared_factors(scene: Scene) -> Subset:
    """Return the effects and optional constants of a scene, and its height where it has one."""
    height = {HEIGHT} if scene.release.height > 0.0 else set[str]()
    return frozenset(scene.effects.demanded()) | height


def with_factor(subset: Subset, name: str) -> Subset:
    """Return factors with one more; a constant comes with its effect."""
    return subset | {name, name.partition(".")[0]}


def without_factor(subset: Subset, name: str) -> Subset:
    """Return factors with one less; the constants of an effect go with it."""
    return frozenset(one for one in subset if one != name and one.partition(".")[0] != name)


def _subsets_of(factors: Subset) -> Iterator[Subset]:
    """Yield the subsets of factors in which no constant is without its effect, small ones first."""
    for size in range(len(factors) + 1):
        for subset in map(frozenset, combinations(sorted(factors), size)):
            if all(name.partition(".")[0] in subset for name in subset):
                yield subset


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
    strengths : mapping of str to effect or constant
        Of each factor: as the scene declares it, else as its surroundings have it.
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
        """The factors of the scene itself."""
        return declared_factors(self.scene)

    @property
    def factorial(self) -> bool:
        """Whether every subset of the declared factors is run."""
        return len(self.declared) <= MOST_FACTORS

    def subsets(self) -> Iterator[Subset]:
        """Yield the sets of factors that are run: first the scene's own."""
        own = self.declared
        yield own
        if self.factorial:
            yield from (subset for subset in _subsets_of(own) if subset != own)
        else:
            yield frozenset()
            for name in sorted(own):
                yield with_factor(frozenset(), name)
                yield without_factor(own, name)
        for name in FACTORS:
            if name not in own:
                yield with_factor(own, name)

    def others(self, name: str) -> tuple[Subset, ...]:
        """Return the sets of the other declared factors to which a declared one can be added."""
        rest = without_factor(self.declared, name)
        return tuple(
            subset
            for subset in _subsets_of(rest)
            if "." not in name or name.partition(".")[0] in subset
        )

    def case(self, engine_name: str, subset: Subset) -> Case | None:
        """Return the case of an engine with these factors; None if it cannot be run.

        Effects may contradict each other, or an engine not represent them. An effect that an engine
        adds to every scene alike is no choice of the scene's: it is run neither with nor without.
        """
        if (subset - self.declared) & frozenset(engine(engine_name).capabilities.imposes):
            return None
        try:
            scene = self.scene_with(subset)
            check_effects(engine_name, scene)
        except (ModelError, UnsupportedEffectError):
            return None
        steps = engine_name != "reference" and takes_timestep(engine_name)
        timestep = self.timestep if steps else None
        return Case(scene=scene, engine=engine_name, timestep=timestep)

    def scene_with(self, subset: Subset) -> Scene:
        """Return the scene with these factors.

        Raises
        ------
        ModelError
            If they contradict each other.
        """
        height = self.scene.release.height
        if (HEIGHT in subset) != (HEIGHT in self.declared):
            height = self.strengths[HEIGHT] if HEIGHT in subset else 0.0
        return replace(
            self.scene,
            effects=Effects(**{name: self.law(name, subset) for name in KINDS if name in subset}),
            release=replace(self.scene.release, height=height),
        )

    def law(self, name: str, subset: Subset) -> Any:  # noqa: ANN401 - a class of `KINDS`
        """Return an effect, with those of its optional constants that are among some factors."""
        law = self.strengths[name]
        for key in OPTIONAL_CONSTANTS:
            effect, _, constant = key.partition(".")
            if effect != name:
                continue
            each = next(field for field in fields(law) if field.name == constant)
            value: Any = self.strengths[key] if key in subset else each.default
            if isinstance(law, Compliance):
                law = _of_exponent(law, value, self.scene.can.mass * self.scene.gravity)
            else:
                law = replace(law, **{constant: value})
        return law

    def cases(self) -> tuple[Case, ...]:
        """Return the cases with and without effects, each once."""
        cases = (self.case(name, subset) for name in self.engines for subset in self.subsets())
        return tuple(dict.fromkeys(case for case in cases if case is not None))

    @property
    def friction(self) -> FrictionLadder:
        """The ladder of friction."""
        return friction_ladder(self.scene, self.engines, self.timestep)


def _of_exponent(law: Compliance, exponent: float, weight: float) -> Compliance:
    """Return a compliance of another exponent that is as deep and as damped under a weight, N.

    A stiffness has another unit for each exponent, so that its number means nothing beside another.
    """
    if law.exponent == exponent:
        return law
    depth = (weight / law.stiffness) ** (1.0 / law.exponent)
    if depth == 0.0:
        return replace(law, exponent=exponent)
    damping = law.damping * (1.0 if law.linear else depth**law.exponent)
    return Compliance(
        stiffness=weight / depth**exponent,
        damping=damping / (1.0 if exponent == 1.0 else depth**exponent),
        exponent=exponent,
    )


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
    effects = scene.effects
    strengths |= {name: getattr(effects, name) for name in effects.declared()}
    if effects.slip is not None and "slip.mu_static" not in dict(words):
        strengths |= {"slip.mu_static": _STATIC * effects.slip.mu}
    for key in effects.demanded():
        name, _, constant = key.partition(".")
        if constant:
            strengths[key] = getattr(getattr(effects, name), constant)
    return EffectsPlan(
        scene=scene,
        engines=tuple(engines),
        timestep=timestep,
        strengths=MappingProxyType(strengths),
        tolerance=tolerance,
    )
