"""Write a report: the page, its tables as files, a summary, verdicts and a manifest.

The summary is the headline in Markdown, for pasting into a pull request. Figures for paper are
drawn when they are asked for, in processes of their own: one that dies costs its figure alone.
"""

import hashlib
import json
import os
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import as_completed
from dataclasses import replace
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from harness.core.engine_packages import engine_packages
from harness.core.plain_json import to_plain
from harness.core.provenance import Provenance
from harness.core.report_model import Artefact, Figure, Prose, Replay, Table
from harness.core.verdict import Status, Verdict
from harness.core.writing import UndrawnFiguresError
from harness.execution.isolated_pool import local_executor
from harness.execution.worker import LostTaskError
from harness.report.atomic_folder import FORMAT, MANIFEST, replace_folder
from harness.report.layout import FIDELITY, Report, Section, arrange, ordered, unique_names
from harness.report.number_format import readable
from harness.report.page import page
from harness.report.scorecard import derived
from harness.report.simplify_curves import PAPER, SCREEN, simplify
from harness.report.stored import ARTEFACTS, to_json
from harness.report.style import palette
from harness.report.tables import (
    csv_text,
    dictionary,
    markdown,
    parquet_bytes,
    plain_text,
    records,
)


def summary(report: Report) -> str:
    """Return title, headline texts and tables, and one line of provenance."""
    opening = report.opening
    parts = [f"# {plain_text(report.title)}\n"]
    for artefact in opening.leading.values():
        if isinstance(artefact, Prose):
            parts += [plain_text(paragraph) + "\n" for paragraph in artefact.text.split("\n\n")]
        elif isinstance(artefact, Table):
            parts += [f"## {plain_text(artefact.title)}\n", markdown(artefact)]
    parts.append(_made_by(report) + "\n")
    return "\n".join(parts)


def _made_by(report: Report) -> str:
    """Return versions, commit, processor and date in a line."""
    own, commit = report.provenance, report.provenance.commit
    engines = (f"{n} {own.packages[n]}" for n in engine_packages() if n in own.packages)
    places = (f"{name} ({versions})" for name, versions in own.environments.items())
    words = [f"rockingcan {own.rockingcan}", *engines, f"python {own.python}", *places]
    if commit is not None:
        words.append(f"commit {commit.digest[:12]}{' + changes' if commit.changed else ''}")
    return plain_text(", ".join([*words, own.processor, own.written]))


