"""Write a report: the page, its figures and tables as files, a summary and a manifest."""

import hashlib
import json
import math
import numbers
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from harness.artefact import Artefact, Figure, Prose, Table
from harness.provenance import Provenance
from harness.report.contents import Picture, Report
from harness.report.folder import FORMAT, MANIFEST, replacing
from harness.report.html import page
from harness.report.naming import slugs
from harness.report.palette import palette
from harness.report.printed import printed
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
    """Write a report as one folder, whole or not at all.

    Parameters
    ----------
    artefacts : iterable of Figure, Table and Prose
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
    report = _report(artefacts, title=title, cases=cases, provenance=provenance)
    with replacing(out) as draft:
        _write_files(report, draft)
        manifest = {
            "format": FORMAT,
            "version": VERSION,
            "title": title,
            "provenance": provenance.to_dict(),
            "cases": [_json(case) for case in cases],
            "files": _listed(draft),
        }
        text = json.dumps(manifest, indent=1, ensure_ascii=False, allow_nan=False)
        (draft / MANIFEST).write_text(text + "\n", encoding="utf-8")
    return out / "index.html"


def _report(
    artefacts: Iterable[Artefact],
    *,
    title: str,
    cases: Sequence[Mapping[str, Any]],
    provenance: Provenance,
) -> Report:
    """Draw the figures and give everything its name."""
    read = tuple(artefacts)
    names = slugs(artefact.name for artefact in read)
    figures = [artefact for artefact in read if isinstance(artefact, Figure)]
    inks = palette(s.kind for figure in figures for panel in figure.panels for s in panel.series)
    pictures = {}
    for artefact, name in zip(read, names, strict=True):
        if isinstance(artefact, Figure):
            fine = thinned(artefact, SCREEN)
            pictures[name] = Picture(figure=fine, printed=printed(thinned(fine, PAPER), inks))
    return Report(
        title=title,
        figures=pictures,
        tables={n: a for a, n in zip(read, names, strict=True) if isinstance(a, Table)},
        texts={n: a for a, n in zip(read, names, strict=True) if isinstance(a, Prose)},
        inks=inks,
        cases=tuple(cases),
        provenance=provenance,
    )


def _json(value: object) -> object:
    """Return a value in JSON's own types: what JSON cannot say, infinity included, as text."""
    if isinstance(value, Mapping):
        return {str(key): _json(inner) for key, inner in value.items()}
    if isinstance(value, (list, tuple)):
        return [_json(inner) for inner in value]
    if value is None or isinstance(value, (str, bool)):
        return value
    if isinstance(value, numbers.Integral):
        return int(value)
    if isinstance(value, numbers.Real) and math.isfinite(value):
        return float(value)
    return str(value)


def _write_files(report: Report, folder: Path) -> None:
    (folder / "figures").mkdir()
    for name, picture in report.figures.items():
        (folder / "figures" / f"{name}.png").write_bytes(picture.printed.png)
        _write_text(folder / "figures" / f"{name}.svg", picture.printed.svg)
    (folder / "tables").mkdir()
    for name, table in report.tables.items():
        _write_text(folder / "tables" / f"{name}.csv", csv_text(table))
        (folder / "tables" / f"{name}.parquet").write_bytes(parquet_bytes(table))
    _write_text(folder / "columns.md", dictionary(report.tables.values()))
    _write_text(folder / "summary.md", summary(report))
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
