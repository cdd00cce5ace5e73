"""The scorecard: engines against quantities, from the tables of all studies that are there.

The comparison says how faithful each engine is, the study of stability how it fares on hard cases,
the study of cost what a tenth of a degree takes. What was not measured has no column and no table;
one sentence names the commands that measure it. A scene's own scorecard leads its section.

Why an engine as it ships deviates: the causes that the attribution found, by rank.

Each cause is a gap of the engine's defaults. The experiment that confirms it is the run in which
the gap is closed; its command stands in the row.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from itertools import groupby
from typing import Any

from harness.core.report_model import Column, Prose, Table, table_of
from harness.core.verdict import Status, Verdict
from harness.report.layout import FIDELITY, Section
from harness.report.number_format import readable
from harness.report.tables import Row, records
from harness.studies.comparison.selection import MANY
from harness.studies.shared import run_columns
from harness.studies.stability.failure_criteria import SOUND

_CAUSES = (
    Column("scene", "Name of the scene."),
    Column("engine", "Name of the engine, as it ships."),
    Column("quantity", "What deviates; the unit is its suffix."),
    Column("deviation", "By how much, engine minus truth."),
    Column("rank", "Place of the cause, by what closing it takes away."),
    Column("cause", "Name of the gap, or why there is none."),
    Column("takes_away", "What closing the gap, after those before it, takes away of the size."),
    Column("alone", "What closing only this gap takes away.", shown=False),
    Column("what_it_does", "What the open gap does to the can."),
    Column("case", "Digest of the experiment that confirms it: the run with the gap closed."),
    Column("command", "Runs the experiment again.", shown=False),
)

_ATTRIBUTED = {
    "turn_error_deg": "turn_error_deg",
    "contact_locus_m": "contact_locus_hausdorff_m",
    "friction_ratio_error": "peak_friction_ratio_error",
}
"""What the attribution calls the quantities of the scorecard that it accounts for."""

_MOST = 3
"""Causes of a deviation in the table; the attribution's own tables have all."""


def causes(
    verdicts: Sequence[Row], rows_of: Callable[[str], Sequence[Row] | None]
) -> tuple[Table, tuple[str, ...]]:
    """Return the causes of the deviations of engines as they ship, and how to find the others.

    Parameters
    ----------
    verdicts : sequence of mapping
        Rows of the table of fidelity.
    rows_of : callable
        Returns the rows of the table of a name, or None where there is no such table.

    Returns
    -------
    causes : Table
    commands : tuple of str
        Attribute the deviations of which no causes are known, a scene and engine each.
    """
    rows: list[Row] = []
    commands: dict[str, None] = {}
    for row in verdicts:
        deviates = status_of(row["verdict"]) is Status.DEVIATES and row["profile"] == "default"
        if not deviates or row["quantity"] not in _ATTRIBUTED:
            continue
        scene, engine = row["scene"], row["engine"]
        study = f"{scene}-{engine}"
        if (gaps := rows_of(f"{study}-gaps")) is not None:
            rows += _of(row, gaps, rows_of(f"{study}-runs") or ())
        else:
            commands[f"rockingcan attribute {scene} --engine {engine}"] = None
    return table_of("causes", "Why engines deviate as they ship", _CAUSES, rows), tuple(commands)


def _of(row: Row, gaps: Sequence[Row], runs: Sequence[Row]) -> Iterator[Row]:
    """Yield the causes of one deviation, largest first."""
    deviation = {key: row[key] for key in ("scene", "engine", "quantity")}
    deviation["deviation"] = row["value"]
    quantity = _ATTRIBUTED[row["quantity"]]
    known = [gap for gap in gaps if gap["quantity"] == quantity and gap["in_order"] is not None]
    known.sort(key=lambda gap: -abs(gap["in_order"]))
    if not known:
        yield deviation | {"cause": "not decidable: a run on the way has no such number"}
    # the run in which a gap is closed after those before it
    experiments = {run["gap"]: run for run in runs if run["step"] == "in order"}
    for rank, gap in enumerate(known[:_MOST], start=1):
        experiment = experiments.get(gap["gap"], {})
        yield deviation | {
            "rank": rank,
            "cause": gap["gap"],
            "takes_away": gap["in_order"],
            "alone": gap["alone"],
            "what_it_does": gap["what_it_does"],
            "case": experiment.get("case"),
            "command": experiment.get("command"),
        }


_HEADLINE = "paper-release"
"""The scene that the project is about; the first one where it was left out."""

