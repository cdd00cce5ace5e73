"""The cases of the comparison.

Each engine runs each scene as it ships, at its own timestep; matched, on a ladder of timesteps;
and adaptive. An engine that chooses its own steps has a ladder of accuracies in the place of
timesteps, and no profile `adaptive` of its own. The first says what a user gets, the second how
fast the engine gets nearer, the third what it can do.

What an engine is not asked: scenes with effects that it neither honours nor imposes.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from types import MappingProxyType

from harness.core.case import Case
from harness.core.verdict import Status, Verdict
from harness.engines.ladder import at_rung, rungs, takes_timestep
from harness.engines.registry import missing_effects
from models.catalogue import field_names
from models.scene import Scene

Ladder = tuple[float, ...]

_QUICK: Mapping[str, Ladder] = MappingProxyType(
    {
        "gentle-rock": (3e-4, 1e-4, 3e-5, 1e-5),
        "paper-release": (1e-5, 3e-6, 1e-6),
        "steady-rolling": (1e-3, 1e-4),
        "straight-rolling": (1e-3, 1e-4),
        "petals": (1e-4,),
        "wobble": (1e-4,),
        "cusps": (1e-4,),
    }
)

_FULL: Mapping[str, Ladder] = MappingProxyType(
    {
        "gentle-rock": (1e-3, 3e-4, 1e-4, 3e-5, 1e-5, 3e-6, 1e-6),
        "paper-release": (1e-4, 3e-5, 1e-5, 3e-6, 1e-6, 3e-7, 1e-7),
        "steady-rolling": (1e-3, 3e-4, 1e-4, 3e-5, 1e-5),
        "straight-rolling": (1e-3, 3e-4, 1e-4, 3e-5, 1e-5),
        "petals": (1e-3, 3e-4, 1e-4, 3e-5, 1e-5),
        "wobble": (1e-3, 3e-4, 1e-4, 3e-5, 1e-5),
        "cusps": (1e-4, 3e-5, 1e-5),
        "tilted-plane": (1e-3, 3e-4, 1e-4),
        "shaken-plane": (1e-3, 3e-4, 1e-4),
        "off-centre-mass": (1e-3, 3e-4, 1e-4),
        "slipping-rock": (1e-3, 3e-4, 1e-4),
        "chaotic-can": (2e-4,),
    }
)

_LOST_AND_FOUND = ("dropped-can", "thrown-up", "falls-flat", "soft-rock")

_COARSE = (1e-3, 1e-4)

SUITES: Mapping[str, Mapping[str, Ladder]] = MappingProxyType(
    {
        "quick": _QUICK,
        "full": _FULL,
        "field": MappingProxyType(dict.fromkeys(field_names(), _COARSE)),
        "contact": MappingProxyType(dict.fromkeys(_LOST_AND_FOUND, _COARSE)),
    }
)
"""Timesteps of profile `matched` by suite and scene, s. The scenes of "contact" have impacts, or a
contact that gives way; those of "quick" and "full" a rigid contact that is kept."""


def suite_cases(
    suite: str, engines: Sequence[str], scenes: Mapping[str, Scene]
) -> tuple[Case, ...]:
    """Return the cases of a suite.

    Parameters
    ----------
    suite : str
        A key of `SUITES`.
    engines : sequence of str
        Names of engines that move a can by steps.
    scenes : mapping of str to Scene
        At least the scenes of the suite, by name.
    """
    cases = []
    for (name, ladder), engine in product(SUITES[suite].items(), engines):
        case = Case(scene=scenes[name], engine=engine)
        cases.append(replace(case, profile="default"))
        if takes_timestep(engine):
            cases.append(replace(case, profile="adaptive"))
        cases += [at_rung(case, value) for value in rungs(engine, ladder)]
    return tuple(cases)


@dataclass(frozen=True, slots=True, kw_only=True)
class Unsupported:
    """A scene that an engine cannot represent.

    Parameters
    ----------
    scene, engine : str
    effects : tuple of str
        Those that it lacks.
    """

    scene: str
    engine: str
    effects: tuple[str, ...]

    @property
    def verdict(self) -> Verdict:
        """The verdict on every quantity."""
        text = f"unsupported: cannot represent {', '.join(self.effects)}"
        return Verdict(Status.UNSUPPORTED, text)


def split_unsupported(cases: Sequence[Case]) -> tuple[tuple[Case, ...], tuple[Unsupported, ...]]:
    """Return the cases that can be run, and which engines cannot run which scenes.

    Raises
    ------
    HarnessError
        If a scene declares an effect and its engine is not there to be asked.
    """
    lacking = {
        (case.scene.name, case.engine): effects
        for case in cases
        if (effects := missing_effects(case.engine, case.scene))
    }
    return (
        tuple(case for case in cases if (case.scene.name, case.engine) not in lacking),
        tuple(
            Unsupported(scene=scene, engine=engine, effects=effects)
            for (scene, engine), effects in lacking.items()
        ),
    )
