"""The path from an engine as it ships to the matched one, one gap closed at a time.

Every step of the path is a set of closed gaps, and every set of closed gaps is a case: profile
`default` with the settings of the closed gaps put to their matched values, all of them closed being
profile `matched` itself. A setting whose matched value goes with the timestep takes its value for
the timestep in force there.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from harness.core.case import Case
from harness.core.errors import InvalidSettingError
from harness.engines.base import TIMESTEP, Engine, ModelDifference, Setting, features_of
from harness.engines.reference.assumption_checks import check_exact
from harness.engines.registry import engine, timestep_of
from models.scene import Scene

Closed = frozenset[str]
"""Names of the gaps that are closed."""


@dataclass(frozen=True, slots=True, kw_only=True)
class AblationStep:
    """A set of closed gaps that the study runs.

    Parameters
    ----------
    step : str
        "as shipped"; "in order": this gap and all before it closed; "alone": only this gap closed;
        "left open": all gaps closed but this one.
    gap : str
        Empty for the first.
    closed : frozenset of str
    """

    step: str
    gap: str
    closed: Closed


@dataclass(frozen=True, slots=True, kw_only=True)
class AblationPath:
    """A path from profile `default` to profile `matched`.

    Parameters
    ----------
    scene : Scene
    engine : str
    gaps : tuple of ModelDifference
        In the order in which they are closed.
    settings : tuple of Setting
        The engine's.
    shipped_timestep, matched_timestep : float
        In force at the two ends, s.
    """

    scene: Scene
    engine: str
    gaps: tuple[ModelDifference, ...]
    settings: tuple[Setting, ...]
    shipped_timestep: float
    matched_timestep: float

    @property
    def names(self) -> tuple[str, ...]:
        """The gaps by name, in order."""
        return tuple(gap.name for gap in self.gaps)

    def steps(self) -> Iterator[AblationStep]:
        """Yield the steps: as shipped, in order, each gap alone, each gap left open."""
        whole = frozenset(self.names)
        yield AblationStep(step="as shipped", gap="", closed=frozenset())
        for count, name in enumerate(self.names, start=1):
            yield AblationStep(step="in order", gap=name, closed=frozenset(self.names[:count]))
        for name in self.names:
            yield AblationStep(step="alone", gap=name, closed=frozenset((name,)))
        for name in self.names:
            yield AblationStep(step="left open", gap=name, closed=whole - {name})

    def case(self, closed: Closed) -> Case:
        """Return the case in which just these gaps are closed."""
        if closed == frozenset(self.names):
            return Case(scene=self.scene, engine=self.engine, timestep=self.matched_timestep)
        names = {name for gap in self.gaps if gap.name in closed for name in gap.settings}
        timestep = self.matched_timestep if TIMESTEP in names else self.shipped_timestep
        options = tuple(
            (s.name, s.matched(timestep) if callable(s.matched) else s.matched)
            for s in self.settings
            if s.name in names
        )
        return Case(
            scene=self.scene,
            engine=self.engine,
            profile="default",
            timestep=timestep,
            options=options,
        )

    def cases(self) -> tuple[Case, ...]:
        """Return the cases of all steps, each once."""
        return tuple(dict.fromkeys(self.case(step.closed) for step in self.steps()))


def ablation_path(
    scene: Scene, engine_name: str, timestep: float | None = None, first: Sequence[str] = ()
) -> AblationPath:
    """Return the path for a scene in an engine.

    Parameters
    ----------
    scene : Scene
    engine_name : str
    timestep : float, optional
        Of the matched end, s; the profile's own if left out.
    first : sequence of str
        Gaps to close before the others, which follow in the engine's order.

    Raises
    ------
    HarnessError
        If there is no such engine or gap, the engine takes no timestep, or the scene has no truth
        or is chaotic.
    """
    check_exact(scene)
    chosen = engine(engine_name)
    shipped = timestep_of(Case(scene=scene, engine=engine_name, profile="default"))
    matched = timestep_of(Case(scene=scene, engine=engine_name, timestep=timestep))
    if shipped is None or matched is None:
        raise InvalidSettingError("--engine", engine_name, "an engine that takes a timestep")
    gaps = {gap.name: gap for gap in all_gaps(chosen)}
    for name in first:
        if name not in gaps:
            raise InvalidSettingError("--first", name, ", ".join(gaps))
    return AblationPath(
        scene=scene,
        engine=engine_name,
        gaps=tuple(gaps[name] for name in dict.fromkeys((*first, *gaps))),
        settings=chosen.settings,
        shipped_timestep=shipped,
        matched_timestep=matched,
    )


def all_gaps(chosen: Engine) -> tuple[ModelDifference, ...]:
    """Return the gaps that an engine declares, and one more for each difference left over.

    So that all of them closed is profile `matched`, whatever the engine forgot to declare.
    """
    declared = features_of(chosen).model_differences
    covered = {name for gap in declared for name in gap.settings}
    others = tuple(
        ModelDifference(name=setting.name, settings=(setting.name,), sentence=setting.meaning)
        for setting in chosen.settings
        if setting.name not in covered
        and (callable(setting.matched) or setting.matched != setting.default)
    )
    last = ModelDifference(
        name="timestep", settings=(TIMESTEP,), sentence="The timestep as shipped is longer."
    )
    return declared + others + (() if TIMESTEP in covered else (last,))
