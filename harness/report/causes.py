"""Why an engine as it ships deviates: the causes that the attribution found, by rank.

Each cause is a gap of the engine's defaults. The experiment that confirms it is the run in which
the gap is closed; its command stands in the row.
"""

from collections.abc import Iterator, Mapping, Sequence

import pandas as pd

from harness.artefact import Table
from harness.report.records import Row, records

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
