"""The way from an engine as it ships to the matched one, one gap at a time.

Every place on the way is a set of closed gaps, and every set of closed gaps is a case: profile
`default` with the settings of the closed gaps put to their matched values, all of them closed being
profile `matched` itself. A setting whose matched value goes with the timestep takes its value for
the timestep in force there.

Who accounts for what: effects of the gaps in turn, alone and last, and their interaction.

With the discrepancy D(S) in which the set S of gaps is closed, and gaps 1 to n:

- the whole, D({}) - D({1..n}), is what closing all of them takes away;
- in order, D({1..k-1}) - D({1..k}), which sum to the whole: each level is added and taken once;
- alone, D({}) - D({k}), whose sum is off the whole by the *interaction*: what they do together;
- left open, D(all but k) - D(all), likewise, seen from the matched end.

A level that is not known leaves what rests on it unknown, and nothing else.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

from harness.core.case import Case, Value
from harness.core.errors import InvalidSettingError
from harness.engines.base import TIMESTEP, Engine, ModelDifference, Setting, features_of
from harness.engines.reference.assumption_checks import check_exact
from harness.engines.registry import engine, timestep_of
from models.scene import Scene

Closed = frozenset[str]
"""Names of the gaps that are closed."""


@dataclass(frozen=True, slots=True, kw_only=True)
class AblationPath:
    """A way from profile `default` to profile `matched`.

    Parameters
    ----------
    scene : Scene
    engine : str
    gaps : tuple of ModelDifference
        In the order in which they are closed.
    timestep : float or None
        Of the matched end as it was asked for, s; None is the profile's own.
    settings : tuple of Setting
        The engine's.
    shipped_timestep, matched_timestep : float
        In force at the two ends, s.
    """

    scene: Scene
    engine: str
    gaps: tuple[ModelDifference, ...]
    timestep: float | None
    settings: tuple[Setting, ...]
    shipped_timestep: float
    matched_timestep: float

    @property
    def names(self) -> tuple[str, ...]:
        """The gaps by name, in order."""
        return tuple(gap.name for gap in self.gaps)


@dataclass(frozen=True, slots=True, kw_only=True)
class AblationStep:
    """A place that the study looks at.

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


def ablation_path(
    scene: Scene, engine_name: str, timestep: float | None = None, first: Sequence[str] = ()
) -> AblationPath:
    """Return the way for a scene in an engine.

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
    end = Case(scene=scene, engine=engine_name, profile="matched", timestep=timestep)
    matched = timestep_of(end)
    if shipped is None or matched is None:
        raise InvalidSettingError("--engine", engine_name, "an engine that takes a timestep")
    return AblationPath(
        scene=scene,
        engine=engine_name,
        gaps=_ordered(all_gaps(chosen), first),
        timestep=timestep,
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


def _ordered(
    gaps: tuple[ModelDifference, ...], first: Sequence[str]
) -> tuple[ModelDifference, ...]:
    """Return the gaps with some of them put first."""
    known = {gap.name: gap for gap in gaps}
    for name in first:
        if name not in known:
            raise InvalidSettingError("--first", name, ", ".join(known))
    ahead = tuple(known[name] for name in dict.fromkeys(first))
    return ahead + tuple(gap for gap in gaps if gap.name not in first)


def stops(way: AblationPath) -> Iterator[AblationStep]:
    """Yield the places: as shipped, in order, each gap alone, each gap left open."""
    whole = frozenset(way.names)
    yield AblationStep(step="as shipped", gap="", closed=frozenset())
    for count, name in enumerate(way.names, start=1):
        yield AblationStep(step="in order", gap=name, closed=frozenset(way.names[:count]))
    for name in way.names:
        yield AblationStep(step="alone", gap=name, closed=frozenset((name,)))
    for name in way.names:
        yield AblationStep(step="left open", gap=name, closed=whole - {name})


def case(way: AblationPath, closed: Closed) -> Case:
    """Return the case in which just these gaps are closed."""
    if closed == frozenset(way.names):
        return Case(
            scene=way.scene, engine=way.engine, profile="matched", timestep=way.matched_timestep
        )
    names = {name for gap in way.gaps if gap.name in closed for name in gap.settings}
    timestep = way.matched_timestep if TIMESTEP in names else way.shipped_timestep
    return Case(
        scene=way.scene,
        engine=way.engine,
        profile="default",
        timestep=timestep,
        options=tuple(
            (setting.name, _matched(setting, timestep))
            for setting in way.settings
            if setting.name in names
        ),
    )


def _matched(setting: Setting, timestep: float) -> Value:
    """Return a setting's matched value at a timestep."""
    return setting.matched(timestep) if callable(setting.matched) else setting.matched


def attribution_cases(way: AblationPath) -> tuple[Case, ...]:
    """Return the cases of all places, each once."""
    return tuple(dict.fromkeys(case(way, stop.closed) for stop in stops(way)))


Level = float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class Account:
    """One quantity, all gaps. None is not known.

    Parameters
    ----------
    names : tuple of str, length n
        Gaps in the order of closing.
    levels : tuple, length n + 1
        Discrepancy as shipped and after each gap.
    in_order, alone, left_open : tuple, length n
        What each gap takes away: after those before it, by itself, and as the last one.
    """

    names: tuple[str, ...]
    levels: tuple[Level, ...]
    in_order: tuple[Level, ...]
    alone: tuple[Level, ...]
    left_open: tuple[Level, ...]

    @property
    def shipped(self) -> Level:
        """Discrepancy with all gaps open."""
        return self.levels[0]

    @property
    def remains(self) -> Level:
        """Discrepancy with all gaps closed."""
        return self.levels[-1]

    @property
    def whole(self) -> Level:
        """What closing all gaps takes away."""
        return difference(self.shipped, self.remains)

    @property
    def interaction(self) -> Level:
        """What the gaps alone take away, all together, beyond the whole."""
        return difference(total(self.alone), self.whole)

    @property
    def interaction_left_open(self) -> Level:
        """The same, seen from the matched end."""
        return difference(total(self.left_open), self.whole)


def account(names: Sequence[str], level: Callable[[frozenset[str]], Level]) -> Account:
    """Return who accounts for what.

    Parameters
    ----------
    names : sequence of str, length n
        Gaps in the order of closing.
    level : callable
        Discrepancy with a set of gaps closed.
    """
    whole = frozenset(names)
    levels = tuple(level(frozenset(names[:count])) for count in range(len(names) + 1))
    return Account(
        names=tuple(names),
        levels=levels,
        in_order=tuple(map(difference, levels[:-1], levels[1:])),
        alone=tuple(difference(levels[0], level(frozenset((name,)))) for name in names),
        left_open=tuple(difference(level(whole - {name}), levels[-1]) for name in names),
    )


def difference(first: Level, second: Level) -> Level:
    """Return the first less the second, if both are known."""
    return None if first is None or second is None else first - second


def total(parts: Sequence[Level]) -> Level:
    """Return the sum, if every part is known."""
    known = [part for part in parts if part is not None]
    return sum(known) if len(known) == len(parts) else None