_TARGET = 0.1  # deg
_PROFILES = {
    "default": ("as it ships", "settings as shipped"),
    "matched": ("matched", "tuned elsewhere, fixed step"),
    "adaptive": ("matched, own steps", "tuned elsewhere, steps follow the motion"),
}
"""A profile in words, and its choice in the price list; in the order of the rows."""

_QUANTITIES = {
    "turn_error_deg": (
        *("turn_error_deg", 1.0, "Angle of turn of the worst bounce, engine minus truth."),
    ),
    "contact_locus_m": (
        *("locus_error_mm", 1e3, "Largest distance between the two contact loci as curves."),
    ),
    "friction_ratio_error": (
        *("friction_ratio_error", 1.0, "Peak of |F|/N in the worst bounce, engine minus truth."),
    ),
    "slip_m_s": (
        "slip_mm_s",
        1e3,
        "Largest horizontal speed of the can's material at the contact point.",
    ),
    "penetration_m": ("penetration_um", 1e6, "Depth of the deepest contact."),
    "lift_off_fraction": ("lift_off_percent", 1e2, "Share of the time without contact force."),
    "energy_drift": (
        "energy_drift",
        1.0,
        "Largest departure of the energy from its first value, over m g R.",
    ),
}
"""By the name of a quantity in the table of verdicts, in the order of the scorecard: its column,
the factor from the unit of the verdicts, and what it means."""


def _judged(name: str, meaning: str) -> tuple[Column, ...]:
    """Return the columns of a number with its verdict and its case."""
    verdict, case = f"{name}_verdict", f"{name}_case"
    return (
        Column(name, meaning, verdict=verdict, case=case),
        Column(verdict, f"Verdict in words on {name}.", shown=False),
        Column(case, f"Digest of the case behind {name}.", shown=False),
    )


_OF_SCENE = (
    Column("engine", "Name of the engine."),
    Column("settings", "The profile in words, and its smallest timestep that was run."),
    *run_columns.without((run_columns.TIMESTEP, run_columns.PROFILE), "timestep_s", "profile"),
    *(c for name, _, meaning in _QUANTITIES.values() for c in _judged(name, meaning)),
)

_STABILITY = _judged(
    "stability_percent",
    "Share of the hard cases, at the smallest timestep tried, that stay sound.",
)
_PRICE = _judged("price_s_s", "Price of 0.1 degrees: processor seconds for each simulated second.")


def derived(chapters: Sequence[Section]) -> tuple[Table | Prose, ...]:
    """Return what a report makes of its chapters: scorecards, causes, and what was not measured.

    Nothing where no chapter is the comparison.
    """
    tables = [a for chapter in chapters for a in chapter.artefacts if isinstance(a, Table)]

    def rows_of(name: str) -> list[Row]:
        return [row for table in tables if table.name == name for row in records(table)]

    verdicts = rows_of(FIDELITY)
    if not verdicts:
        return ()
    # of one study in several chapters the last counts
    last = {table.name: table for table in tables}
    scenes = list(dict.fromkeys(row["scene"] for row in verdicts))
    headline = _HEADLINE if _HEADLINE in scenes else scenes[0]
    hard, prices = rows_of("verdicts"), rows_of(f"{headline}-prices")
    columns, rows, missing = _OF_SCENE, _rows(headline, verdicts), []
    if len({row["engine"] for row in rows}) > MANY:
        rows = [_best(list(own)) for _, own in groupby(rows, key=lambda row: row["engine"])]
    if hard:
        columns += _STABILITY
        rows = [{**row, **_stability(row, hard)} for row in rows]
    else:
        missing.append("how many hard cases stay sound (rockingcan stability)")
    if prices:
        columns += _PRICE
        rows = [{**row, **_price(row, prices)} for row in rows]
    else:
        missing.append(f"what 0.1 degrees cost (rockingcan cost {headline})")
    known, commands = causes(verdicts, lambda name: records(last[name]) if name in last else None)
    if commands:
        first, *others = commands
        more = f", and {len(others)} more like it" if others else ""
        missing.append(f"why engines deviate as they ship ({first}{more})")
    return (
        table_of("engines", f"Scorecard: engines on {headline}", columns, rows),
        *((known,) if len(known.frame) else ()),
        *(
            table_of(
                f"{scene}-engines", "The engines", _OF_SCENE, _rows(scene, verdicts), scene=scene
            )
            for scene in scenes
        ),
        *((_left_out(missing),) if missing else ()),
    )


