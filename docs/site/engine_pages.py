"""A page for each engine: what it does to a can, and the setting that fixes it.

Everything comes from files that a named command wrote: results below `reports/baseline`, the table
of settings, findings and field guide. What was not measured of an engine is named with the command
that measures it.
"""

import math
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache

import pandas as pd

from docs.field_guide import PAGES
from docs.formatting import BASELINE, ROOT, adapter_of, csv, digits, error_words, markdown
from docs.site.rendering import render
from harness.engines.description import Description, Method
from harness.engines.registry import description_of, our_names

SETTINGS = ROOT / "harness" / "engines" / "SETTINGS.md"
FINDINGS = ROOT / "docs" / "findings"

TURN = "turn_error_deg"
"""Quantity whose attribution a page tells in whole."""

PACKAGED = ("mujoco", "pybullet")
"""Engines that a plain installation has."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Study:
    """What a study measured of an engine.

    Parameters
    ----------
    title : str
    command : str
        Measures it, or measures it again.
    told : str
        A sentence or two on the table.
    table : str
        In Markdown; empty where it was not measured.
    source : str
        Path of the file in the repository; empty where it was not measured.
    figures : tuple of (str, str)
        Words and path of each picture.
    """

    title: str
    command: str
    told: str = ""
    table: str = ""
    source: str = ""
    figures: tuple[tuple[str, str], ...] = ()


def engine_names() -> tuple[str, ...]:
    """Return the engines that have a page, sorted by their labels; the exact motion has its own."""
    names = (name for name in our_names() if name != "reference")
    return tuple(sorted(names, key=lambda name: label_of(name).lower()))


def label_of(name: str) -> str:
    """Return the name of an engine for people."""
    return description_of(name).label or name


def engine_page(name: str, cases: str) -> str:
    """Return the page of an engine, as Markdown.

    Parameters
    ----------
    name : str
    cases : str
        Every case of it in the files of results, as HTML; empty if there are none.
    """
    description = description_of(name)
    return render(
        "engine.md",
        label=label_of(name),
        name=name,
        kind=_kind(description),
        extra="" if name in PACKAGED else name,
        headline=_headline(name),
        settings=settings_table(name, changed=True),
        all_settings=settings_table(name, changed=False),
        studies=(
            accuracy(name),
            rim(name),
            attribution(name),
            price_list(name),
            hard_cases(name),
            effects(name),
        ),
        findings=findings_of(name),
        guide=guide_of(name),
        cases=cases,
    )


def engine_index() -> str:
    """Return the page that leads to the pages of all engines."""
    best, shipped = (_errors(side) for side in ("best", "shipped"))
    rows = [
        [
            f"[{label_of(name)}](engines/{name}.md)",
            description_of(name).method.value,
            description_of(name).precision.value,
            _cell(shipped, name, "gentle-rock_deg"),
            _cell(best, name, "gentle-rock_deg"),
            str(len(findings_of(name))),
            str(len(guide_of(name))),
        ]
        for name in engine_names()
    ]
    head = (
        *("engine", "steps by", "precision", "gentle-rock as it ships, degrees"),
        *("at its best, degrees", "findings", "in the field guide"),
    )
    return render("engines.md", table=markdown(head, rows, words=3), names=engine_names())


def reference_page() -> str:
    """Return the page of the exact motion, which is an engine like the others."""
    hard = csv("stability/hard-cases.csv")
    rows = [
        (
            str(one["scene"]),
            str(one["reference"]),
            "" if pd.isna(one["disagreement"]) else f"{one['disagreement']:.1e}",
        )
        for one in hard.to_dict("records")
    ]
    return render(
        "reference.md",
        hard=markdown(("scene", "the exact motion", "two methods differ by"), rows, words=2),
        settings=settings_table("reference", changed=False),
        prices=price_list("reference"),
    )


def accuracy(name: str) -> Study:
    """Return the errors of an engine in the scenes of the full suite and of the field guide."""
    rows, sources = [], []
    for suite in ("engines", "field"):
        best, shipped = (_errors(side, suite) for side in ("best", "shipped"))
        if name not in best.index:
            continue
        sources.append(suite)
        for column in (c for c in best.columns if f"{c}_verdict" in best.columns):
            scene, _, unit = column.rpartition("_")
            verdict = str(best.loc[name, f"{column}_verdict"])
            cells = [_cell(table, name, column) for table in (shipped, best)]
            rows.append([scene, _UNITS[unit], *cells, verdict])
    head = ("scene", "error of", "as it ships", "at its best", "verdict on the best")
    return Study(
        title="How far it is from the exact motion",
        command=f"rockingcan validate --suite full --engine {name}",
        told=(
            "The error of the first bounce: of the angle of turn in degrees, or of phi in rad "
            "where nothing turns. *Best* is the better of the profiles matched and adaptive."
        ),
        table=markdown(head, rows, words=2) if rows else "",
        source=f"reports/baseline/{sources[0]}/best.csv" if sources else "",
    )


_UNITS = {"deg": "turn, degrees", "rad": "phi, rad"}


def rim(name: str) -> Study:
    """Return what the colliders of an engine do under the rim."""
    file = f"rim-{name}/rim-findings.csv"
    command = f"rockingcan probe {name}"
    title = "Under the rim"
    if not (BASELINE / file).is_file():
        return Study(title=title, command=command)
    rows = [
        (str(one["variant"]), str(one["finding"]), str(one["verdict"]))
        for one in csv(file).to_dict("records")
    ]
    picture = f"reports/baseline/rim-{name}/rim.png"
    words = f"{label_of(name)}: distance of the contact from the rim, by tilt and collider"
    return Study(
        title=title,
        command=command,
        told="Where each collider puts its contact points, asked without a step at tilts from "
        "1e-12 rad to a right angle, against the exact lowest point of the rim.",
        table=markdown(("collider", "what it does", "verdict"), rows, words=3),
        source=f"reports/baseline/{file}",
        figures=((words, picture),) if (ROOT / picture).is_file() else (),
    )


def attribution(name: str) -> Study:
    """Return what closing each gap takes away from the error of the turn of gentle-rock."""
    place = f"attribution-{name}/gentle-rock-{name}"
    command = f"rockingcan attribute gentle-rock --engine {name}"
    title = "What is to blame"
    if not (BASELINE / f"{place}-gaps.csv").is_file():
        return Study(title=title, command=command)
    gaps, whole = csv(f"{place}-gaps.csv"), csv(f"{place}-interactions.csv")
    own = gaps[gaps["quantity"] == TURN].sort_values("place")
    total = whole[whole["quantity"] == TURN].iloc[0]
    rows = [
        (str(gap), f"{taken:+.3f}", str(does), f"`{settings}`")
        for gap, taken, does, settings in zip(
            own.gap, own.in_order, own.what_it_does, own.settings, strict=True
        )
    ]
    return Study(
        title=title,
        command=command,
        told=(
            f"As it ships, the turn of gentle-rock is off by {total['as_shipped']:+.3f} degrees; "
            f"with all gaps closed by {total['remains']:+.3f}. What closing each takes away, after "
            "those above it, and the settings that close it:"
        ),
        table=_with_text_last(("gap", "degrees", "what it does to the can", "settings"), rows),
        source=f"reports/baseline/{place}-gaps.csv",
    )


def price_list(name: str) -> Study:
    """Return what an accuracy costs on the paper's release, and the command that buys it."""
    command = "rockingcan cost paper-release"
    title = "What accuracy costs"
    prices = csv("cost/paper-release-prices.csv")
    own = prices[prices["engine"] == name]
    if own.empty:
        return Study(title=title, command=f"{command} --engine {name}")
    rows = [
        (
            str(one["choice"]),
            f"{one['target_deg']:g}",
            str(one["verdict"])
            if str(one["verdict"]).startswith("not")
            else digits(one["cost_s_s"], 2),
            digits(one["error_deg"], 2),
            f"`{one['command']}`",
        )
        for one in own.to_dict("records")
    ]
    head = ("choice", "to an error of, degrees", "processor s per s", "error, degrees", "run it")
    return Study(
        title=title,
        command=command,
        told="Processor seconds per simulated second that buy an error of the turn of the paper's "
        "release. *Tuned elsewhere* are settings found on another scene.",
        table=_with_text_last(head, rows),
        source="reports/baseline/cost/paper-release-prices.csv",
    )


