"""Survey of the contact at the rim: over tilts, turns, depths, sizes and distances from the origin.

It tells in sentences what an exact collider does not do, and below which tilt, by bisection.
"""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np

from harness.core.case import Case
from harness.core.errors import InvalidSettingError
from harness.engines.base import Engine, features_of
from harness.engines.description import Precision
from harness.engines.probes.rim_contact import Answer, Stance, answers, ask, asking, moved, turns
from harness.engines.probes.survey import Opener, with_gravity
from harness.engines.registry import engine
from harness.engines.remote import call_at_engine
from harness.engines.world import World
from models import Can

TILTS: tuple[float, ...] = (
    *np.logspace(-12.0, math.log10(0.49 * math.pi), 98).tolist(),
    math.pi / 2.0,
)
"""rad; eight to a decade, and a can that lies on its side."""

_EVERY = 6
_FEW = TILTS[:-1:_EVERY]
"""rad; where only the size or the distance from the origin is new."""

_SHALLOW: Mapping[Precision, float] = {Precision.DOUBLE: 1e-9, Precision.SINGLE: 1e-5}
_DEEP = 1e-3
"""Depths, of the radius; the shallow one is far above the round-off of a can at the origin."""

_ABOVE = -1e-3
"""The same of a can that does not touch."""

_OFF = 1e-3
"""Of the radius: a contact that is farther from the lowest point is not at the rim's."""

_TOO_DEEP = 1e-4
"""Of the radius: error of a depth that is told."""

_LEANING = 1e-3
"""rad: error of a normal that is told."""

_SIZES = (1e-3, 1.0)
_DISTANCES = (10.0, 1000.0)
"""m."""

_NEXT = 3
"""Places in `TILTS` that two wrong answers of one range are apart at most: where round-off decides,
some are right by chance."""

_EDGE = 1e-6
"""Relative width at which the bisection of an edge ends."""

