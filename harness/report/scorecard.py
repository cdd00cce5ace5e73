"""The scorecard: engines against quantities, from the tables of all studies that are there.

The comparison says how faithful each engine is, the study of stability how it fares on hard cases,
the study of cost what a tenth of a degree takes. What was not measured is said to be so, with the
command that measures it. A scene's own scorecard leads its section.

Why an engine as it ships deviates: the causes that the attribution found, by rank.

Each cause is a gap of the engine's defaults. The experiment that confirms it is the run in which
the gap is closed; its command stands in the row.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import pandas as pd

from harness.core.report_model import Table
from harness.report.number_format import readable
from harness.report.section import FIDELITY, Section
from harness.report.tables import Row, records
from harness.studies.stability.failure_criteria import SOUND

_COLUMNS: Mapping[str, str] = {
    "scene": "Name of the scene.",
    "engine": "Name of the engine, as it ships.",
    "quantity": "What deviates; the unit is its suffix.",
    "deviation": "By how much, engine minus truth.",
    "rank": "Place of the cause, by what closing it takes away.",
    "cause": "Name of the gap, or why there is none.",
    "takes_away": "What closing the gap, after those before it, takes away of the size.",
    "alone": "What closing only this gap takes away.",
    "what_it_does": "What the open gap does to the can.",
    "case": "Digest of the experiment that confirms it: the run with the gap closed.",
    "command": "Runs the experiment again.",
}

_ATTRIBUTED = {
    "turn_error_deg": "turn_error_deg",
    "contact_locus_m": "contact_locus_hausdorff_m",
    "friction_ratio_error": "peak_friction_ratio_error",
}
"""What the attribution calls the quantities of the scorecard that it accounts for."""

_MOST = 3
"""Causes that are told; the attribution's own tables have all."""


def causes(verdicts: Sequence[Row], tables: Sequence[Table]) -> Table:
    """Return the causes of every deviation of an engine as it ships.

    Parameters
    ----------
    verdicts : sequence of mapping
        Rows of the table of fidelity.
    tables : sequence of Table
        Of all studies.
    """
    found = {
        table.name: records(table) for table in tables if table.name.endswith(("-gaps", "-runs"))
    }
    deviating = [
        told
        for told in verdicts
        if told["profile"] == "default"
        and told["quantity"] in _ATTRIBUTED
        and str(told["verdict"]).startswith("deviates")
    ]
    rows = [row for told in deviating if _gaps(told) in found for row in _of(told, found)]
    rows += _unknown([told for told in deviating if _gaps(told) not in found])
    return Table(
        name="causes",
        title="Why engines deviate as they ship",
        frame=pd.DataFrame(rows, columns=list(_COLUMNS)),
        columns=_COLUMNS,
        shown=tuple(name for name in _COLUMNS if name not in {"alone", "command"}),
    )


def _gaps(told: Row) -> str:
    """Return the name of the attribution's table for an engine on a scene."""
    return f"{told['scene']}-{told['engine']}-gaps"


def _unknown(deviating: Sequence[Row]) -> Iterator[dict[str, object]]:
    """Yield, once for a scene and engine, how the causes are found out."""
    for scene, engine in dict.fromkeys((told["scene"], told["engine"]) for told in deviating):
        command = f"rockingcan attribute {scene} --engine {engine}"
        yield {
            "scene": scene,
            "engine": engine,
            "cause": f"not measured in this run: {command}",
            "command": command,
        }


def _of(told: Row, found: Mapping[str, list[Row]]) -> Iterator[dict[str, object]]:
    """Yield the causes of one deviation, largest first."""
    scene, engine, gaps = told["scene"], told["engine"], found[_gaps(told)]
    deviation = {
        "scene": scene,
        "engine": engine,
        "quantity": told["quantity"],
        "deviation": told["value"],
    }
    quantity = _ATTRIBUTED[str(told["quantity"])]
    known = [gap for gap in gaps if gap["quantity"] == quantity and gap["in_order"] is not None]
    known.sort(key=lambda gap: -abs(float(str(gap["in_order"]))))
    if not known:
        yield deviation | {"cause": "not decidable: a run on the way has no such number"}
    for rank, gap in enumerate(known[:_MOST], start=1):
        experiment = _experiment(found.get(f"{scene}-{engine}-runs", []), gap["gap"])
        yield deviation | {
            "rank": rank,
            "cause": gap["gap"],
            "takes_away": gap["in_order"],
            "alone": gap["alone"],
            "what_it_does": gap["what_it_does"],
            "case": experiment.get("case"),
            "command": experiment.get("command"),
        }


