"""The scorecard: engines against quantities, from the tables of all studies that are there.

The comparison says how faithful each engine is, the study of stability how it fares on hard cases,
the study of cost what a tenth of a degree takes. What was not measured is said to be so, with the
command that measures it. A scene's own scorecard leads its section.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd

from harness.artefact import Table
from harness.report.causes import causes
from harness.report.chapter import FIDELITY, Chapter
from harness.report.digits import readable
from harness.report.records import Row, records
from harness.studies.stability.verdict import SOUND

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


def derived(chapters: Sequence[Chapter]) -> tuple[Table, ...]:
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
