"""The leaderboard, and every case behind it, from the files of results.

The three divisions, as shipped, matched and open, have tables of their own and are never mixed, and
neither are two suites. Each cell leads to its case on the page of its engine, where the command
that runs it again stands with its settings and all its numbers. An engine that is not of this
project has no page, and no links.

A file that claims what cannot be is not shown: the site is not built.
"""

import math
import re
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from hashlib import sha256
from pathlib import Path

import numpy as np
from markupsafe import Markup

from docs.formatting import BASELINE, ROOT, adapter_of, digits
from docs.site.rendering import render
from harness.cli.results import settings_on_top
from harness.core.report_model import Figure, Panel, Series
from harness.engines.description import APART
from harness.report.style import entries, palette
from harness.report.svg_renderer import stills
from harness.results.errors import Fault, ResultsError
from harness.results.files import read_baseline, read_result, result_files
from harness.results.leaderboard import CostPoint, Standing, cost_points, frontier, leaderboard
from harness.results.leaderboard import command as command_of
from harness.results.plausibility import objections
from harness.results.result import Result
from harness.results.scores import BY_COLUMN, Division, Score

SUBMITTED = ROOT / "reports" / "results"
FRONTIER = ("gentle-rock", "paper-release")
"""Scenes whose errors are drawn against their costs."""