def _experiment(runs: Sequence[Row], gap: object) -> Row:
    """Return the run in which a gap is closed after those before it."""
    return next((run for run in runs if (run["step"], run["gap"]) == ("in order", gap)), {})


_HEADLINE = "paper-release"
"""The scene that the project is about; the first one where it was left out."""

_MISSING = "not measured in this run: rockingcan {}"

_TARGET = 0.1  # deg
_CHOICES = {
    "default": "settings as shipped",
    "matched": "tuned elsewhere, fixed step",
    "adaptive": "tuned elsewhere, steps follow the motion",
}
"""What the price list calls the settings of each profile."""

_WAYS = {
    "default": "as it ships",
    "matched": "matched",
    "adaptive": "matched, own steps",
}

_QUANTITIES: Mapping[str, str] = {
    "turn_error_deg": "Angle of turn of the worst bounce, engine minus truth.",
    "locus_error_mm": "Largest distance between the two contact loci as curves.",
    "friction_ratio_error": "Peak of |F|/N in the worst bounce, engine minus truth.",
    "slip_mm_s": "Largest horizontal speed of the can's material at the contact point.",
    "penetration_um": "Depth of the deepest contact.",
    "lift_off_percent": "Share of the time without contact force.",
    "energy_drift": "Largest departure of the energy from its first value, over m g R.",
}
_SPOKEN: Mapping[str, tuple[str, float]] = {
    "contact_locus_m": ("locus_error_mm", 1e3),
    "slip_m_s": ("slip_mm_s", 1e3),
    "penetration_m": ("penetration_um", 1e6),
    "lift_off_fraction": ("lift_off_percent", 1e2),
}
"""In which unit the scorecard says what the comparison measured in SI."""

_STABILITY: Mapping[str, str] = {
    "stability_percent": "Share of the hard cases, at the smallest timestep tried, that stay sound."
}
_PRICE: Mapping[str, str] = {
    "price_s_s": "Price of 0.1 degrees: processor seconds for each simulated second."
}


_WHO: Mapping[str, str] = {
    "engine": "Name of the engine.",
    "settings": "The profile in words, and its smallest timestep that was run.",
    "timestep_s": "Timestep of the engine; the largest of one that chooses its own.",
    "profile": "default: as it ships; matched: what the scene declares; adaptive: own steps.",
}


def derived(chapters: Sequence[Section]) -> tuple[Table, ...]:
    """Return the tables that a report makes of its chapters: scorecards, and causes.

    None where no chapter is the comparison.
    """
    tables = [a for chapter in chapters for a in chapter.artefacts if isinstance(a, Table)]
    verdicts = [row for table in tables if table.name == FIDELITY for row in records(table)]
    if not verdicts:
        return ()
    scenes = list(dict.fromkeys(str(row["scene"]) for row in verdicts))
    headline = _HEADLINE if _HEADLINE in scenes else scenes[0]
    return (
        _scorecard(headline, verdicts, tables),
        causes(verdicts, tables),
        *(_of_scene(scene, verdicts) for scene in scenes),
    )


def _scorecard(scene: str, verdicts: Sequence[Row], tables: Sequence[Table]) -> Table:
    """Return the scorecard that opens the page."""
    hard = [row for table in tables if table.name == "verdicts" for row in records(table)]
    prices = [r for table in tables if table.name == f"{scene}-prices" for r in records(table)]
    rows = [
        row | _stability(row, hard) | _price(row, prices, scene) for row in _rows(scene, verdicts)
    ]
    return _table(
        "engines",
        f"Scorecard: engines on {scene}",
        rows,
        {**_QUANTITIES, **_STABILITY, **_PRICE},
    )


