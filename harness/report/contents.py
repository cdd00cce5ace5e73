"""A report before it is written: what there is, what opens it, and what belongs to which scene."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from harness.artefact import Figure, Prose, Table
from harness.provenance import Provenance
from harness.report.palette import Ink
from harness.report.printed import Printed

SUMMARY = "summary"
SCORECARD = "scorecard"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Picture:
    """A figure, and how it looks on paper."""

    figure: Figure
    printed: Printed


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Report:
    """Everything that a report says, in reading order; the keys name files and anchors."""

    title: str
    figures: Mapping[str, Picture]
    tables: Mapping[str, Table]
    texts: Mapping[str, Prose]
    inks: Mapping[str, Ink]
    cases: tuple[Mapping[str, Any], ...]
    provenance: Provenance


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Part:
    """What stands together in one section: the headline, a scene, or what is over all scenes."""

    scene: str
    figures: Mapping[str, Picture]
    tables: Mapping[str, Table]
    texts: Mapping[str, Prose]


def headline(report: Report) -> Part:
    """Return what opens the report: the texts named summary and the scorecard.

    Without a scorecard, the first table that is over all scenes, or else the first one of all.
    """
    texts = {n: t for n, t in report.texts.items() if t.name == SUMMARY}
    chosen = [n for n, t in report.tables.items() if t.name == SCORECARD]
    chosen = chosen or [n for n, t in report.tables.items() if not t.scene][:1]
    chosen = chosen or list(report.tables)[:1]
    return Part(scene="", figures={}, tables={n: report.tables[n] for n in chosen}, texts=texts)


def parts(report: Report) -> tuple[Part, ...]:
    """Return the sections after the headline: a scene each, then what is over all scenes."""
    opening = headline(report)
    named = [
        *(picture.figure.scene for picture in report.figures.values()),
        *(table.scene for table in report.tables.values()),
        *(text.scene for text in report.texts.values()),
    ]
    scenes = [*dict.fromkeys(scene for scene in named if scene), ""]
    found = [
        Part(
            scene=scene,
            figures={n: p for n, p in report.figures.items() if p.figure.scene == scene},
            tables={
                n: t
                for n, t in report.tables.items()
                if t.scene == scene and n not in opening.tables
            },
            texts={
                n: t for n, t in report.texts.items() if t.scene == scene and n not in opening.texts
            },
        )
        for scene in scenes
    ]
    return tuple(part for part in found if part.figures or part.tables or part.texts)
