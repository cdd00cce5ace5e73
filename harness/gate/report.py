"""From differences to artefacts: the sentences, a figure of all factors, the table.

Differences in words: of a gate, where one side is accepted, or of two sides that are alike.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from harness.core.report_model import (
    Artefact,
    Column,
    Figure,
    Panel,
    Prose,
    Series,
    Table,
    table_of,
)
from harness.core.verdict import Status, Verdict
from harness.gate.comparison import FACTOR, OUTCOME, SPREADS, Change, Difference
from harness.gate.scores import BY_COLUMN, QUANTITIES, CaseIdentity, QuantityKind, Scores
from harness.studies.comparison.tables import ENGINE, PROFILE, SCENE

REGRESSIONS = frozenset({Change.LARGER, Change.ONLY_FIRST})
"""What fails a gate: worse, or gone."""


STATUS = {
    Change.LARGER: Status.WORSE,
    Change.SMALLER: Status.BETTER,
    Change.SAME: Status.SAME,
    Change.UNDECIDABLE: Status.UNDECIDABLE,
    Change.ONLY_FIRST: Status.MISSING,
    Change.ONLY_SECOND: Status.NEW,
    Change.INFORMATION: Status.NOT_JUDGED,
}
"""What a change comes to where the first side is the one to hold the second against."""


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

    def verdict(self, found: Difference) -> Verdict:
        """Return the verdict on a difference."""
        return Verdict(STATUS[found.change], self.verdicts[found.change])

    def columns(self) -> tuple[Column, ...]:
        """Return the columns of a table of differences."""
        return (
            Column("scene", SCENE, lambda one: one.identity.scene),
            Column("engine", ENGINE, lambda one: one.identity.engine),
            Column("profile", PROFILE, lambda one: one.identity.profile),
            Column(
                "timestep_s",
                "Timestep that was asked for; empty for the profile's own.",
                lambda one: one.identity.timestep or None,
            ),
            Column(
                "options",
                "Settings of the suite on top of the profile.",
                lambda one: one.identity.options,
                shown=False,
            ),
            Column("quantity", "A column of the table of results, or the outcome."),
            Column(self.first, "Its magnitude there.", lambda one: one.first),
            Column(self.second, "Its magnitude here.", lambda one: one.second),
            Column(
                "spread",
                "Largest departure among releases that differ by 1e-9 or less.",
                shown=False,
            ),
            Column(
                "tolerance",
                f"How much may differ: {SPREADS:g} spreads, and what round-off alone makes.",
            ),
            Column("factor", f"{self.second} over {self.first}."),
            Column(
                "verdict", f"Judged by the tolerance and by a factor of {FACTOR:g}.", self.verdict
            ),
            Column("note", "What the numbers do not say."),
            Column("case", "Digest of the case that made the number.", lambda one: one.digest),
        )


_UNMOVED = {
    Change.SAME: "same",
    Change.UNDECIDABLE: "undecidable",
    Change.INFORMATION: "not judged",
}

GATE = Wording(
    first="accepted",
    second="found",
    verdicts={
        **_UNMOVED,
        Change.LARGER: "worse",
        Change.SMALLER: "better",
        Change.ONLY_FIRST: "missing",
        Change.ONLY_SECOND: "new",
    },
)

SIDES = Wording(
    first="a",
    second="b",
    verdicts={
        **_UNMOVED,
        Change.LARGER: "a is better",
        Change.SMALLER: "b is better",
        Change.ONLY_FIRST: "only in a",
        Change.ONLY_SECOND: "only in b",
    },
)

COLUMNS = (*GATE.columns(), *SIDES.columns())
"""Columns of tables of differences, of both wordings."""

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


def _by_case(moved: Iterable[Difference]) -> dict[CaseIdentity, list[Difference]]:
    """Return the differences of each case, in the order in which they come."""
    cases: dict[CaseIdentity, list[Difference]] = {}
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


def gate_report(
    found: Sequence[Difference],
    first: Scores,
    second: Scores,
    wording: Wording,
    spreads: Scores | None = None,
) -> tuple[Artefact, ...]:
    """Return the artefacts of a comparison; the text opens the report."""
    text = "\n\n".join(sentences(found, first, second, wording, spreads))
    figure = factors(found, wording)
    return (
        Prose(name="summary", title="Against accepted results", text=text),
        *((figure,) if figure else ()),
        table(found, wording),
    )


def table(found: Sequence[Difference], wording: Wording) -> Table:
    """Return the table of all differences, what has changed first."""
    first = changed(found)
    names = {id(one) for one in first}
    return table_of(
        "gate",
        "Quantity by quantity, what has changed first",
        wording.columns(),
        (*first, *(one for one in found if id(one) not in names)),
    )


def factors(found: Sequence[Difference], wording: Wording) -> Figure | None:
    """Return the figure of all factors, a panel an engine; None if nothing can be drawn."""
    drawn = [one for one in found if one.change is not Change.INFORMATION and _finite(one)]
    if not drawn:
        return None
    quantities = [q for q in QUANTITIES if q.kind is not QuantityKind.TIME]
    places = {q.column: float(place) for place, q in enumerate(quantities)}
    panels = []
    for engine in dict.fromkeys(one.identity.engine for one in drawn):
        own = [one for one in drawn if one.identity.engine == engine]
        kinds = {
            Change.SAME: engine,
            Change.UNDECIDABLE: engine,
            Change.LARGER: wording.verdicts[Change.LARGER],
            Change.SMALLER: wording.verdicts[Change.SMALLER],
        }
        series = [_points(own, change, kind, places, wording) for change, kind in kinds.items()]
        panels.append(
            Panel(
                title=engine,
                x_label="quantity",
                y_label=f"{wording.second} over {wording.first}",
                series=tuple(one for one in series if len(one.x)),
                log_y=True,
                x_names=tuple(q.words for q in quantities),
            )
        )
    moved = [one for one in drawn if one.change in {Change.LARGER, Change.SMALLER}]
    extreme = max((one.severity for one in drawn), default=1.0)
    return Figure(
        name="gate-factors",
        title=f"Every quantity, {wording.second} over {wording.first}",
        seen=(
            f"A point is a quantity of a case; on the line of one it is as it was. {len(moved)} of "
            f"{len(drawn)} have moved by more than their tolerance and by more than a factor of "
            f"{FACTOR:g}; the largest factor, either way, is {extreme:.3g}."
        ),
        panels=tuple(panels),
        columns=1,
    )


def _finite(one: Difference) -> bool:
    """Whether a difference has a factor that can be drawn."""
    return one.factor is not None and 0.0 < one.factor < math.inf


def _points(
    own: Sequence[Difference],
    change: Change,
    kind: str,
    places: dict[str, float],
    wording: Wording,
) -> Series:
    """Return the points of one verdict."""
    chosen = [one for one in own if one.change is change]
    return Series(
        label=wording.verdicts[change],
        kind=kind,
        x=np.array([places[one.quantity] for one in chosen]),
        y=np.array([one.factor for one in chosen], dtype=np.float64),
        mark="points",
        hover=tuple(one.identity.label() for one in chosen),
    )