_ALIEN = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""What XML 1.0 has no way to write, not even as a reference."""

_GATE = "gate"
"""Name of the table of results against accepted ones."""


def junit(report: Report) -> str:
    """Return the verdicts as JUnit's XML, which build servers show beside their tests.

    A test case is a quantity of one engine in one scene. What agrees passes, what deviates or
    failed is a failure, what is unsupported or cannot be decided is skipped, with the words of the
    verdict. Where results were held against accepted ones, each comparison is a test case of a
    suite of its own. An empty list where no engine was compared.
    """
    every = (row for table in report.tables.values() for row in _rows(table))
    verdicts = [row for row in every if row["verdict"].status is not Status.NOT_JUDGED]
    suites = Element("testsuites", name=report.title)
    for name in dict.fromkeys(row["suite"] for row in verdicts):
        own = [row for row in verdicts if row["suite"] == name]
        suite = SubElement(suites, "testsuite", {"name": name, **_counts(own)})
        for row in own:
            _add_case(suite, row)
    suites.attrib.update(_counts(verdicts))
    indent(suites)
    text = tostring(suites, encoding="unicode")
    text = f'<?xml version="1.0" encoding="utf-8"?>\n{text}\n'
    return _ALIEN.sub("\N{REPLACEMENT CHARACTER}", text)


def _rows(table: Table) -> Iterator[dict[str, Any]]:
    """Yield the verdicts of a table, with the keys of fidelity and `suite`."""
    for row in records(table) if table.name in {FIDELITY, _GATE} else ():
        if table.name == FIDELITY:
            yield {**row, "suite": row["engine"]}
        else:
            step = "" if row["timestep_s"] is None else f", {row['timestep_s']:g} s"
            verdict, note = row["verdict"], f": {row['note']}" if row["note"] else ""
            accepted, tolerance = row["accepted"], row["tolerance"]
            known = isinstance(accepted, float) and isinstance(tolerance, float)
            yield {
                **row,
                "suite": f"{row['engine']}, against accepted results",
                "profile": f"{row['profile']}{step}",
                "verdict": Verdict(verdict.status, f"{verdict.text}{note}"),
                "value": row["found"],
                "allowed": accepted + tolerance if known else None,
                "command": f"case {row['case']}",
            }


def _add_case(suite: Element, row: dict[str, Any]) -> None:
    """Add a test case, with the numbers behind a failure and how to get them again."""
    names = {
        "classname": f"{row['engine']}.{row['scene']}",
        "name": f"{row['quantity']}, {row['profile']}",
    }
    case, verdict = SubElement(suite, "testcase", names), row["verdict"]
    if verdict.status.failed:
        value = "no number" if row["value"] is None else readable(row["value"])
        allowed = "" if row["allowed"] is None else f", allowed {readable(row['allowed'])}"
        attributes = {"message": verdict.text, "type": verdict.status.value}
        failure = SubElement(case, "failure", attributes)
        failure.text = f"{row['quantity']}: {value}{allowed}\n{row['command']}"
    elif not verdict.status.passed:
        SubElement(case, "skipped", message=verdict.text)


def _counts(verdicts: list[dict[str, Any]]) -> dict[str, str]:
    statuses = [row["verdict"].status for row in verdicts]
    failures = sum(status.failed for status in statuses)
    passed = sum(status.passed for status in statuses)
    return {
        "tests": str(len(statuses)),
        "failures": str(failures),
        "skipped": str(len(statuses) - failures - passed),
    }


Progress = Callable[[str, int, int], None]
"""Called with what is written, and how many parts of the report are done, of how many."""

VERSION = 1  # of the manifest's keys; a later one adds keys and removes none


def write_report(
    artefacts: Iterable[Artefact],
    out: Path,
    *,
    title: str,
    cases: Sequence[Mapping[str, Any]],
    provenance: Provenance,
    figures: bool = False,
    jobs: int | None = None,
    on_progress: Progress | None = None,
) -> Path:
    """Write the report of one study as one folder, whole or not at all.

    Parameters
    ----------
    artefacts : iterable of Artefact
        In the order in which they are to be read. The tables "best" and "shipped" open the page,
        then a text named "summary"; without them the text, and the table "scorecard".
    out : Path
        The folder; an earlier report there is replaced as a whole.
    title : str
    cases : sequence of mapping
        One for each case, with what JSON can hold. The keys `digest`, `label` and `command` are
        shown; a table cell in a column named `case` that holds a digest links to its case.
    provenance : Provenance
    figures : bool
        Whether to draw each figure for paper too, as PNG and SVG.
    jobs : int, optional
        Processes that draw them; as many as there are cores if left out.
    on_progress : callable, optional

    Returns
    -------
    Path
        The page, `index.html`.

    Raises
    ------
    OutputError
        If `out` cannot be written, or is a folder that is not a report.
    UndrawnFiguresError
        After the report is written, if a process that drew a figure for paper has died.
    """
    chapter = Section(
        title=title, artefacts=tuple(artefacts), cases=tuple(cases), provenance=provenance
    )
    return write_chapters(
        [chapter],
        out,
        title=title,
        provenance=provenance,
        figures=figures,
        jobs=jobs,
        on_progress=on_progress,
    )


def write_chapters(
    chapters: Sequence[Section],
    out: Path,
    *,
    title: str,
    provenance: Provenance,
    figures: bool = False,
    jobs: int | None = None,
    on_progress: Progress | None = None,
) -> Path:
    """Write one report of several studies.

    Parameters
    ----------
    chapters : sequence of Section
        At least one; the comparison of engines comes first on the page wherever it stands here.
    out, title, provenance, figures, jobs, on_progress
        As for `write_report`.

    Returns
    -------
    Path
        The page, `index.html`.

    Raises
    ------
    OutputError, UndrawnFiguresError
        As for `write_report`.
    """
    steps = _Steps(chapters, on_progress, figures=figures)
    fine = [_fine(chapter, steps) for chapter in ordered(chapters)]
    report = _report(fine, title, provenance, on_paper=figures)
    with replace_folder(out) as draft:
        lost = _draw(report, draft / "figures", steps, jobs) if figures else {}
        report = replace(report, undrawn=frozenset(lost))
        _write_files(report, draft, steps)
        manifest = {
            "format": FORMAT,
            "version": VERSION,
            "title": title,
            "provenance": provenance.to_dict(),
            "cases": [to_plain(case) for case in report.cases],
            "files": _listed(draft),
        }
        text = json.dumps(manifest, indent=1, ensure_ascii=False, allow_nan=False)
        (draft / MANIFEST).write_text(text + "\n", encoding="utf-8")
    if lost:
        titles = tuple(figure.title for name, figure in report.figures.items() if name in lost)
        reason = next(iter(lost.values())).reason
        raise UndrawnFiguresError(folder=out, titles=titles, reason=reason)
    return out / "index.html"


class _Steps:
    """Counts the parts of a report as they are done."""

    def __init__(
        self, chapters: Sequence[Section], told: Progress | None, *, figures: bool
    ) -> None:
        every = [artefact for chapter in chapters for artefact in chapter.artefacts]
        count = sum(isinstance(artefact, Figure) for artefact in every)
        tables = sum(isinstance(artefact, Table) for artefact in every)
        self.done, self.total = 0, count * (2 if figures else 1) + tables + 1
        self.told = told

    def done_with(self, part: str) -> None:
        """Count a part; a table made of several chapters was not foreseen, and adds one."""
        self.done += 1
        self.total = max(self.total, self.done)
        if self.told is not None:
            self.told(part, self.done, self.total)


def _fine(chapter: Section, steps: _Steps) -> Section:
    """Return a chapter with its curves as the page shows them."""
    artefacts: list[Artefact] = []
    for artefact in chapter.artefacts:
        if isinstance(artefact, Figure):
            artefacts.append(artefact if chapter.fine else simplify(artefact, SCREEN))
            steps.done_with(artefact.title)
        else:
            artefacts.append(artefact)
    return replace(chapter, artefacts=tuple(artefacts), fine=True)


def _report(
    chapters: Sequence[Section], title: str, provenance: Provenance, *, on_paper: bool
) -> Report:
    """Give everything its name and its place."""
    above, below = unique_names(derived(chapters), chapters)
    everything = {name: artefact for group in (above, *below) for name, artefact in group.items()}
    opening, parts = arrange(
        above, [(chapter.title, group) for chapter, group in zip(chapters, below, strict=True)]
    )
    return Report(
        title=title,
        opening=opening,
        parts=parts,
        figures={n: a for n, a in everything.items() if isinstance(a, Figure)},
        on_paper=on_paper,
        tables={n: a for n, a in everything.items() if isinstance(a, Table)},
        inks=palette(_kinds(everything.values())),
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


def _once(chapters: Sequence[Section]) -> tuple[Mapping[str, Any], ...]:
    """Return the cases of all chapters, each once: studies share cases."""
    cases: dict[object, Mapping[str, Any]] = {}
    for case in (case for chapter in chapters for case in chapter.cases):
        cases.setdefault(case.get("digest", id(case)), case)
    return tuple(cases.values())


def _write_files(report: Report, folder: Path, steps: _Steps) -> None:
    (folder / "tables").mkdir()
    for name, table in report.tables.items():
        _write_text(folder / "tables" / f"{name}.csv", csv_text(table))
        (folder / "tables" / f"{name}.parquet").write_bytes(parquet_bytes(table))
        steps.done_with(table.title)
    _write_text(folder / ARTEFACTS, to_json(report.chapters))
    _write_text(folder / "columns.md", dictionary(report.tables.values()))
    _write_text(folder / "summary.md", summary(report))
    _write_text(folder / "junit.xml", junit(report))
    _write_text(folder / "index.html", page(report))
    steps.done_with("the page")


def _draw(
    report: Report, folder: Path, steps: _Steps, jobs: int | None
) -> dict[str, LostTaskError]:
    """Draw the figures for paper, each once, and return what became of the others, by name."""
    # here and not above: what nobody asks for is not imported
    from harness.report.matplotlib_renderer import render  # noqa: PLC0415

    folder.mkdir()
    inks, lost = dict(report.inks), {}
    jobs = max(1, min(jobs or len(os.sched_getaffinity(0)), len(report.figures)))
    with local_executor(jobs, spawned=True) as executor:
        drawings = {
            executor.submit(render, simplify(figure, PAPER), inks): name
            for name, figure in report.figures.items()
        }
        for drawing in as_completed(drawings):
            name = drawings[drawing]
            try:
                picture = drawing.result()
            except LostTaskError as error:
                lost[name] = error
            else:
                (folder / f"{name}.png").write_bytes(picture.png)
                _write_text(folder / f"{name}.svg", picture.svg)
            steps.done_with(report.figures[name].title)
    return lost


def _write_text(path: Path, text: str) -> None:
    path.write_bytes(text.encode("utf-8", errors="replace"))  # bytes: line ends stay as they are


def _listed(folder: Path) -> list[dict[str, str | int]]:
    """Return each file with its size and its SHA-256."""
    return [
        {
            "path": path.relative_to(folder).as_posix(),
            "bytes": path.stat().st_size,
            "sha256": hashlib.sha256(path.read_bytes()).hexdigest(),
        }
        for path in sorted(p for p in folder.rglob("*") if p.is_file())
    ]