def hard_cases(name: str) -> Study:
    """Return how the runs of an engine on the hard cases end."""
    counts = csv("stability/verdict-counts.csv")
    own = counts[counts["engine"] == name]
    command, title = "rockingcan stability --suite full", "Hard cases"
    if own.empty:
        return Study(title=title, command=f"{command} --engine {name}")
    wide = own.pivot_table(
        index="verdict", columns="profile", values="runs", fill_value=0, sort=False
    )
    rows = [[str(verdict), *(f"{runs:.0f}" for runs in row)] for verdict, row in wide.iterrows()]
    picture = f"reports/baseline/stability/map-{name}-matched.png"
    words = f"{label_of(name)} matched: how each hard case ends at each timestep"
    return Study(
        title=title,
        command=command,
        told="How many runs on hard cases, over a grid of timesteps, have each verdict.",
        table=markdown(("runs that are", *map(str, wide.columns)), rows),
        source="reports/baseline/stability/verdict-counts.csv",
        figures=((words, picture),) if (ROOT / picture).is_file() else (),
    )


def effects(name: str) -> Study:
    """Return by how much each effect changes the turn of gentle-rock."""
    table = csv("effects/gentle-rock-effects.csv")
    own = table[table["engine"] == name]
    command, title = "rockingcan effects gentle-rock", "Effects"
    if own.empty:
        return Study(title=title, command=f"{command} --engine {name}")
    exact = table[table["engine"] == "reference"].set_index("effect")["change_turn_deg"]
    rows = [
        (
            str(one["effect"]).replace("_", " "),
            str(one["strength"]) if pd.notna(one["strength"]) else "",
            _signed(one["change_turn_deg"]),
            _signed(exact[one["effect"]]),
            str(one["why"]),
        )
        for one in own.to_dict("records")
    ]
    head = ("effect", "strength", "turn, degrees", "exact, degrees", "what is said of it")
    return Study(
        title=title,
        command=command,
        told="Declared one at a time, at the strength of a real can on a real table.",
        table=_with_text_last(head, rows),
        source="reports/baseline/effects/gentle-rock-effects.csv",
    )