def _left_out(missing: Sequence[str]) -> Prose:
    """Return the sentence on what this report could say and does not."""
    *first, last = missing
    parts = f"{', '.join(first)}, and {last}" if first else last
    return Prose(
        name="not-measured",
        title="What this report does not say",
        text=f"Not measured here: {parts}; rockingcan report joins their reports to this one.",
    )


def status_of(verdict: object) -> Status | None:
    """Return the status of a cell; None if it holds no verdict."""
    return verdict.status if isinstance(verdict, Verdict) else None


def _rows(scene: str, verdicts: Sequence[Row]) -> list[dict[str, Any]]:
    """Return a row for each engine and profile, with the numbers of a scene."""
    by_profile: dict[tuple[str, str], dict[str, Any]] = {}
    for judged in (judged for judged in verdicts if judged["scene"] == scene):
        row = {key: judged[key] for key in ("engine", "profile", "timestep_s")}
        row = by_profile.setdefault((judged["engine"], judged["profile"]), row)
        name, scale, _ = _QUANTITIES[judged["quantity"]]
        row |= {
            name: None if judged["value"] is None else scale * judged["value"],
            f"{name}_verdict": judged["verdict"],
            f"{name}_case": judged["case"],
        }
    for row in by_profile.values():
        row["settings"] = _settings(row["profile"], row["timestep_s"])
    places = {profile: place for place, profile in enumerate(_PROFILES)}
    return sorted(
        by_profile.values(),
        key=lambda row: (row["engine"], places.get(row["profile"], len(places))),
    )


def _best(profiles: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """Return the row of the profile in which an engine deviates in the fewest quantities."""

    def rank(row: Row) -> tuple[int, float]:
        agreed = [status_of(row.get(f"{name}_verdict")) for name, *_ in _QUANTITIES.values()]
        turn = row.get("turn_error_deg")
        return -agreed.count(Status.AGREES), math.inf if turn is None else abs(turn)

    return min(profiles, key=rank)


def _settings(profile: str, timestep: object) -> str:
    """Return a profile in words, with its timestep."""
    words, _ = _PROFILES.get(profile, (profile, ""))
    if timestep is None:
        return words
    most = "up to " if profile == "adaptive" else ""
    return f"{words}, {most}{readable(timestep)} s"


def _coarseness(run: Row) -> float:
    """Return the timestep of a run, s; where an engine chose its steps, one over their number."""
    step = run["timestep_s"]
    return float(step) if step is not None else 1.0 / max(run["steps"], 1)


def _stability(row: Row, hard: Sequence[Row]) -> Row:
    """Return how an engine's profile fares on the hard cases, at the smallest timestep tried."""
    own: dict[str, Row] = {}
    for run in hard:
        same = (run["engine"], run["profile"]) == (row["engine"], row["profile"])
        if same and "." not in run["scene"]:  # a dot: a release perturbed from a hard case
            finest = own.setdefault(run["scene"], run)
            own[run["scene"]] = min(finest, run, key=_coarseness)
    if not own:
        text = "not measured: no hard case was run with these settings"
        return {"stability_percent_verdict": Verdict(Status.NOT_MEASURED, text)}
    sound = {verdict.value for verdict in SOUND}
    failed = [run for run in own.values() if run["verdict"] not in sound]
    words = Verdict(Status.AGREES, f"agrees: all {len(own)} hard cases stay sound")
    if failed:
        text = f"deviates: {len(failed)} of {len(own)} hard cases fail"
        words = Verdict(Status.DEVIATES, text)
    return {
        "stability_percent": 100.0 * (1.0 - len(failed) / len(own)),
        "stability_percent_verdict": words,
        "stability_percent_case": failed[0]["case"] if failed else None,
    }


def _price(row: Row, prices: Sequence[Row]) -> Row:
    """Return the cells on the price of a tenth of a degree in an engine's profile."""
    _, choice = _PROFILES.get(row["profile"], ("", None))
    for price in prices:
        wanted = (row["engine"], _TARGET, choice)
        if (price["engine"], price["target_deg"], price["choice"]) == wanted:
            reached = status_of(price["verdict"]) is Status.REACHED
            return {
                "price_s_s": price["cost_s_s"] if reached else None,
                "price_s_s_verdict": price["verdict"],
                "price_s_s_case": price.get("case"),
            }
    text = "not decidable: the price list has no such settings"
    return {"price_s_s_verdict": Verdict(Status.UNDECIDABLE, text)}
