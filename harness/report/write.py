"""Write a report: the page, its figures and tables as files, a summary and a manifest."""

import hashlib
import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from harness.artefact import Artefact, Figure, Replay, Table
from harness.provenance import Provenance
from harness.report.chapter import Chapter, ordered
from harness.report.contents import Picture, Report, arranged, named
from harness.report.folder import FORMAT, MANIFEST, replacing
from harness.report.html import page
from harness.report.junit import junit
from harness.report.palette import palette
from harness.report.plain import plain
from harness.report.printed import printed
from harness.report.scorecard import derived
from harness.report.stored import ARTEFACTS, spelled
from harness.report.summary import summary
from harness.report.tables import csv_text, dictionary, parquet_bytes
from harness.report.thinning import PAPER, SCREEN, thinned

VERSION = 1  # of the manifest's keys; a later one adds keys and removes none


def write_report(
    artefacts: Iterable[Artefact],
    out: Path,
    *,
    title: str,
    cases: Sequence[Mapping[str, Any]],
    provenance: Provenance,
) -> Path:
    """Write the report of one study as one folder, whole or not at all.

    Parameters
    ----------
    artefacts : iterable of Artefact
        In the order in which they are to be read. A text named "summary" and a table named
        "scorecard" open the page.
    out : Path
        The folder; an earlier report there is replaced as a whole.
    title : str
    cases : sequence of mapping
        One for each case, with what JSON can hold. The keys `digest`, `label` and `command` are
        shown; a table cell in a column named `case` that holds a digest links to its case.
    provenance : Provenance

    Returns
    -------
    Path
        The page, `index.html`.

    Raises
    ------
    OutputError
        If `out` cannot be written, or is a folder that is not a report.
    """
    chapter = Chapter(
        title=title, artefacts=tuple(artefacts), cases=tuple(cases), provenance=provenance
    )
    return write_chapters([chapter], out, title=title, provenance=provenance)


def write_chapters(
    chapters: Sequence[Chapter], out: Path, *, title: str, provenance: Provenance
) -> Path:
    """Write one report of several studies.

    Parameters
    ----------
    chapters : sequence of Chapter
        At least one; the comparison of engines comes first on the page wherever it stands here.
    out, title, provenance
        As for `write_report`.

    Returns
    -------
    Path
        The page, `index.html`.

    Raises
    ------
    OutputError
        As for `write_report`.
    """
    report = _report([_fine(chapter) for chapter in ordered(chapters)], title, provenance)
    with replacing(out) as draft:
        _write_files(report, draft)
        manifest = {
            "format": FORMAT,
            "version": VERSION,
            "title": title,
            "provenance": provenance.to_dict(),
            "cases": [plain(case) for case in report.cases],
            "files": _listed(draft),
        }
        text = json.dumps(manifest, indent=1, ensure_ascii=False, allow_nan=False)
        (draft / MANIFEST).write_text(text + "\n", encoding="utf-8")
    return out / "index.html"


def _fine(chapter: Chapter) -> Chapter:
    """Return a chapter with its curves as the page shows them."""
    if chapter.fine:
        return chapter
    return replace(
        chapter,
        artefacts=tuple(
            thinned(artefact, SCREEN) if isinstance(artefact, Figure) else artefact
            for artefact in chapter.artefacts
        ),
    )


def _report(chapters: Sequence[Chapter], title: str, provenance: Provenance) -> Report:
    """Draw the figures and give everything its name."""
    above, below = named(derived(chapters), chapters)
    everything = {name: artefact for group in (above, *below) for name, artefact in group.items()}
    figures = {n: a for n, a in everything.items() if isinstance(a, Figure)}
    inks = palette(_kinds(everything.values()))
    opening, parts = arranged(
        above, [(chapter.title, group) for chapter, group in zip(chapters, below, strict=True)]
    )
    return Report(
        title=title,
        opening=opening,
        parts=parts,
        pictures={
            name: Picture(figure=figure, printed=printed(thinned(figure, PAPER), inks))
            for name, figure in figures.items()
        },
        tables={n: a for n, a in everything.items() if isinstance(a, Table)},
        inks=inks,
        cases=_once(chapters),
        provenance=provenance,
        chapters=tuple(chapters),
    )


def _kinds(artefacts: Iterable[Artefact]) -> Iterable[str]:
    """Yield whose curves there are."""
    for artefact in artefacts:
        if isinstance(artefact, Figure):
            yield from (series.kind for panel in artefact.panels for series in panel.series)
        if isinstance(artefact, Replay):
            yield from (body.kind for body in artefact.bodies)


def _once(chapters: Sequence[Chapter]) -> tuple[Mapping[str, Any], ...]:
    """Return the cases of all chapters, each once: studies share some."""
    found: dict[object, Mapping[str, Any]] = {}
    for case in (case for chapter in chapters for case in chapter.cases):
        found.setdefault(case.get("digest", id(case)), case)
    return tuple(found.values())


def _write_files(report: Report, folder: Path) -> None:
    (folder / "figures").mkdir()
    for name, picture in report.pictures.items():
        (folder / "figures" / f"{name}.png").write_bytes(picture.printed.png)
        _write_text(folder / "figures" / f"{name}.svg", picture.printed.svg)
    (folder / "tables").mkdir()
    for name, table in report.tables.items():
        _write_text(folder / "tables" / f"{name}.csv", csv_text(table))
        (folder / "tables" / f"{name}.parquet").write_bytes(parquet_bytes(table))
    _write_text(folder / ARTEFACTS, spelled(report.chapters))
    _write_text(folder / "columns.md", dictionary(report.tables.values()))
    _write_text(folder / "summary.md", summary(report))
    _write_text(folder / "junit.xml", junit(report))
    _write_text(folder / "index.html", page(report))


def _write_text(path: Path, text: str) -> None:
    path.write_bytes(text.encode("utf-8", errors="replace"))  # bytes: line ends stay as they are


def _listed(folder: Path) -> list[dict[str, str | int]]:
    """Return each file with its size and its SHA-256."""
    listed: list[dict[str, str | int]] = []
    for path in sorted(p for p in folder.rglob("*") if p.is_file()):
        content = path.read_bytes()
        listed.append(
            {
                "path": path.relative_to(folder).as_posix(),
                "bytes": len(content),
                "sha256": hashlib.sha256(content).hexdigest(),
            }
        )
    return listed
