"""A report before it is written: its opening, and its sections.

The first chapter is told scene by scene, every further one in a section of its own.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from harness.core.plain_json import Record
from harness.core.provenance import Provenance
from harness.core.report_model import Artefact, Figure, Prose, Replay, Table
from harness.report.number_format import slugs
from harness.report.style import LineStyle

FIDELITY = "fidelity"
"""The table that only the comparison of engines has: every quantity and its verdict."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Section:
    """The whole of a report of one study, or a part of a report of several.

    Parameters
    ----------
    title : str
    artefacts : tuple of Artefact
        In reading order.
    cases : tuple of mapping
        One for each case, with what JSON can hold; the keys `digest`, `label` and `command` are
        shown.
    provenance : Provenance
    fine : bool
        Whether the curves are thinned already, as those that were read from a report are.
    """

    title: str
    artefacts: tuple[Artefact, ...]
    cases: tuple[Record, ...]
    provenance: Provenance
    fine: bool = False

    @property
    def compares(self) -> bool:
        """Whether it is the comparison of engines, which a page tells scene by scene."""
        return any(isinstance(a, Table) and a.name == FIDELITY for a in self.artefacts)


def ordered(chapters: Sequence[Section]) -> tuple[Section, ...]:
    """Return chapters as they are read: the comparison first, the others as they come."""
    return tuple(sorted(chapters, key=lambda chapter: not chapter.compares))


SUMMARY = "summary"
MATRICES = ("best", "shipped")
"""Tables of engines by scenes, which open the comparison."""

SCORECARD = "scorecard"
_OWN_NAME = "rockingcan, "  # what the titles of reports begin with, and sections need not


Named = Mapping[str, Artefact]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ReportPart:
    """What stands together in one section; the keys name files and anchors.

    Parameters
    ----------
    title : str
    leading : mapping of str to Prose or Table
        What comes before the figures: texts and tables.
    rest : mapping of str to Artefact
        Replays, figures, tables, texts, in this order.
    """

    title: str
    leading: Named
    rest: Named


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Report:
    """Everything that a report says.

    `on_paper` tells whether its folder has the figures as files for paper, but for those `undrawn`.
    """

    title: str
    opening: ReportPart
    parts: tuple[ReportPart, ...]
    figures: Mapping[str, Figure]
    on_paper: bool
    undrawn: frozenset[str] = frozenset()
    tables: Mapping[str, Table]
    inks: Mapping[str, LineStyle]
    cases: tuple[Mapping[str, Any], ...]
    provenance: Provenance
    chapters: tuple[Section, ...]


def unique_names(
    derived: Sequence[Artefact], chapters: Sequence[Section]
) -> tuple[Named, tuple[Named, ...]]:
    """Return derived tables, and each chapter's artefacts, under names unique in the report."""
    groups = [tuple(derived), *(chapter.artefacts for chapter in chapters)]
    given = iter(slugs(artefact.name for group in groups for artefact in group))
    first, *others = [{next(given): artefact for artefact in group} for group in groups]
    return first, tuple(others)


def arrange(
    derived: Named, chapters: Sequence[tuple[str, Named]]
) -> tuple[ReportPart, tuple[ReportPart, ...]]:
    """Return the opening of the report, and its sections.

    Parameters
    ----------
    derived : mapping
        Tables and words made from several chapters: those of no scene open the report, the others
        lead the section of their scene.
    chapters : sequence of (str, mapping)
        Title and artefacts.
    """
    opening = _opening(derived, chapters[0][1])
    used = set(opening.leading)
    first = {name: artefact for name, artefact in chapters[0][1].items() if name not in used}
    scenes = dict.fromkeys(a.scene for a in (*derived.values(), *first.values()) if a.scene)
    sections = [_part(scene, _of(first, scene), leading=_of(derived, scene)) for scene in scenes]
    sections.append(_part("Over all scenes", _of(first, "")))
    for title, artefacts in chapters[1:]:
        leading = _before(artefacts)
        others = {name: artefact for name, artefact in artefacts.items() if name not in leading}
        sections.append(_part(_heading(title), _with_scene(others), leading=leading))
    return opening, tuple(part for part in sections if part.leading or part.rest)


def _heading(title: str) -> str:
    """Return the title of a report as that of a section."""
    own = title.removeprefix(_OWN_NAME)
    return own[:1].upper() + own[1:]


def _before(artefacts: Named) -> Named:
    """Return the texts that a study puts before everything else, its summary among them."""
    first = next(
        (n for n, artefact in enumerate(artefacts.values()) if not isinstance(artefact, Prose)), 0
    )
    return {
        name: artefact
        for place, (name, artefact) in enumerate(artefacts.items())
        if isinstance(artefact, Prose) and (place < first or artefact.name == SUMMARY)
    }


def _with_scene(artefacts: Named) -> Named:
    """Return artefacts whose titles say their scene, where a section has several."""
    if len({artefact.scene for artefact in artefacts.values() if artefact.scene}) <= 1:
        return artefacts
    return {
        name: replace(artefact, title=f"{artefact.title}, {artefact.scene}")
        if artefact.scene
        else artefact
        for name, artefact in artefacts.items()
    }


def _opening(derived: Named, first: Named) -> ReportPart:
    """Return the matrices, the summary and the scorecards, or, without any, the first table.

    Words that were derived from the tables follow them.
    """
    own = _of(derived, "")
    matrices = {n: a for name in MATRICES for n, a in _named(first, Table, name).items()}
    tables = {**matrices, **_sorted(own, (Table,))} or _named(first, Table, SCORECARD)
    if not tables:
        every = _sorted(first, (Table,))
        chosen = list(_of(every, ""))[:1] or list(every)[:1]
        tables = {name: every[name] for name in chosen}
    words = _named(first, Prose, SUMMARY)
    leading = {**matrices, **words, **tables, **_sorted(own, (Prose,))}
    return ReportPart(title="Summary", leading=leading, rest={})


def _named(artefacts: Named, kind: type[Artefact], name: str) -> Named:
    """Return the artefacts of a kind and a name of their own."""
    return {n: a for n, a in artefacts.items() if isinstance(a, kind) and a.name == name}


def _of(artefacts: Named, scene: str) -> Named:
    return {name: artefact for name, artefact in artefacts.items() if artefact.scene == scene}


def _part(title: str, artefacts: Named, *, leading: Named | None = None) -> ReportPart:
    return ReportPart(
        title=title,
        leading=_sorted(leading or {}, (Prose, Table)),
        rest=_sorted(artefacts, (Replay, Figure, Table, Prose)),
    )


def _sorted(artefacts: Named, kinds: Sequence[type[Artefact]]) -> Named:
    """Return the artefacts of the given kinds, kind by kind."""
    return {n: a for kind in kinds for n, a in artefacts.items() if isinstance(a, kind)}