DIVISIONS = {
    Division.AS_SHIPPED: "The engine's own timestep and settings.",
    Division.MATCHED: "The harness's settings: what the scene does not declare is removed, at a "
    "fixed timestep or with timesteps that follow the motion; the best case of each scene.",
    Division.OPEN: "Settings that the submitter put on top; each file of results has them.",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Cell:
    """A cell of a table: its words, the number it is sorted by, and where it leads."""

    text: str
    order: float
    link: str = ""
    title: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """An engine of one version, as one file of results has it; a constraint stands apart."""

    label: str
    version: str
    submitter: str
    page: str
    apart: bool
    cells: tuple[Cell, ...]


@cache
def results() -> tuple[Result, ...]:
    """Return all results: those handed in, and the accepted ones.

    Raises
    ------
    ResultsError
        If one claims what cannot be.
    """
    files = result_files([SUBMITTED]) if any(SUBMITTED.glob("*.json")) else ()
    return tuple(map(_holding, (*map(read_result, files), read_baseline(BASELINE))))


def _holding(result: Result) -> Result:
    """Return a result to which there is nothing to object without running anything."""
    on_top, _ = settings_on_top(result)
    for one in objections(result, on_top):
        reason = f"not {one.rule.value}: {one.case and one.case + ': '}{one.text}"
        raise ResultsError(place=Path(result.place), fault=Fault.OBJECTION, reason=reason)
    return result


def leaderboard_page() -> str:
    """Return the page of the leaderboard, as Markdown with tables in HTML."""
    suites = defaultdict[str, list[Result]](list)
    for result in results():
        suites[result.suite].append(result)
    boards = [
        {
            "suite": suite,
            "divisions": [_division(suites[suite], division) for division in Division],
        }
        for suite in sorted(suites, key=_suite_order)
    ]
    return render("leaderboard.md", boards=boards)


def top(count: int) -> str:
    """Return the first rows of the quick suite in the division matched, as Markdown with HTML."""
    own = [result for result in results() if result.suite == "quick"] or results()[-1:]
    standings = leaderboard(own, Division.MATCHED)
    scenes = list(dict.fromkeys(standing.scene for standing in standings))
    table = _table(rows_of(standings, scenes)[:count], [*scenes, *_COSTS])
    told = (
        f"Suite {own[0].suite}, division *{Division.MATCHED.value}*: the error of the best case of "
        "each scene, in degrees. Press a column's head to sort by it."
    )
    return f"{told}\n\n``````{{raw}} html\n{table}\n``````\n"


_COSTS = ("steps", "processor s")
"""Heads of the last columns of a board."""


def _suite_order(suite: str) -> tuple[bool, str]:
    return suite != "quick", suite  # most engines are in the quick one


def _division(own: Sequence[Result], division: Division) -> dict[str, object]:
    standings = leaderboard(own, division)
    scenes = list(dict.fromkeys(standing.scene for standing in standings))
    rows = rows_of(standings, scenes)
    drawn = _frontier(cost_points(own, division)) if division is Division.MATCHED else None
    return {
        "title": division.value,
        "told": DIVISIONS[division],
        "table": _table(rows, [*scenes, *_COSTS]) if rows else "",
        "figure": "" if drawn is None else figure_html(drawn),
    }


def rows_of(standings: Sequence[Standing], scenes: Sequence[str]) -> list[Row]:
    """Return a row for each engine and version, best first; constraints after all contacts."""
    by_engine = defaultdict[tuple[str, str, str], dict[str, Standing]](dict)
    for standing in standings:
        key = (standing.engine, standing.version, standing.place)
        by_engine[key][standing.scene] = standing
    rows = []
    for own in by_engine.values():
        first = next(iter(own.values()))
        cells = tuple(_cell(own[scene]) for scene in scenes)
        costs = [s.best for s in own.values() if s.best is not None]
        steps, seconds = (sum(getattr(p, name) for p in costs) for name in ("steps", "cpu_s"))
        rows.append(
            Row(
                label=first.label,
                version=first.version,
                submitter=first.submitter,
                page=_page(first.engine),
                apart=first.imposes_rolling,
                cells=(
                    *cells,
                    Cell(text=f"{steps:,}", order=steps),
                    Cell(text=digits(seconds), order=seconds),
                ),
            )
        )
    return sorted(rows, key=lambda row: (row.apart, row.cells[0].order, row.label, row.version))


def _cell(standing: Standing) -> Cell:
    """Return what an engine reaches in a scene, in degrees, or in words why it has no number."""
    best = standing.best
    if best is None:
        if standing.truth_pulls:
            return Cell(text="pulls", order=math.inf, title=_PULLS)
        return Cell(text=_endings(standing.endings), order=math.inf)
    error, page = math.degrees(best.error_rad), _page(best.engine)
    return Cell(
        text=digits(error),
        order=error,
        link=page and f"{page}#{anchor(best.place, best.digest)}",
        title=best.case,
    )


_PULLS = "The exact motion asks the plane to pull, which no contact does."


def _endings(endings: Iterable[str]) -> str:
    words = [name.lower().replace("_", " ") for name in endings if name != "FINISHED"]
    return ", ".join(words) or "turns not counted"


def anchor(place: str, digest: str) -> str:
    """Return the anchor of a case: of one file of results, for a case may be in several."""
    return f"case-{_slug(Path(place).stem)}-{digest}"


def _page(engine: str) -> str:
    """Return the page of an engine; empty if it has none."""
    return f"engines/{adapter}.html" if (adapter := adapter_of(engine)) else ""


def _kind(engine: str) -> str:
    """Return what the colour of an engine is called: its adapter, as in every report."""
    return adapter_of(engine) or _slug(engine)


def _slug(name: str) -> str:
    """Return a name as an address and a style sheet can have it; another for each."""
    slug = re.sub(r"[^\w.-]", "-", name, flags=re.ASCII)
    return slug if slug == name else f"{slug}-{sha256(name.encode()).hexdigest()[:8]}"


def _frontier(points: Sequence[CostPoint]) -> Figure | None:
    """Return the errors of all cases against their costs, with the frontier; None without any."""
    contacts = [point for point in points if not point.imposes_rolling]
    by_scene = {scene: [p for p in contacts if p.scene == scene] for scene in FRONTIER}
    panels = tuple(_panel(scene, own) for scene, own in by_scene.items() if own)
    if not panels:
        return None
    return Figure(
        name="frontier",
        title="What accuracy costs",
        seen="Each point is a case of the division; the line joins those that no cheaper case is "
        "as exact as. Times are those of the machine of each result.",
        panels=panels,
    )


def _panel(scene: str, points: Sequence[CostPoint]) -> Panel:
    drawn = [
        _series(label, kind, [p for p in points if p.label == label], "points")
        for label, kind in dict.fromkeys(
            (p.label, adapter_of(p.engine) or _slug(p.engine)) for p in points
        )
    ]
    best = frontier(points, "cpu_s")
    return Panel(
        title=scene,
        x_label="processor time [s]",
        y_label="error [degrees]",
        series=(*drawn, _series("frontier", "reference", best, "both")),
        log_x=True,
        log_y=True,
    )


def _series(label: str, kind: str, points: Sequence[CostPoint], mark: str) -> Series:
    return Series(
        label=label,
        kind=kind,
        x=np.array([p.cpu_s for p in points]),
        y=np.degrees([p.error_rad for p in points]),
        mark="both" if mark == "both" else "points",
    )


def figure_html(figure: Figure) -> str:
    """Return a figure with its legend, in the colours of the page, light or dark."""
    legend = entries(figure)
    inks = palette(entry.kind for entry in legend)
    colours = {kind: f"--kind-{kind}" for kind in inks}
    return render(
        "figure.html",
        figure=figure,
        legend=legend,
        inks=inks,
        colours=colours,
        panels=[
            (panel.title, Markup(drawn))  # noqa: S704 - of our own renderer, which escapes
            for panel, drawn in zip(figure.panels, stills(figure, inks, colours), strict=True)
        ],
    )


def cases_html(engine: str) -> str:
    """Return every case of an engine in the files of results, as HTML; empty if there are none."""
    groups = []
    for result in results():
        own = [score for score in result.cases if adapter_of(score.engine) == engine]
        if own:
            groups.append(
                {
                    "result": result,
                    "version": result.engines[own[0].engine].version,
                    "file": _file_of(result),
                    "cases": [_case(result, score) for score in own],
                }
            )
    return render("cases.html", groups=groups) if groups else ""


def _file_of(result: Result) -> str:
    place = Path(result.place)
    return (place if place.suffix else place / "accepted.json").relative_to(ROOT).as_posix()


def _case(result: Result, score: Score) -> Mapping[str, object]:
    return {
        "anchor": anchor(result.place, score.digest),
        "score": score,
        "label": score.identity.label(),
        "command": command_of(result, score),
        "ended": score.outcome.lower().replace("_", " "),
        "values": [
            (BY_COLUMN[column].words, BY_COLUMN[column].unit, value, score.spread.get(column))
            for column, value in score.values.items()
        ],
    }


def _table(rows: Sequence[Row], heads: Sequence[str]) -> str:
    groups = [[row for row in rows if row.apart is apart] for apart in (False, True)]
    return render("board.html", groups=groups, heads=heads, apart=APART)
