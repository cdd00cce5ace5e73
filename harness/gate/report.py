"""From differences to artefacts: the sentences, a figure of all factors, the table.

Differences in words: of a gate, where one side is accepted, or of two sides that are alike.
"""

import math
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby

import numpy as np

from harness.core.report_model import (
    Artefact,
    Column,
    Figure,
    Panel,
    Prose,
    Series,
    table_of,
)
from harness.core.verdict import Status, Verdict
from harness.gate.comparison import FACTOR, OUTCOME, SPREADS, Difference
from harness.results.result import Result
from harness.results.scores import BY_COLUMN, QUANTITIES, CaseIdentity, QuantityKind
from harness.studies.shared import run_columns

_MOVED = (Status.WORSE, Status.MISSING, Status.BETTER, Status.NEW)
"""What has changed, in the order in which it is named."""

_COUNTED = (
    *(Status.WORSE, Status.BETTER, Status.SAME, Status.UNDECIDABLE),
    *(Status.MISSING, Status.NEW),
)
"""In the order in which a sentence counts them."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Wording:
    """Words for the two sides, and for the status of a quantity between them.

    Parameters
    ----------
    first, second : str
    words : mapping of Status to str
        Where a status is not called by its own word.
    """

    first: str
    second: str
    words: Mapping[Status, str]

    def word(self, status: Status) -> str:
        """Return the word for a status."""
        return self.words.get(status, status.value)

    def verdict(self, difference: Difference) -> Verdict:
        """Return the verdict on a difference."""
        return Verdict(difference.status, self.word(difference.status))

    def columns(self) -> tuple[Column, ...]:
        """Return the columns of a table of differences."""
        return (
            run_columns.SCENE.of("identity.scene"),
            run_columns.ENGINE.of("identity.engine"),
            run_columns.PROFILE.of("identity.profile"),
            Column(
                "timestep_s",
                "Timestep that was asked for; empty for the profile's own.",
                lambda change: change.identity.timestep or None,
            ),
            Column("options", "Settings of the suite on top of the profile.", "identity.options"),
            Column("quantity", "A column of the table of results, or the outcome."),
            Column(self.first, "Its magnitude there.", "first"),
            Column(self.second, "Its magnitude here.", "second"),
            Column("spread", "Largest departure among releases that differ by 1e-9 or less."),
            Column(
                "tolerance",
                f"How much may differ: {SPREADS:g} spreads, and what round-off alone makes.",
            ),
            Column("factor", f"{self.second} over {self.first}."),
            Column(
                "verdict", f"Judged by the tolerance and by a factor of {FACTOR:g}.", self.verdict
            ),
            Column("note", "What the numbers do not say."),
            Column("case", "Digest of the case that made the number.", "digest"),
        )


GATE = Wording(first="accepted", second="found", words={Status.UNDECIDABLE: "undecidable"})
SIDES = Wording(
    first="a",
    second="b",
    words={
        **GATE.words,
        Status.WORSE: "a is better",
        Status.BETTER: "b is better",
        Status.MISSING: "only in a",
        Status.NEW: "only in b",
    },
)

COLUMNS = (*GATE.columns(), *SIDES.columns())
"""Columns of tables of differences, of both wordings."""

_NAMED = 12
"""Cases that are named in words; a reader who needs more has the table."""


def changed(differences: Iterable[Difference]) -> tuple[Difference, ...]:
    """Return the differences that count, what got worse first, the largest factor first."""
    return tuple(
        sorted(
            (d for d in differences if d.status in _MOVED),
            key=lambda d: (_MOVED.index(d.status), -d.severity, d.identity),
        )
    )


def regressions(differences: Iterable[Difference]) -> tuple[Difference, ...]:
    """Return the differences that fail a gate: worse, or missing."""
    return tuple(d for d in changed(differences) if d.status.failed)


def sentences(
    differences: Sequence[Difference],
    first: Result,
    second: Result,
    wording: Wording,
    spreads: Result | None = None,
) -> tuple[str, ...]:
    """Return sentences: cases compared, counts by status, and the largest changes case by case."""
    absent = [d for d in differences if d.status is Status.NOT_MEASURED]
    cases = {d.identity for d in differences} - {d.identity for d in absent}
    lines = [
        f"{len(cases)} cases of {second.place} ({second.suite} suite) were held against "
        f"{first.place} ({first.suite} suite)" + _counts(differences, wording) + ".",
        *_versions(first, second, wording),
        *_settings(first, second, wording),
        *_not_measured(absent),
    ]
    sides = [side for side in (first, second, spreads) if side is not None]
    if not any(score.members for side in sides for score in side.scores.values()):
        lines.append("No spread was measured: whatever differs by more than a tenth counts.")
    for status, moved in groupby(changed(differences), key=lambda d: d.status):
        by_case: dict[CaseIdentity, list[Difference]] = {}
        for d in moved:
            by_case.setdefault(d.identity, []).append(d)
        parts = [_case(own) for own in list(by_case.values())[:_NAMED]]
        more = len(by_case) - len(parts)
        parts += [f"and {more} more, in the table"] if more else []
        head = wording.word(status)
        lines.append(f"{head[:1].upper()}{head[1:]}: {'; '.join(parts)}.")
    return tuple(lines)


def _counts(differences: Sequence[Difference], wording: Wording) -> str:
    """Return how many quantities came out how."""
    counts = Counter(d.status for d in differences if d.status in _COUNTED)
    parts = [f"{counts[status]} {wording.word(status)}" for status in _COUNTED if counts[status]]
    return f": of {counts.total()} quantities {', '.join(parts)}" if parts else ""


def _versions(first: Result, second: Result, wording: Wording) -> tuple[str, ...]:
    """Return a sentence on versions and machines that differ, which may explain the rest."""
    both = sorted(set(first.versions) & set(second.versions))
    parts = [
        f"{name} {first.versions[name]} {wording.first}, {second.versions[name]} {wording.second}"
        for name in both
        if first.versions[name] != second.versions[name]
    ]
    then, now = first.machine.model_dump(), second.machine.model_dump()
    parts += [
        f"{key} '{then[key]}' {wording.first}, '{now[key]}' {wording.second}"
        for key in ("platform", "processor", "python")
        if then[key] != now[key]
    ]
    return (f"They differ in: {'; '.join(parts)}.",) if parts else ()


def _settings(first: Result, second: Result, wording: Wording) -> tuple[str, ...]:
    """Return a sentence for each side that was run with settings of its own."""
    return tuple(
        f"On top of the suite, {name} has set: "
        f"{', '.join(f'{key} = {value}' for key, value in side.settings.items())}."
        for side, name in ((first, wording.first), (second, wording.second))
        if side.settings
    )


def _not_measured(absent: Sequence[Difference]) -> Iterator[str]:
    """Yield a sentence for each reason why cases were not measured."""
    for reason, count in Counter(d.note for d in absent).items():
        yield f"Not measured: {count} accepted {'case' if count == 1 else 'cases'}: {reason}."


def _case(own: Sequence[Difference]) -> str:
    """Return the largest change of a case, and how many others there are."""
    worst = own[0]
    words = f"{worst.identity.label()}{change_words(worst)}"
    return words + (f" and {len(own) - 1} more" if len(own) > 1 else "")


def change_words(change: Difference) -> str:
    """Return a change in words, with the factor where it is a number."""
    if change.quantity == OUTCOME:
        return f", {change.note}" if change.note else ""
    quantity = BY_COLUMN[change.quantity]
    unit = f" {quantity.unit}" if quantity.unit else ""
    if change.first is None or change.second is None:
        return f", {quantity.words}: {change.note}"
    times = f" ({change.factor:.3g} times)" if _finite(change) else ""
    return f", {quantity.words} {change.first:.3g}{unit} -> {change.second:.3g}{unit}{times}"


def gate_report(
    differences: Sequence[Difference],
    first: Result,
    second: Result,
    wording: Wording,
    spreads: Result | None = None,
) -> tuple[Artefact, ...]:
    """Return the artefacts of a comparison; the text opens the report."""
    text = "\n\n".join(sentences(differences, first, second, wording, spreads))
    figure = factors(differences, wording)
    moved = changed(differences)
    return (
        Prose(name="summary", title="Against accepted results", text=text),
        *((figure,) if figure else ()),
        table_of(
            "gate",
            "Quantity by quantity, what has changed first",
            run_columns.without(wording.columns(), "options", "spread"),
            (*moved, *(d for d in differences if d.status not in _MOVED)),
        ),
    )


def factors(differences: Sequence[Difference], wording: Wording) -> Figure | None:
    """Return the figure of all factors, a panel an engine; None if nothing can be drawn."""
    drawn = [d for d in differences if d.status is not Status.NOT_JUDGED and _finite(d)]
    if not drawn:
        return None
    quantities = [q for q in QUANTITIES if q.kind is not QuantityKind.TIME]
    panels = [
        Panel(
            title=engine,
            x_label="quantity",
            y_label=f"{wording.second} over {wording.first}",
            series=_points([d for d in drawn if d.identity.engine == engine], wording),
            log_y=True,
            x_names=tuple(q.words for q in quantities),
        )
        for engine in dict.fromkeys(d.identity.engine for d in drawn)
    ]
    moved = [d for d in drawn if d.status in _MOVED]
    extreme = max(d.severity for d in drawn)
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


def _finite(change: Difference) -> bool:
    """Whether a difference has a factor that can be drawn."""
    return change.factor is not None and 0.0 < change.factor < math.inf


def _points(own: Sequence[Difference], wording: Wording) -> tuple[Series, ...]:
    """Return the points of an engine, a series for each verdict; changes have their own colour."""
    places = {quantity.column: float(place) for place, quantity in enumerate(QUANTITIES)}
    series = []
    for status in (Status.SAME, Status.UNDECIDABLE, Status.WORSE, Status.BETTER):
        chosen = [d for d in own if d.status is status]
        if chosen:
            label = wording.word(status)
            series.append(
                Series(
                    label=label,
                    kind=label if status in _MOVED else chosen[0].identity.engine,
                    x=np.array([places[d.quantity] for d in chosen]),
                    y=np.array([d.factor for d in chosen], dtype=np.float64),
                    mark="points",
                    hover=tuple(d.identity.label() for d in chosen),
                )
            )
    return tuple(series)