def settings_table(name: str, *, changed: bool) -> str:
    """Return the settings of an engine, or only those that a profile changes, in Markdown."""
    lines = SETTINGS.read_text(encoding="utf-8").splitlines()
    own = [line[1:-1].split(" | ") for line in lines if line.startswith(f"| {name} |")]
    cells = [[cell.strip() for cell in row[1:]] for row in own]
    rows = [row for row in cells if not changed or row[1] != row[2] or row[3]]
    head = ("setting", "ships with", "matched", "adaptive", "what it is")
    return markdown(head, rows, words=len(head)) if rows else ""


def findings_of(name: str) -> list[tuple[str, str]]:
    """Return title and path of each finding on an engine."""
    found = []
    for path in sorted(FINDINGS.glob("*.md")):
        title = path.read_text(encoding="utf-8").splitlines()[0].removeprefix("# ")
        head, colon, _ = title.partition(":")
        if colon and name in _named_in(head):
            found.append((title, f"findings/{path.name}"))
    return found


def guide_of(name: str) -> list[tuple[str, str, str]]:
    """Return title, path and status of each page of the field guide on an engine."""
    found = []
    for page in PAGES:
        text = page.read_text(encoding="utf-8")
        title = text.splitlines()[0].removeprefix("# ")
        if name in _named_in(title.partition(":")[0]):
            (status,) = re.findall(r"^- status: (.*)$", text, flags=re.MULTILINE)
            found.append((title, f"field-guide/{page.name}", status))
    return found


def _named_in(head: str) -> set[str]:
    """Return the engines that the head of a title names; a longer name hides one inside it."""
    named = set()
    for name in sorted(engine_names(), key=lambda name: -len(label_of(name))):
        if re.search(rf"\b{re.escape(label_of(name))}\b", head):
            named.add(name)
            head = head.replace(label_of(name), "")
    return named


def _kind(description: Description) -> str:
    """Return in a sentence how an engine advances."""
    by = {
        Method.FIXED_TIMESTEP: "steps by a timestep that it is given",
        Method.ERROR_CONTROL: "chooses its own steps within an accuracy that it is given",
        Method.CONSTRAINT: "imposes rolling as a constraint, and stands apart from contacts",
    }
    return f"It {by[description.method]}, in {description.precision.value} precision."


def _headline(name: str) -> str:
    """Return what the engine makes of gentle-rock, in a sentence; empty if it was not run."""
    best, shipped = (_errors(side) for side in ("best", "shipped"))
    if name not in best.index:
        return ""
    as_shipped, at_best = (_cell(table, name, "gentle-rock_deg") for table in (shipped, best))
    return (
        f"The turn of *gentle-rock* is off by {as_shipped} degrees as {label_of(name)} ships, and "
        f"by {at_best} at its best."
    )


@cache
def _errors(side: str, suite: str = "engines") -> pd.DataFrame:
    """Return the errors of all engines by scene, with the name of the adapter as the index."""
    table = csv(f"{suite}/{side}.csv")
    return table.assign(engine=table["engine"].map(adapter_of)).set_index("engine")


def _cell(table: pd.DataFrame, name: str, column: str) -> str:
    rows = table.to_dict("index")
    return error_words(rows[name], column) if name in rows else "not run"


def _signed(value: float) -> str:
    return "" if math.isnan(value) else f"{value:+.4f}"


def _with_text_last(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table whose first and last columns hold words, those between numbers."""
    return markdown(head, rows, words=1).replace("---:", "---")