_MOST_RANGES = 3
"""Of bad tilts that are told with their edges; where round-off decides there are many."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RimFinding:
    """What a collider does that an exact one does not.

    Parameters
    ----------
    kind : str
        By the tilt "contact", where there is none, "above", where there ought to be none, "place",
        "depth", "normal" or "count"; else "distance" from the origin, or "size".
    sentence : str
    below_tilt_rad : float
        Upper end of the range of tilts in which it does it most often; NaN where the tilt does not
        matter.
    place_error_m : float
        Largest distance from the lowest point, at any tilt; NaN without a contact.
    """

    kind: str
    sentence: str
    below_tilt_rad: float = math.nan
    place_error_m: float = math.nan


@dataclass(frozen=True, slots=True, kw_only=True)
class RimSurvey:
    """What a collider finds under a can.

    Parameters
    ----------
    tilts : tuple of float
        rad.
    found : tuple of tuple of Answer
        At each tilt, at every turn and depth.
    findings : tuple of RimFinding
    """

    tilts: tuple[float, ...]
    found: tuple[tuple[Answer, ...], ...]
    findings: tuple[RimFinding, ...]


Bad: TypeAlias = Callable[[Answer], bool]
Words: TypeAlias = Callable[[Sequence[Answer]], str]


def survey_rim(case: Case) -> RimSurvey:
    """Return what the collider of a case finds under its can, asked where the engine lives.

    Parameters
    ----------
    case : Case
        Gives can, engine and settings; gravity must not be zero.

    Raises
    ------
    InvalidSettingError
        If the engine has no contacts to ask for.
    HarnessError
        If the engine, a setting or a value does not exist.
    """
    return call_at_engine(case.engine, _surveyed, case)


def why_no_contacts(chosen: Engine) -> str:
    """Return what an engine is that has no contacts to ask for; empty if it has."""
    features = features_of(chosen)
    if features.open is None:
        return "it steps no world"
    if features.description.method.refusal:
        return "it imposes rolling as a constraint"
    return ""


def refuse_without_contacts(name: str) -> None:
    """Refuse an engine that has no contacts.

    Raises
    ------
    InvalidSettingError
        With what it is instead.
    """
    if why := why_no_contacts(engine(name)):
        allowed = f"an engine with contacts, of which '{name}' has none: {why}"
        raise InvalidSettingError("engine", name, allowed)


def _surveyed(case: Case) -> RimSurvey:
    """Return what the collider of a case finds, here."""
    refuse_without_contacts(case.engine)
    return _Asked(case).survey()


class _Asked:
    """The collider of a case, and what is asked of it."""

    def __init__(self, case: Case) -> None:
        self._case = with_gravity(case, case.scene.gravity)
        self._opener: Opener = engine(case.engine)  # type: ignore[assignment] # it opens worlds
        features = features_of(self._opener)
        precision = (
            features.precision(case) if features.precision else features.description.precision
        )
        self._depths = _SHALLOW[precision], _DEEP, _ABOVE
        self._can, self._world = self._of_size(case.scene.can.radius)

    def _of_size(self, radius: float) -> tuple[Can, World]:
        """Return a can of a radius (m), and a world of it."""
        can = self._case.scene.can
        scaled = Can.from_groups(mass=can.mass, radius=radius, a=can.a, c=can.c, h=can.h)
        scene = replace(self._case.scene, can=scaled)
        with asking("open"):
            return scaled, self._opener.open(replace(self._case, scene=scene))

    def survey(self) -> RimSurvey:
        """Return what is found in every stance."""
        stances = [self._stances(tilt) for tilt in TILTS]
        found = [answers(self._world, self._can, own) for own in stances]
        few = found[:-1:_EVERY]
        findings = [*self._of_tilts(found), *self._of_distances(few), *self._of_sizes(few)]
        return RimSurvey(tilts=TILTS, found=tuple(map(tuple, found)), findings=tuple(findings))

    def _stances(self, tilt: float, can: Can | None = None) -> list[Stance]:
        """Return a tilt at every turn and depth."""
        radius = (can or self._can).radius
        return list(turns(tilt, [share * radius for share in self._depths]))

    def _of_tilts(self, found: Sequence[Sequence[Answer]]) -> Iterator[RimFinding]:
        """Yield what depends on the tilt, at the origin."""
        radius = self._can.radius
        inside, above = (
            [[answer for answer in own if _is_inside(answer) is side] for own in found]
            for side in (True, False)
        )
        kinds: tuple[tuple[str, Bad, Words], ...] = (
            ("contact", lambda a: a.count == 0, _none),
            ("place", lambda a: a.place_error > _OFF * radius, _elsewhere),
            ("depth", lambda a: a.depth_error > _TOO_DEEP * radius, _other_depth),
            ("normal", lambda a: a.normal_error > _LEANING, _other_normal),
            ("count", _needlessly_many, _several),
        )
        for kind, bad, words in kinds:
            yield from self._findings(kind, inside, bad, words)
        yield from self._findings("above", above, lambda a: a.count > 0, _touches_above)

    def _findings(
        self, kind: str, found: Sequence[Sequence[Answer]], bad: Bad, words: Words
    ) -> Iterator[RimFinding]:
        """Yield where answers are bad, if any are: the range of tilts that has most of them."""
        ranges = _ranges([any(map(bad, own)) for own in found])
        if not ranges:
            return

        def all_bad(between: tuple[int, int]) -> list[Answer]:
            first, last = between
            return [answer for own in found[first : last + 1] for answer in own if bad(answer)]

        inside = _is_inside(found[0][0])
        ranges.sort(key=lambda between: len(all_bad(between)), reverse=True)
        edges = [self._edges(between, bad, inside=inside) for between in ranges[:_MOST_RANGES]]
        wrong = all_bad(ranges[0])
        everything = [answer for own in found[ranges[0][0] : ranges[0][1] + 1] for answer in own]
        others = [where for where, _ in edges[1:]]
        if len(ranges) > len(edges):
            others.append(f"in {len(ranges) - len(edges)} ranges more")
        also = f", and also {'; '.join(others)}" if others else ""
        every = (answer for between in ranges for answer in all_bad(between))
        where, high = edges[0]
        yield RimFinding(
            kind=kind,
            sentence=f"{where} {words(wrong)}{_how_often(wrong, everything)}{also}",
            below_tilt_rad=high,
            place_error_m=_largest(answer.place_error for answer in every),
        )

    def _edges(self, between: tuple[int, int], bad: Bad, *, inside: bool) -> tuple[str, float]:
        """Return a range of tilts in words, and its upper end, rad."""
        first, last = between
        low = self._edge(first, first - 1, bad, inside=inside) if first else 0.0
        high = TILTS[last]
        if last + 1 < len(TILTS):
            high = self._edge(last, last + 1, bad, inside=inside)
        if first == 0:
            return ("at every tilt" if last + 1 == len(TILTS) else f"below {high:.7g} rad"), high
        below = f" and below {high:.7g} rad" if last + 1 < len(TILTS) else ""
        return f"above {low:.7g} rad{below}", high

    def _edge(self, bad_at: int, good_at: int, bad: Bad, *, inside: bool) -> float:
        """Return the tilt between two of `TILTS` at which an answer begins to be bad, rad."""
        good, wrong = float(TILTS[good_at]), float(TILTS[bad_at])
        while abs(good / wrong - 1.0) > _EDGE:
            middle = math.sqrt(good * wrong)
            own = [each for each in self._stances(middle) if (each.depth > 0.0) is inside]
            if any(bad(ask(self._world, self._can, each)) for each in own):
                wrong = middle
            else:
                good = middle
        return wrong

    def _of_distances(self, near: Sequence[Sequence[Answer]]) -> Iterator[RimFinding]:
        """Yield what is found otherwise far from the origin than `near`, at `_FEW`."""
        ends = getattr(self._world, "ground_half_width", math.inf)
        for distance in (each for each in _DISTANCES if each < ends):
            far = [
                answers(self._world, self._can, moved(self._stances(tilt), distance))
                for tilt in _FEW
            ]
            where = f"{distance:,.0f} m from the origin"
            yield from self._otherwise("distance", where, near, far, 1.0)

    def _of_sizes(self, usual: Sequence[Sequence[Answer]]) -> Iterator[RimFinding]:
        """Yield what is found otherwise of smaller and larger cans than `usual`, at `_FEW`."""
        for radius in _SIZES:
            can, world = self._of_size(radius)
            other = [answers(world, can, self._stances(tilt, can)) for tilt in _FEW]
            size = f"{1e3 * radius:g} mm" if radius < 1.0 else f"{radius:g} m"
            scale = radius / self._can.radius
            yield from self._otherwise("size", f"at a radius of {size}", usual, other, scale)

    def _otherwise(
        self,
        kind: str,
        where: str,
        usual: Sequence[Sequence[Answer]],
        other: Sequence[Sequence[Answer]],
        scale: float,
    ) -> Iterator[RimFinding]:
        """Yield a finding where answers are wrong that usually are right.

        Parameters
        ----------
        kind, where : str
        usual, other : sequence of sequence of Answer
            At each tilt, at each turn and depth.
        scale : float
            Of the other can's size to the usual one's.
        """
        pairs = [
            (old, new)
            for both in zip(usual, other, strict=True)
            for old, new in zip(*both, strict=True)
            if _is_inside(old) and old.count
        ]
        lost = sum(not new.count for _, new in pairs)
        if lost:
            sentence = f"{where} no contact is found in {lost} of {len(pairs)} stances"
            yield RimFinding(kind=kind, sentence=sentence)
        for error, share, words in (
            ("place_error", _OFF, "the contact is {} off the lowest point"),
            ("depth_error", _TOO_DEEP, "the depth is {} off"),
        ):
            limit = share * self._can.radius
            errors = [(getattr(old, error), getattr(new, error)) for old, new in pairs if new.count]
            worse = [new for old, new in errors if new / scale > limit and old <= limit]
            if worse:
                sentence = f"{where} {words.format(_millimetres(max(worse)))}"
                far = max(worse) if error == "place_error" else math.nan
                yield RimFinding(kind=kind, sentence=sentence, place_error_m=far)


_NEARLY_ALL = 0.99


def _how_often(wrong: Sequence[Answer], everything: Sequence[Answer]) -> str:
    """Return in words at how many turns answers are wrong, or how often where it is at all."""
    turned, every = (
        {(answer.stance.heading, answer.stance.upside_down) for answer in each}
        for each in (wrong, everything)
    )
    if len(turned) < len(every):
        return f", at {len(turned)} of {len(every)} turns"
    share = len(wrong) / len(everything)
    return "" if share > _NEARLY_ALL else f", in {share:.0%} of the stances"


def _ranges(flags: Sequence[bool]) -> list[tuple[int, int]]:
    """Return first and last place of each range of true flags, with at most two false between."""
    ranges: list[tuple[int, int]] = []
    for place in np.flatnonzero(flags).tolist():
        if ranges and place - ranges[-1][1] <= _NEXT:
            ranges[-1] = ranges[-1][0], place
        else:
            ranges.append((place, place))
    return ranges


def _largest(values: Iterable[float]) -> float:
    """Return the largest of some numbers, NaN left out; NaN if nothing else is there."""
    return max((value for value in values if not math.isnan(value)), default=math.nan)


def _millimetres(length: float) -> str:
    """Return a length, m, in words."""
    return f"{1e3 * length:.3g} mm"


def _none(_: Sequence[Answer]) -> str:
    return "no contact is found of a can that is in the ground"


def _elsewhere(wrong: Sequence[Answer]) -> str:
    off = _millimetres(_largest(answer.place_error for answer in wrong))
    return f"the contact is {off} off the lowest point"


def _other_depth(wrong: Sequence[Answer]) -> str:
    return f"the depth is {_millimetres(_largest(a.depth_error for a in wrong))} off"


def _other_normal(wrong: Sequence[Answer]) -> str:
    return f"the normal leans by {_largest(a.normal_error for a in wrong):.2g} rad"


def _is_inside(answer: Answer) -> bool:
    """Whether the lowest point is in the ground."""
    return answer.stance.depth > 0.0


def _needlessly_many(answer: Answer) -> bool:
    """Whether there are several points where a quarter round the rim is above the ground already.

    A can that lies touches along a line, on any number of points.
    """
    stance = answer.stance
    at_a_quarter = math.sin(stance.tilt) * answer.radius - stance.depth
    return answer.count > 1 and at_a_quarter > 0.0 and stance.tilt < TILTS[-2]


def _several(wrong: Sequence[Answer]) -> str:
    counts = sorted({answer.count for answer in wrong})
    words = f"{counts[0]}" if len(counts) == 1 else f"{counts[0]} to {counts[-1]}"
    return f"a rim of which one point is in the ground has {words} contact points"


def _touches_above(wrong: Sequence[Answer]) -> str:
    height = _millimetres(-wrong[0].stance.depth)
    return f"a can that is {height} above the ground touches it"
