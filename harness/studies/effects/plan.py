"""Which scenes are run: the one declared, with each effect taken away, and with each one added."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from types import MappingProxyType
from typing import Any

from harness.case import Case
from harness.engines.registry import check_effects, engine
from harness.errors import UnsupportedEffectError
from harness.studies.effects.surroundings import assumed
from models.effects import IDEAL, KINDS, Effects
from models.errors import ModelError
from models.scene import Scene

MOST_FACTORS = 3
"""Declared effects of which every subset is run; of more, one at a time from both ends."""

Subset = frozenset[str]
"""Names of the effects that are in force."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Plan:
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


def plan(
    scene: Scene,
    engines: Sequence[str],
    *,
    timestep: float | None = None,
    words: tuple[tuple[str, float], ...] = (),
    tolerance: float = 0.1,
) -> Plan:
    """Return the plan for a scene.

    Raises
    ------
    InvalidSettingError
        If an assumption makes no sense.
    """
    strengths = assumed(scene.can, words)
    strengths |= {name: getattr(scene.effects, name) for name in scene.effects.declared()}
    return Plan(
        scene=scene,
        engines=tuple(engines),
        timestep=timestep,
        strengths=MappingProxyType(strengths),
        tolerance=tolerance,
    )


def subsets(made: Plan) -> Iterator[Subset]:
    """Yield the sets of effects that are run: first the scene's own."""
    own = made.declared
    yield own
    if made.factorial:
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


def varied(made: Plan, subset: Subset) -> Scene | None:
    """Return the scene with just these effects; None if they contradict each other."""
    try:
        effects = Effects(**{name: made.strengths[name] for name in subset})
        return replace(made.scene, effects=effects if subset else IDEAL)
    except ModelError:
        return None


def case(made: Plan, mover: str, subset: Subset) -> Case | None:
    """Return the case in which an engine moves the can under these effects; None if none does.

    An effect that an engine adds to every scene alike is no choice of the scene's: it is neither
    run with nor without.
    """
    scene = varied(made, subset)
    if scene is None or (subset - made.declared) & _imposed(mover):
        return None
    try:
        check_effects(mover, scene)
    except UnsupportedEffectError:
        return None
    timestep = None if mover == "reference" else made.timestep
    return Case(scene=scene, engine=mover, timestep=timestep)


def _imposed(mover: str) -> Subset:
    """Return the effects that an engine adds where they are not declared, honoured or not."""
    return frozenset(engine(mover).capabilities.imposes)


def design(made: Plan) -> tuple[Case, ...]:
    """Return the cases, each once."""
    found = (case(made, mover, subset) for mover in made.engines for subset in subsets(made))
    return tuple(dict.fromkeys(one for one in found if one is not None))