def _of_scene(scene: str, verdicts: Sequence[Row]) -> Table:
    rows = _rows(scene, verdicts)
    return _table(f"{scene}-engines", "The engines", rows, _QUANTITIES, scene=scene)


def _rows(scene: str, verdicts: Sequence[Row]) -> list[dict[str, Any]]:
    """Return a row for each engine and profile, with the numbers of a scene."""
    found: dict[tuple[str, str], dict[str, Any]] = {}
    for told in verdicts:
        if told["scene"] != scene:
            continue
        engine, profile = str(told["engine"]), str(told["profile"])
        row = found.setdefault(
            (engine, profile),
            {
                "engine": engine,
                "profile": profile,
                "settings": _settings(profile, told["timestep_s"]),
                "timestep_s": told["timestep_s"],
            },
        )
        name, scale = _SPOKEN.get(str(told["quantity"]), (str(told["quantity"]), 1.0))
        value = told["value"]
        row |= {
            name: None if value is None else scale * float(str(value)),
            f"{name}_verdict": told["verdict"],
            f"{name}_case": told["case"],
        }
    places = list(_WAYS)
    return sorted(
        found.values(),
        key=lambda row: (
            row["engine"],
            places.index(row["profile"]) if row["profile"] in places else len(places),
        ),
    )


def _settings(profile: str, timestep: object) -> str:
    """Return a profile in words, with its timestep."""
    words = _WAYS.get(profile, profile)
    if timestep is None:
        return words
    most = "up to " if profile == "adaptive" else ""
    return f"{words}, {most}{readable(timestep)} s"


def _stability(row: Row, hard: Sequence[Row]) -> dict[str, Any]:
    """Return how an engine's profile fares on the hard cases."""
    own: dict[str, Row] = {}
    for told in hard:
        scene = str(told["scene"])
        if told["engine"] != row["engine"] or told["profile"] != row["profile"] or "." in scene:
            continue  # a dot: a release perturbed from a hard case
        if scene not in own or _step(told) < _step(own[scene]):
            own[scene] = told
    if not own:
        return {"stability_percent_verdict": _MISSING.format("stability")}
    sound = {verdict.value for verdict in SOUND}
    failed = [told for told in own.values() if told["verdict"] not in sound]
    words = f"agrees: all {len(own)} hard cases stay sound"
    if failed:
        words = f"deviates: {len(failed)} of {len(own)} hard cases fail"
    return {
        "stability_percent": 100.0 * (1.0 - len(failed) / len(own)),
        "stability_percent_verdict": words,
        "stability_percent_case": failed[0]["case"] if failed else None,
    }


def _step(row: Row) -> float:
    return float(str(row["timestep_s"]))


def _price(row: Row, prices: Sequence[Row], scene: str) -> dict[str, Any]:
    """Return what a tenth of a degree costs in an engine's profile."""
    if not prices:
        return {"price_s_s_verdict": _MISSING.format(f"cost {scene}")}
    for told in prices:
        same = told["engine"] == row["engine"] and told["target_deg"] == _TARGET
        if same and told["choice"] == _CHOICES.get(str(row["profile"])):
            verdict = str(told["verdict"])
            reached = not verdict.startswith("not reached")
            return {
                "price_s_s": told["cost_s_s"] if reached else None,
                "price_s_s_verdict": verdict,
                "price_s_s_case": told.get("case"),
            }
    return {"price_s_s_verdict": "not decidable: the price list has no such settings"}


def _table(
    name: str,
    title: str,
    rows: list[dict[str, Any]],
    quantities: Mapping[str, str],
    *,
    scene: str = "",
) -> Table:
    columns = dict(_WHO)
    for quantity, meaning in quantities.items():
        columns |= {
            quantity: meaning,
            f"{quantity}_verdict": f"Verdict in words on {quantity}.",
            f"{quantity}_case": f"Digest of the case behind {quantity}.",
        }
    return Table(
        name=name,
        title=title,
        frame=pd.DataFrame(rows, columns=list(columns)),
        columns=columns,
        shown=("engine", "settings", *quantities),
        scene=scene,
        verdicts={quantity: f"{quantity}_verdict" for quantity in quantities},
        cases={quantity: f"{quantity}_case" for quantity in quantities},
    )
