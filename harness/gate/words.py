"""Differences in words: of a gate, where one side is accepted, or of two sides that are alike."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

from harness.gate.comparison import OUTCOME, Change, Difference
from harness.gate.identity import Identity
from harness.gate.quantities import BY_COLUMN
from harness.gate.scores import Scores

REGRESSIONS = frozenset({Change.LARGER, Change.ONLY_FIRST})
"""What fails a gate: worse, or gone."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Wording:
    """What the two sides are called, and what becomes of a quantity between them.

    Parameters
    ----------
    first, second : str
    verdicts : mapping of Change to str
    """

    first: str
    second: str
    verdicts: Mapping[Change, str]

    def verdict(self, found: Difference) -> str:
        """Return the verdict on a difference."""
        return self.verdicts[found.change]


GATE = Wording(
    first="accepted",
    second="found",
    verdicts=MappingProxyType(
        {
            Change.LARGER: "worse",
            Change.SMALLER: "better",
            Change.SAME: "same",
            Change.UNDECIDABLE: "undecidable",
            Change.ONLY_FIRST: "missing",
            Change.ONLY_SECOND: "new",
            Change.INFORMATION: "not judged",
        }
    ),
)

SIDES = Wording(
    first="a",
    second="b",
    verdicts=MappingProxyType(
        {
            Change.LARGER: "a is better",
            Change.SMALLER: "b is better",
            Change.SAME: "same",
            Change.UNDECIDABLE: "undecidable",
            Change.ONLY_FIRST: "only in a",
            Change.ONLY_SECOND: "only in b",
            Change.INFORMATION: "not judged",
        }
    ),
)

_NAMED = 12
"""Cases that are named in words; a reader who needs more has the table."""


def changed(found: Iterable[Difference]) -> tuple[Difference, ...]:
    """Return what has changed, what got worse first, the largest factor first."""
    order = (Change.LARGER, Change.ONLY_FIRST, Change.SMALLER, Change.ONLY_SECOND)
    return tuple(
        sorted(
            (one for one in found if one.change in order),
            key=lambda one: (order.index(one.change), -one.severity, one.identity),
        )
    )


def regressions(found: Iterable[Difference]) -> tuple[Difference, ...]:
    """Return what fails a gate."""
    return tuple(one for one in changed(found) if one.change in REGRESSIONS)


def sentences(
    found: Sequence[Difference],
    first: Scores,
    second: Scores,
    wording: Wording,
    spreads: Scores | None = None,
) -> tuple[str, ...]:
    """Return what was compared, how it came out, and what has changed most, case by case."""
    cases = list(dict.fromkeys(one.identity for one in found))
    told = [
        f"{len(cases)} cases of {second.place} ({second.suite} suite) were held against "
        f"{first.place} ({first.suite} suite)" + _counts(found, wording) + ".",
        *_versions(first, second, wording),
        *_settings(first, second, wording),
    ]
    sides = [side for side in (first, second, spreads) if side is not None]
    if not any(score.members for side in sides for score in side.scores.values()):
        told.append("No spread was measured: whatever differs by more than a tenth counts.")
    moved = changed(found)
    for change in dict.fromkeys(one.change for one in moved):
        by_case = _by_case(one for one in moved if one.change is change)
        parts = [_case(own) for own in list(by_case.values())[:_NAMED]]
        more = len(by_case) - len(parts)
        parts += [f"and {more} more, in the table"] if more else []
        head = wording.verdicts[change]
        told.append(f"{head[:1].upper()}{head[1:]}: {'; '.join(parts)}.")
    return tuple(told)


def _by_case(moved: Iterable[Difference]) -> dict[Identity, list[Difference]]:
    """Return the differences of each case, in the order in which they come."""
    cases: dict[Identity, list[Difference]] = {}
    for one in moved:
        cases.setdefault(one.identity, []).append(one)
    return cases


def _counts(found: Sequence[Difference], wording: Wording) -> str:
    """Return how many quantities came out how."""
    counts = {change: sum(one.change is change for one in found) for change in Change}
    counts.pop(Change.INFORMATION)
    parts = [f"{count} {wording.verdicts[change]}" for change, count in counts.items() if count]
    return f": of {sum(counts.values())} quantities {', '.join(parts)}" if parts else ""


def _versions(first: Scores, second: Scores, wording: Wording) -> tuple[str, ...]:
    """Return a sentence on versions and machines that differ, which may explain the rest."""
    both = sorted(set(first.versions) & set(second.versions))
    parts = [
        f"{name} {first.versions[name]} {wording.first}, {second.versions[name]} {wording.second}"
        for name in both
        if first.versions[name] != second.versions[name]
    ]
    for key in ("platform", "processor", "python"):
        then, now = first.made.get(key), second.made.get(key)
        if then and now and then != now:
            parts.append(f"{key} '{then}' {wording.first}, '{now}' {wording.second}")
    return (f"They differ in: {'; '.join(parts)}.",) if parts else ()


def _settings(first: Scores, second: Scores, wording: Wording) -> tuple[str, ...]:
    """Return a sentence for each side that was run with settings of its own."""
    return tuple(
        f"On top of the suite, {name} has set: "
        f"{', '.join(f'{key} = {value}' for key, value in side.settings.items())}."
        for side, name in ((first, wording.first), (second, wording.second))
        if side.settings
    )


def _case(own: Sequence[Difference]) -> str:
    """Return the largest change of a case, and how many others there are."""
    worst = own[0]
    words = f"{worst.identity.label()}{_change(worst)}"
    return words + (f" and {len(own) - 1} more" if len(own) > 1 else "")


def _change(one: Difference) -> str:
    """Return a change in words."""
    if one.quantity == OUTCOME:
        return f", {one.note}" if one.note else ""
    quantity = BY_COLUMN[one.quantity]
    unit = f" {quantity.unit}" if quantity.unit else ""
    if one.first is None or one.second is None:
        return f", {quantity.words}: {one.note}"
    return f", {quantity.words} {one.first:.3g}{unit} -> {one.second:.3g}{unit}" + _times(one)


def _times(one: Difference) -> str:
    """Return the factor in words, where it is a number."""
    factor = one.factor
    if factor is None or not 0.0 < factor < float("inf"):
        return ""
    return f" ({factor:.3g} times)"
