"""The attribution in tables: the gaps, how they interact, and every run with its command."""

from collections.abc import Iterable, Mapping
from typing import Any

import pandas as pd

from harness.core.case import Case
from harness.core.report_model import Table
from harness.evaluation.evaluation import Evaluation
from harness.metrics.quantities import QUANTITIES, recorded_turn_error, turn_error
from harness.studies.attribution.ablation import AblationPath, Account, Level, case, stops, total

ATTRIBUTED = tuple(
    QUANTITIES[key]
    for key in (
        "turn_error_deg",
        "contact_locus_rms_m",
        "phi_rms_rad",
        "peak_friction_ratio_error",
        "contact_locus_hausdorff_m",
    )
)
"""The discrepancies that are attributed, in the order in which words and figures take them."""


def uncounted(evaluations: Iterable[Evaluation]) -> int:
    """Return in how many runs of a scene that ends with a bounce the turn is not known."""
    return sum(
        turn_error(e) is None
        for e in evaluations
        if e.simulation.case.scene.horizon.seconds is None
    )


_GAPS: Mapping[str, str] = {
    "scene": "Name of the scene.",
    "engine": "Name of the engine.",
    "place": "Place of the gap in the order of closing, from 1.",
    "gap": "Name of the gap.",
    "quantity": "Which discrepancy; the unit is its suffix.",
    "in_order": "What closing the gap takes away after those before it; sums to the whole.",
    "share_of_whole": "The same as a share of what closing all gaps takes away.",
    "alone": "What closing only this gap takes away from the engine as it ships.",
    "left_open": "What only this gap adds to the matched engine when it is open.",
    "interaction": "In order less alone: what it takes away only because others are closed.",
    "what_it_does": "What the open gap does to the can.",
    "settings": "Settings that close it.",
}


def gap_table(way: AblationPath, accounts: Mapping[str, Account]) -> Table:
    """Return what each gap accounts for, a row a gap and quantity."""
    rows = []
    for quantity in ATTRIBUTED:
        found = accounts[quantity.key]
        for place, gap in enumerate(way.gaps):
            in_order, alone = found.in_order[place], found.alone[place]
            rows.append(
                {
                    "scene": way.scene.name,
                    "engine": way.engine,
                    "place": place + 1,
                    "gap": gap.name,
                    "settings": ", ".join(gap.settings),
                    "what_it_does": gap.sentence,
                    "quantity": quantity.key,
                    "in_order": in_order,
                    "share_of_whole": _ratio(in_order, found.whole),
                    "alone": alone,
                    "left_open": found.left_open[place],
                    "interaction": None if in_order is None or alone is None else in_order - alone,
                }
            )
    return _table(
        way, "gaps", "What each gap accounts for", rows, _GAPS, skipped=("scene", "engine")
    )


_INTERACTIONS: Mapping[str, str] = {
    "scene": "Name of the scene.",
    "engine": "Name of the engine.",
    "quantity": "Which discrepancy; the unit is its suffix.",
    "as_shipped": "Discrepancy with all gaps open.",
    "remains": "Discrepancy with all gaps closed: profile matched.",
    "whole": "As shipped less what remains.",
    "sum_in_order": "Sum of what the gaps take away one after the other: the whole.",
    "sum_alone": "Sum of what each gap takes away alone.",
    "interaction": "Sum alone less the whole: what the gaps do only together.",
    "sum_left_open": "Sum of what each gap adds when only it is open.",
    "interaction_left_open": "The same less the whole.",
}


def interaction_table(way: AblationPath, accounts: Mapping[str, Account]) -> Table:
    """Return the whole, the sums and the interaction, a row a quantity."""
    rows = []
    for quantity in ATTRIBUTED:
        found = accounts[quantity.key]
        rows.append(
            {
                "scene": way.scene.name,
                "engine": way.engine,
                "quantity": quantity.key,
                "as_shipped": found.shipped,
                "remains": found.remains,
                "whole": found.whole,
                "sum_in_order": total(found.in_order),
                "sum_alone": total(found.alone),
                "interaction": found.interaction,
                "sum_left_open": total(found.left_open),
                "interaction_left_open": found.interaction_left_open,
            }
        )
    return _table(way, "interactions", "The whole and its parts", rows, _INTERACTIONS)


_RUNS: Mapping[str, str] = {
    "scene": "Name of the scene.",
    "engine": "Name of the engine.",
    "step": "As shipped; in order: this gap and those before it closed; alone: only it closed; "
    "left open: all closed but it.",
    "gap": "Name of the gap.",
    "closed": "Gaps closed in this run.",
    "timestep_s": "Timestep of the engine, s.",
    **{quantity.key: quantity.meaning for quantity in ATTRIBUTED},
    "turn_error_seen_deg": "Error of the turn as recorded, right up to whole turns if unresolved.",
    "turn_resolved": "Whether the record is dense enough to count the turns of psi.",
    **{f"takes_away_{q.key}": f"What this step takes away of {q.key}." for q in ATTRIBUTED},
    "outcome": "How the run ended.",
    "case": "Names the case in this version of its engine.",
    "command": "Runs the case again.",
}


def run_table(
    way: AblationPath, evaluations: Mapping[Case, Evaluation], accounts: Mapping[str, Account]
) -> Table:
    """Return every run, with what it takes away and the command that reproduces it."""
    rows = []
    for stop in stops(way):
        chosen = case(way, stop.closed)
        e = evaluations[chosen]
        row: dict[str, Any] = {
            "scene": way.scene.name,
            "engine": way.engine,
            "step": stop.step,
            "gap": stop.gap,
            "closed": ", ".join(name for name in way.names if name in stop.closed),
            "timestep_s": e.simulation.timestep,
            "turn_error_seen_deg": recorded_turn_error(e),
            "turn_resolved": e.bounces[0].resolved if e.bounces else None,
            "outcome": e.simulation.outcome.value,
            "case": chosen.digest(e.simulation.engine_version),
            "command": chosen.command(),
        }
        for quantity in ATTRIBUTED:
            found = accounts[quantity.key]
            row[quantity.key] = quantity.of_run(e)
            if stop.gap:
                effects = {"in order": found.in_order, "alone": found.alone}
                parts = effects.get(stop.step, found.left_open)
                row[f"takes_away_{quantity.key}"] = parts[way.names.index(stop.gap)]
        rows.append(row)
    return _table(
        way,
        "runs",
        "Every run of the attribution",
        rows,
        _RUNS,
        skipped=("scene", "engine", *(f"takes_away_{q.key}" for q in ATTRIBUTED[1:])),
    )


def _ratio(part: Level, whole: Level) -> Level:
    return None if part is None or whole is None or whole == 0.0 else part / whole


def _table(
    way: AblationPath,
    name: str,
    title: str,
    rows: list[dict[str, Any]],
    columns: Mapping[str, str],
    *,
    skipped: tuple[str, ...] = (),
) -> Table:
    """Return a table whose name says scene and engine."""
    return Table(
        name=f"{way.scene.name}-{way.engine}-{name}",
        title=f"{title}: {way.engine}",
        frame=pd.DataFrame(rows, columns=list(columns)),
        columns=columns,
        shown=tuple(column for column in columns if column not in skipped),
        scene=way.scene.name,
    )
