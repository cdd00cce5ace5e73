"""The path from an engine as it ships to the matched one, one gap closed at a time.

Every step of the path is a set of closed gaps, and every set of closed gaps is a case: profile
`default` with the settings of the closed gaps put to their matched values, all of them closed being
profile `matched` itself. A setting whose matched value goes with the timestep takes its value for
the timestep in force there.

The parts of a discrepancy: with its level D(S) in which the set S of gaps is closed, gaps 1 to n,

- the whole, D({}) - D({1..n}), is what closing all of them takes away;
- in order, D({1..k-1}) - D({1..k}), which sum to the whole: each level is added and taken once;
- alone, D({}) - D({k}), whose sum is off the whole by the *interaction*: what they do together;
- left open, D(all but k) - D(all), likewise, seen from the matched end.

A level that is not known leaves what rests on it unknown, and nothing else.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

from harness.core.case import Case
from harness.core.errors import InvalidSettingError
from harness.engines.base import TIMESTEP, Engine, ModelDifference, Setting, features_of
from harness.engines.ladder import finer_by, takes_timestep
from harness.engines.reference.assumption_checks import check_exact
from harness.engines.registry import engine, timestep_of
from harness.metrics.quantities import Number, Quantity, less
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
    shipped_timestep, matched_timestep : float or None
        In force at the two ends, s; None of an engine that chooses its own steps.
    """

    scene: Scene
    engine: str
    gaps: tuple[ModelDifference, ...]
    settings: tuple[Setting, ...]
    shipped_timestep: float | None
    matched_timestep: float | None

    @property
    def finest(self) -> str:
        """The timestep of the matched end, or the accuracy in its place, in words."""
        if self.matched_timestep is not None:
            return f"a timestep of {self.matched_timestep:.2g} s"
        along = finer_by(self.engine)
        (accuracy,) = (s.matched for s in self.settings if s.name == along)
        return f"{along} {accuracy}"

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
            (s.name, s.matched(timestep or 0.0) if callable(s.matched) else s.matched)
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
        If there is no such engine or gap, the engine takes no steps, or the scene has no truth or
        is chaotic.
    """
    check_exact(scene)
    chosen = engine(engine_name)
    shipped = timestep_of(Case(scene=scene, engine=engine_name, profile="default"))
    matched = timestep_of(Case(scene=scene, engine=engine_name, timestep=timestep))
    if matched is None and takes_timestep(engine_name):
        raise InvalidSettingError("--engine", engine_name, "an engine that moves a can by steps")
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
    if TIMESTEP in covered or features_of(chosen).description.accuracy_setting:
        return declared + others
    return (*declared, *others, last)


@dataclass(frozen=True, slots=True, kw_only=True)
class Account:
    """What each gap of a path takes away of one discrepancy. None is not known.

    Parameters
    ----------
    path : AblationPath
        With n gaps.
    quantity : Quantity
        The discrepancy.
    levels : tuple, length n + 1
        Discrepancy as shipped and after each gap.
    in_order, alone, left_open : tuple, length n
        What each gap takes away: after those before it, by itself, and as the last one.
    """

    path: AblationPath
    quantity: Quantity
    levels: tuple[Number, ...]
    in_order: tuple[Number, ...]
    alone: tuple[Number, ...]
    left_open: tuple[Number, ...]

    def by_gap(self, parts: Sequence[Number]) -> dict[str, float]:
        """Return the known parts by the name of their gap."""
        pairs = zip(self.path.names, parts, strict=True)
        return {name: part for name, part in pairs if part is not None}

    @property
    def as_shipped(self) -> Number:
        """Discrepancy with all gaps open."""
        return self.levels[0]

    @property
    def remains(self) -> Number:
        """Discrepancy with all gaps closed."""
        return self.levels[-1]

    @property
    def whole(self) -> Number:
        """What closing all gaps takes away."""
        return less(self.as_shipped, self.remains)

    @property
    def sum_alone(self) -> Number:
        """What the gaps alone take away, all together."""
        return total(self.alone)

    @property
    def interaction(self) -> Number:
        """What the gaps alone take away, all together, beyond the whole."""
        return less(self.sum_alone, self.whole)

    @property
    def interaction_left_open(self) -> Number:
        """The same, seen from the matched end."""
        return less(total(self.left_open), self.whole)

    @property
    def unit(self) -> tuple[str, float]:
        """The unit in words and figures, and the factor from the unit of the column to it."""
        unit = self.quantity.unit
        return {"m": ("mm", 1e3), "rad": ("mrad", 1e3)}.get(unit, (unit, 1.0))

    def words(self, value: Number, *, unit: bool = True) -> str:
        """Return a discrepancy in words, also one that is not known."""
        if value is None:
            return "an unknown part"
        word, scale = self.unit
        number = f"{value * scale:+.3g}"
        return f"{number} {word}".rstrip() if unit else number

    def in_order_sentence(self) -> str:
        """Return a sentence on the part that each gap takes away, largest first."""
        path, known = self.path, self.by_gap(self.in_order)
        least = _NOTHING * max(abs(value) for value in self.levels if value is not None)
        parts = "; ".join(
            f"{name} nothing"
            if abs(known.get(name, math.inf)) <= least
            else f"{name} {self.words(known.get(name), unit=False)}"
            for name in sorted(path.names, key=lambda name: -abs(known.get(name, 0.0)))
        )
        return (
            f"As it ships, {path.engine} is off by {self.words(self.as_shipped)} in the "
            f"{self.quantity.label} of {path.scene.name}, and matched, at {path.finest}, "
            f"by {self.words(self.remains)}; closing the gaps "
            f"in the order {', '.join(path.names)} takes away, largest first: {parts}"
        )

    def interaction_sentence(self) -> str:
        """Return how far the gaps alone are from the whole, and which gap is behind it most."""
        early, late = self.by_gap(self.alone), self.by_gap(self.in_order)
        if self.whole is None or self.sum_alone is None or self.interaction is None:
            unknown = ", ".join(name for name in self.path.names if name not in early)
            return (
                f"Together they take away {self.words(self.whole)}; how they interact is not known,"
                f" because the discrepancy with one gap closed alone is not, for {unknown}"
            )
        opening = (
            "Closed one by one from the engine as it ships, they add up to "
            f"{self.words(self.sum_alone)}"
        )
        if abs(self.interaction) <= _HARDLY * abs(self.whole):
            return f"{opening}, the whole to within {_HARDLY:.0%}, so that they hardly interact"
        sentence = (
            f"{opening}, where the whole is {self.words(self.whole)}: an interaction of "
            f"{self.words(self.interaction)}"
        )
        if not late:
            return sentence
        name = max(late, key=lambda name: (abs(late[name] - early[name]), name))
        return (
            f"{sentence}, most of it in {name}, which takes away {self.words(early[name])} alone "
            f"and {self.words(late[name])} after those before it"
        )


_NOTHING = 1e-6
"""Share of the largest discrepancy on the path below which a gap takes away nothing."""

_HARDLY = 0.01
"""Share of the whole below which an interaction is not worth a word."""


def account(path: AblationPath, quantity: Quantity, level: Callable[[Closed], Number]) -> Account:
    """Return the parts of a discrepancy, given its level with any set of gaps closed."""
    names, whole = path.names, frozenset(path.names)
    levels = tuple(level(frozenset(names[:count])) for count in range(len(names) + 1))
    return Account(
        path=path,
        quantity=quantity,
        levels=levels,
        in_order=tuple(map(less, levels[:-1], levels[1:])),
        alone=tuple(less(levels[0], level(frozenset((name,)))) for name in names),
        left_open=tuple(less(level(whole - {name}), levels[-1]) for name in names),
    )


def total(parts: Sequence[Number]) -> Number:
    """Return the sum, if every part is known."""
    known = [part for part in parts if part is not None]
    return sum(known) if len(known) == len(parts) else None
