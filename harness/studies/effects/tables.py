"""The effects study in tables: a row an effect and engine, and every run with its command."""

from collections.abc import Mapping
from typing import Any

import pandas as pd

from harness.core.case import Case
from harness.core.report_model import Table
from harness.evaluation.evaluation import Evaluation
from harness.studies.effects.changes import CHANGED, EffectCost
from harness.studies.effects.plan import EffectsPlan, case, subsets
from harness.studies.effects.verdict import Effect

_EFFECTS: Mapping[str, str] = {
    "scene": "Name of the scene.",
    "engine": "Name of the engine.",
    "effect": "Name of the effect, its key in a scene file.",
    "declared": "Whether the scene declares it.",
    "simulated": "Whether the engine simulates it in this scene.",
    "verdict": "Needed: declared, and it changes the outcome; harmless: it does not; missing: not "
    "declared, though at the assumed strength it would; imposed by the engine: it cannot be "
    "removed; unsupported: the engine cannot represent it.",
    "why": "The number behind the verdict.",
    "strength": "Constants of its law, SI units: as declared, or as assumed of the surroundings.",
    "steps_ratio": "Steps per simulated second with it over those without it.",
    "constraint_rows_ratio": "Constraint rows per simulated second, likewise.",
    "cpu_ratio": "Processor time per simulated second, likewise; least of repeats, timed alone.",
    "cpu_spread": "Longest over shortest processor time of the repeats of the noisier run.",
    **{
        f"change_{q.key}": f"{q.meaning} With the effect less without it, others as declared."
        for q in CHANGED
    },
    "case": "Names the case with the effect in this version of its engine.",
    "command": "Runs it again, where it is a scene that has a file.",
}


def effect_table(
    made: EffectsPlan,
    found: Mapping[Case, Evaluation],
    effects: tuple[Effect, ...],
    prices: Mapping[tuple[str, str], EffectCost],
) -> Table:
    """Return what each effect does in each engine."""
    rows = []
    for one in effects:
        cost = prices[one.mover, one.name]
        chosen = case(made, one.mover, made.declared | {one.name})
        version = "" if chosen is None else found[chosen].simulation.engine_version
        rows.append(
            {
                "scene": made.scene.name,
                "engine": one.mover,
                "effect": one.name,
                "declared": one.declared,
                "simulated": one.declared and chosen is not None,
                "verdict": one.verdict.value,
                "why": one.why,
                "strength": strength(made, one.name),
                "steps_ratio": cost.steps,
                "constraint_rows_ratio": cost.constraint_rows,
                "cpu_ratio": cost.cpu,
                "cpu_spread": cost.cpu_spread,
                **{f"change_{q.key}": one.changes.get(q.key) for q in CHANGED},
                "case": "" if chosen is None else chosen.digest(version),
                "command": "" if chosen is None else chosen.command(),
            }
        )
    return _table(made, "effects", "What each effect does", rows, _EFFECTS)


_FACTORS: Mapping[str, str] = {
    "scene": "Name of the scene.",
    "engine": "Name of the engine.",
    "effect": "Name of a declared effect.",
    "quantity": "What changes; the unit is its suffix.",
    "from_ideal": "Change when the effect is added to the ideal can.",
    "from_declared": "Change between all declared effects and all but this one.",
    "mean": "Change averaged over all sets of the other declared effects (main effect).",
    "interaction": "From declared less from ideal: what it does only together with the others.",
}


def factor_table(made: EffectsPlan, effects: tuple[Effect, ...]) -> Table | None:
    """Return how the declared effects act together; None if the scene declares none."""
    rows = []
    for one in effects:
        for quantity in CHANGED if one.declared else ():
            alone, late = one.alone.get(quantity.key), one.changes.get(quantity.key)
            rows.append(
                {
                    "scene": made.scene.name,
                    "engine": one.mover,
                    "effect": one.name,
                    "quantity": quantity.key,
                    "from_ideal": alone,
                    "from_declared": late,
                    "mean": one.mean.get(quantity.key),
                    "interaction": None if alone is None or late is None else late - alone,
                }
            )
    if not rows:
        return None
    return _table(made, "factors", "How the declared effects act together", rows, _FACTORS)


_RUNS: Mapping[str, str] = {
    "scene": "Name of the scene.",
    "engine": "Name of the engine.",
    "model": "What was solved.",
    "effects": "Effects in force.",
    **{q.key: q.meaning for q in CHANGED},
    "steps": "Steps of the run.",
    "constraint_rows": "Constraint rows, summed over the steps.",
    "outcome": "How the run ended.",
    "note": "What else is to be known of it.",
    "case": "Names the case in this version of its engine.",
}


def run_table(made: EffectsPlan, found: Mapping[Case, Evaluation]) -> Table:
    """Return every run of the study."""
    rows = []
    for mover in made.engines:
        for subset in dict.fromkeys(subsets(made)):
            chosen = case(made, mover, subset)
            if chosen is None:
                continue
            simulation = found[chosen].simulation
            row: dict[str, Any] = {
                "scene": made.scene.name,
                "engine": mover,
                "model": simulation.model,
                "effects": ", ".join(sorted(subset)) or "none",
                "steps": simulation.steps,
                "constraint_rows": simulation.constraint_rows,
                "outcome": simulation.outcome.value,
                "note": simulation.note,
                "case": chosen.digest(simulation.engine_version),
            }
            rows.append(row | {q.key: q.of_run(found[chosen]) for q in CHANGED})
    return _table(made, "runs", "Every run of the study", rows, _RUNS)


def strength(made: EffectsPlan, name: str) -> str:
    """Return the constants of an effect as `--assume` and a scene file know them."""
    law = made.strengths[name]
    constants = ((key, getattr(law, key)) for key in law.__dataclass_fields__)
    return ", ".join(f"{key} = {value:g}" for key, value in constants if value != 0.0)


def _table(
    made: EffectsPlan, name: str, title: str, rows: list[dict[str, Any]], columns: Mapping[str, str]
) -> Table:
    """Return a table whose name says the scene."""
    return Table(
        name=f"{made.scene.name}-{name}",
        title=title,
        frame=pd.DataFrame(rows, columns=list(columns)),
        columns=columns,
        shown=tuple(column for column in columns if column not in {"scene", "case", "command"}),
        scene=made.scene.name,
    )
