"""The report of a history: what changed at which release, in words, in a figure and in tables."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from math import inf

import numpy as np
from packaging.version import Version

from harness.core.report_model import Artefact, Column, Figure, Panel, Prose, Series, table_of
from harness.gate.comparison import FACTOR, OUTCOME, SPREADS, Difference
from harness.results.result import Result
from harness.results.scores import BY_COLUMN, CaseIdentity, QuantityKind
from harness.studies.shared import run_columns


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Change:
    """A quantity of a case that changed from one release to a later one.

    Parameters
    ----------
    before, after : str
        Versions that ran the case, and no version between them did.
    between : tuple of str
        Releases between the two that could run the case and did not.
    difference : Difference
        From the one to the other.
    """

    before: str
    after: str
    between: tuple[str, ...]
    difference: Difference


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ChangePoint:
    """All that changed from one release to another.

    Parameters
    ----------
    before, after : str
        Versions.
    between : int
        Releases between the two that did not run all of the cases that changed.
    cases, quantities : int
        How many changed.
    largest : Difference
        What changed most: an outcome first, then contact and errors, by the factor.
    """

    before: str
    after: str
    between: int
    cases: int
    quantities: int
    largest: Difference


def change_points(changes: Sequence[Change]) -> tuple[ChangePoint, ...]:
    """Return changes by the releases between which they lie, in their order."""
    points = []
    for (before, after), group in groupby(changes, key=lambda c: (c.before, c.after)):
        own = list(group)
        points.append(
            ChangePoint(
                before=before,
                after=after,
                between=max(len(change.between) for change in own),
                cases=len({change.difference.identity for change in own}),
                quantities=len(own),
                largest=max((change.difference for change in own), key=_weight),
            )
        )
    return tuple(points)


@dataclass(frozen=True, slots=True, kw_only=True)
class ReleaseRow:
    """What became of a release.

    Parameters
    ----------
    version : str
    environment : str
        Name of the engine in its environment; empty if it could not be installed.
    cases, refused : int
        Cases that ran, and cases that the adapter could not run with the release.
    quantities : int
        Of the cases that ran, together; times on this machine are none.
    reason : str
        Why it could not be installed, or why the first case was refused.
    bisecting : bool
        Whether it was run to find a change between two others.
    """

    version: str
    environment: str
    cases: int
    quantities: int
    refused: int
    reason: str
    bisecting: bool

    @property
    def outcome(self) -> str:
        """Return the outcome in words."""
        if not self.environment:
            return "not installed"
        if not self.cases:
            return "the adapter does not run it"
        return "ran cases that changed" if self.bisecting else "ran"


_RELEASES = (
    Column("version", "Released version of the engine's package."),
    Column("outcome", "Whether it was installed, and ran the suite."),
    Column("cases", "Cases that ran."),
    Column("quantities", "Quantities of these cases that are compared, together."),
    Column("refused", "Cases that the adapter could not run with this version."),
    Column("reason", "Why it was not installed, or why the first case was refused."),
    Column("environment", "Name of the engine in its environment.", shown=False),
)

_CHANGES = (
    Column("from_version", "The last release, of those that ran the case, before it.", "before"),
    Column("to_version", "The release with the change.", "after"),
    Column(
        "between",
        "Releases between the two that did not run the case; 0 names the release of the change.",
        lambda change: len(change.between),
    ),
    run_columns.SCENE.of("difference.identity.scene"),
    run_columns.PROFILE.of("difference.identity.profile"),
    Column(
        "timestep_s",
        "Timestep that was asked for; empty for the profile's own.",
        lambda change: change.difference.identity.timestep or None,
    ),
    Column("quantity", "A column of the table of results, or the outcome.", "difference.quantity"),
    Column("before", "Its magnitude in the earlier release.", "difference.first"),
    Column("after", "Its magnitude in the later release.", "difference.second"),
    Column("factor", "After over before.", "difference.factor"),
    Column(
        "tolerance",
        f"How much may differ: {SPREADS:g} spreads, and what round-off alone makes.",
        "difference.tolerance",
    ),
    Column("note", "What the numbers do not say.", "difference.note"),
    Column("case", "Digest of the case in the later release.", "difference.digest", shown=False),
)


_POINTS = (
    Column("from_version", "The last release, of those that ran the cases, before it.", "before"),
    Column("to_version", "The release with the changes.", "after"),
    Column("between", "Releases between the two that did not run the cases."),
    Column("cases", "Cases that changed."),
    Column("quantities", "Quantities of these cases that changed, together."),
    run_columns.SCENE.of("largest.identity.scene"),
    run_columns.PROFILE.of("largest.identity.profile"),
    Column(
        "timestep_s",
        "Timestep that was asked for; empty for the profile's own.",
        lambda point: point.largest.identity.timestep or None,
    ),
    Column(
        "quantity",
        "What changed most: an outcome, or a column of the table of results.",
        "largest.quantity",
    ),
    Column("before", "Its magnitude in the earlier release.", "largest.first"),
    Column("after", "Its magnitude in the later release.", "largest.second"),
    Column("factor", "After over before.", "largest.factor"),
)


def history_report(
    title: str,
    scores: Mapping[str, Result],
    changes: Sequence[Change],
    releases: Sequence[ReleaseRow],
    newest: str,
) -> tuple[Artefact, ...]:
    """Return words, the figure if anything changed, and tables of the changes and the releases.

    Parameters
    ----------
    title : str
        Of the study.
    scores : mapping of str to Scores
        By version, the oldest first.
    changes : sequence of Change
    releases : sequence of ReleaseRow
    newest : str
        The release whose spread was measured; empty if no release ran.
    """
    points = change_points(changes)
    figure = _figure(title, scores, changes)
    return (
        Prose(
            name="summary",
            title=f"When contact changed: {title}",
            text="\n\n".join(_sentences(scores, points, releases, newest)),
        ),
        *((figure,) if figure else ()),
        table_of("change-points", "Releases that changed something", _POINTS, points),
        table_of("changes", "What changed from one release to the next", _CHANGES, changes),
        table_of("versions", "The releases", _RELEASES, releases),
    )


def _sentences(
    scores: Mapping[str, Result],
    points: Sequence[ChangePoint],
    releases: Sequence[ReleaseRow],
    newest: str,
) -> list[str]:
    """Return the paragraphs of the summary."""
    ran = [row for row in releases if row.cases]
    cases = {case for own in scores.values() for case in own.scores}
    absent = [f"{row.version} ({row.outcome}: {row.reason})" for row in releases if not row.cases]
    said = f"{len(cases)} cases were run in {len(ran)} of {len(releases)} releases"
    said += f", {ran[0].version} to {ran[-1].version}." if ran else "."
    if newest:
        said += (
            f" How far a result moves when nothing has changed was measured in {newest}, and of a "
            "change that was not clear in its own two releases."
        )
    if absent:
        said += f" Without a result: {'; '.join(absent)}."
    paragraphs = [said]
    paragraphs += map(_change_point, points)
    if not points:
        paragraphs.append(
            "No quantity of any case changed between two releases by more than its tolerance and "
            f"by more than a factor of {FACTOR:g}."
        )
    return paragraphs


def _change_point(point: ChangePoint) -> str:
    """Return what changed between two releases, in words."""
    head = (
        f"Between {point.before} and {point.after}: {point.quantities} "
        f"{'quantity' if point.quantities == 1 else 'quantities'} of {point.cases} "
        f"{'case' if point.cases == 1 else 'cases'} changed"
    )
    if point.between:
        head += f" ({point.between} releases between the two were not run)"
    return f"{head}. {_words(point.largest)}."


def _weight(difference: Difference) -> tuple[bool, bool, float]:
    """Return what orders changes: an outcome first, then contact and errors, then the factor."""
    quantity = BY_COLUMN.get(difference.quantity)
    of_motion = quantity is None or quantity.kind in {QuantityKind.ERROR, QuantityKind.CONTACT}
    finite = difference.severity if difference.severity < inf else 0.0
    return difference.quantity == OUTCOME, of_motion, finite


_PROFILES = {"default": "as shipped", "matched": "matched", "adaptive": "with adaptive steps"}


def _case(case: CaseIdentity) -> str:
    """Return a case in words."""
    step = f" at {case.timestep:g} s" if case.timestep else ""
    options = f" {case.options}" if case.options else ""
    return f"{case.scene} {_PROFILES.get(case.profile, case.profile)}{step}{options}"


def _words(difference: Difference) -> str:
    """Return a change in a sentence, without its full stop."""
    case = _case(difference.identity)
    if difference.quantity == OUTCOME:
        return f"The outcome of {case}: {difference.note}"
    quantity = BY_COLUMN[difference.quantity]
    unit = f" {quantity.unit}" if quantity.unit else ""
    if difference.first is None or difference.second is None:
        return f"Of {case}, the {quantity.words} {difference.note}"
    factor = difference.factor
    by = f"by a factor of {factor:.3g}, " if factor is not None and factor < inf else ""
    return (
        f"Most changed the {quantity.words} of {case}: {by}from {difference.first:.3g}{unit} to "
        f"{difference.second:.3g}{unit}"
    )


_PANELS, _LINES = 4, 6
"""Quantities that are drawn, and cases of each: those that changed most."""


def _figure(title: str, scores: Mapping[str, Result], changes: Sequence[Change]) -> Figure | None:
    """Return the figure of the quantities that changed, over the releases; None without any."""
    moved: dict[str, dict[CaseIdentity, float]] = {}
    for own in (change.difference for change in changes):
        quantity = BY_COLUMN.get(own.quantity)
        if quantity is not None and own.severity < inf:
            cases = moved.setdefault(own.quantity, {})
            cases[own.identity] = max(own.severity, cases.get(own.identity, 0.0))
    if not moved:
        return None
    kinds = list(QuantityKind)
    drawn = sorted(
        moved, key=lambda q: (kinds.index(BY_COLUMN[q].kind) > 1, -max(moved[q].values()))
    )
    versions = sorted(scores, key=Version)
    panels = tuple(_panel(name, moved[name], versions, scores) for name in drawn[:_PANELS])
    return Figure(
        name="history",
        title=f"Quantities that changed: {title}",
        seen=(
            "Each line is a case, relative to the first release that ran it. "
            f"{len(moved)} of {len(BY_COLUMN)} quantities changed in at least one case; drawn are "
            f"the {len(panels)} that changed most, each in at most {_LINES} cases."
        ),
        panels=panels,
        columns=1,
    )


def _panel(
    name: str,
    cases: Mapping[CaseIdentity, float],
    versions: Sequence[str],
    scores: Mapping[str, Result],
) -> Panel:
    """Return the lines of one quantity."""
    series = []
    for case in sorted(cases, key=lambda case: (-cases[case], case))[:_LINES]:
        values = [
            (place, abs(own.values[name]))
            for place, version in enumerate(versions)
            if (own := scores[version].scores.get(case)) is not None and name in own.values
        ]
        first = next((value for _, value in values if value > 0.0), None)
        if first is not None:
            series.append(
                Series(
                    label=_case(case),
                    kind=_case(case),
                    x=np.array([float(place) for place, _ in values]),
                    y=np.array([value / first if value > 0.0 else np.nan for _, value in values]),
                    mark="both",
                    hover=tuple(f"{versions[place]}: {value:.4g}" for place, value in values),
                )
            )
    return Panel(
        title=BY_COLUMN[name].words,
        x_label="release",
        y_label="relative to the first",
        series=tuple(series),
        log_y=True,
        x_names=tuple(versions),
    )
