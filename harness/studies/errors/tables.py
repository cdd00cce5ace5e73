"""The three errors in tables: the split, the ladder, the solver's efforts, the ensemble."""

from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd

from harness.core.case import Case
from harness.core.report_model import Table
from harness.evaluation.evaluation import Evaluation
from harness.metrics.quantities import Number, Quantity
from harness.studies.errors.plan import ErrorsPlan
from harness.studies.errors.split import Split, Spread
from harness.studies.shared.perturbation import SIZES

_HEAD: Mapping[str, str] = {
    "scene": "Name of the scene.",
    "engine": "Name of the engine.",
    "profile": "Where the settings start from.",
}
_QUANTITY = "Which number; the unit is its suffix."

_SPLIT: Mapping[str, str] = {
    **_HEAD,
    "way": "How the timestep is shrunk.",
    "quantity": _QUANTITY,
    "timestep_s": "Timestep at which the error is split, s.",
    "true": "Of the exact motion.",
    "value": "Of the engine at this timestep, solver as set.",
    "limit": "Of the engine for a timestep of zero, solver converged, extrapolated.",
    "limit_uncertainty": "Half-width of the interval about the limit.",
    "model_form": "Limit less true: what no timestep and no solver takes away.",
    "discretisation": "Value with the solver converged less limit.",
    "solver": "Value less value with the solver converged.",
    "total": "Value less true: the sum of the three.",
    "observed_order": "Order at which the limit is approached.",
    "order_spread": "Half the range of the last observed orders.",
    "not_decidable_within": "Spread of releases that differ by 1e-6, of engine or truth.",
    "verdict": "undecidable: the total is within that band; no model error seen: model form is "
    "within band and uncertainty; model error: it stands out.",
    "command": "Runs the case again.",
}


def split_table(
    plan: ErrorsPlan, splits: Mapping[tuple[str, str], Split], known: Sequence[Quantity]
) -> Table:
    """Return the three errors, a row a way and quantity."""
    rows = []
    for way in plan.ways:
        for quantity in known:
            found = splits[way.name, quantity.key]
            own = found.limit
            rows.append(
                _head(plan)
                | {
                    "way": way.name,
                    "quantity": quantity.key,
                    "timestep_s": plan.probe,
                    "true": found.true,
                    "value": found.value,
                    "limit": own and own.value,
                    "limit_uncertainty": own and own.uncertainty,
                    "model_form": found.model_form,
                    "discretisation": found.discretisation,
                    "solver": found.solver,
                    "total": found.total,
                    "observed_order": own and own.order,
                    "order_spread": own and own.spread,
                    "not_decidable_within": found.band,
                    "verdict": found.verdict,
                    "command": plan.tried(way, None).command(),
                }
            )
    return _table(plan, "split", "Three errors, never mixed", rows, _SPLIT)


_LADDER: Mapping[str, str] = {
    **_HEAD,
    "way": "How the timestep is shrunk.",
    "quantity": _QUANTITY,
    "timestep_s": "Timestep, s.",
    "value": "Of the engine, solver converged.",
    "off_true": "Value less that of the exact motion.",
    "off_limit": "Value less the engine's own limit: discretisation.",
    "outcome": "How the run ended.",
    "case": "Names the case in this version of its engine.",
    "command": "Runs the case again.",
}


def ladder_table(
    plan: ErrorsPlan,
    evaluations: Mapping[Case, Evaluation],
    splits: Mapping[tuple[str, str], Split],
    known: Sequence[Quantity],
) -> Table:
    """Return every rung of every ladder."""
    rows = []
    for way in plan.ways:
        for quantity in known:
            found = splits[way.name, quantity.key]
            for step in plan.timesteps:
                case = plan.on_ladder(way, step)
                value = quantity.of_run(evaluations[case])
                rows.append(
                    _head(plan)
                    | {
                        "way": way.name,
                        "quantity": quantity.key,
                        "timestep_s": step,
                        "value": value,
                        "off_true": _less(value, found.true),
                        "off_limit": _less(
                            value, None if found.limit is None else found.limit.value
                        ),
                    }
                    | _run(case, evaluations)
                )
    return _table(plan, "ladder", "Every rung of the ladders", rows, _LADDER)


_EFFORTS: Mapping[str, str] = {
    **_HEAD,
    "way": "How the timestep is shrunk.",
    "quantity": _QUANTITY,
    "timestep_s": "Timestep, s.",
    "effort": "How hard the solver tries.",
    "value": "Of the engine.",
    "off_converged": "Value less that with the solver converged.",
    "outcome": "How the run ended.",
    "case": "Names the case in this version of its engine.",
    "command": "Runs the case again.",
}


def effort_table(
    plan: ErrorsPlan, evaluations: Mapping[Case, Evaluation], known: Sequence[Quantity]
) -> Table:
    """Return the solver at every effort, at one timestep."""
    rows = []
    for way in plan.ways:
        for quantity in known:
            converged = quantity.of_run(evaluations[plan.on_ladder(way, plan.probe)])
            for effort in (None, *plan.efforts):
                case = plan.tried(way, effort)
                value = quantity.of_run(evaluations[case])
                rows.append(
                    _head(plan)
                    | {
                        "way": way.name,
                        "quantity": quantity.key,
                        "timestep_s": plan.probe,
                        "effort": "as set" if effort is None else effort.name,
                        "value": value,
                        "off_converged": _less(value, converged) if plan.efforts else None,
                    }
                    | _run(case, evaluations)
                )
    return _table(plan, "efforts", "The solver at several efforts", rows, _EFFORTS)


_ENSEMBLE: Mapping[str, str] = {
    **_HEAD,
    "quantity": _QUANTITY,
    "timestep_s": "Timestep, s.",
    "relative_size": "Of the perturbations of phi, psi' and theta' at the release.",
    "spread_of_engine": "Largest departure of the engine's value from that of the exact release.",
    "spread_of_truth": "The same of the exact motion.",
    "spread_of_error": "The same of engine minus truth.",
    "members": "Perturbed releases that it rests on.",
}


def ensemble_table(
    plan: ErrorsPlan, spreads: Mapping[tuple[str, float], Spread], known: Sequence[Quantity]
) -> Table:
    """Return how far perturbed releases spread."""
    rows = [
        _head(plan)
        | {
            "quantity": quantity.key,
            "timestep_s": plan.probe,
            "relative_size": size,
            "spread_of_engine": spreads[quantity.key, size].of_engine,
            "spread_of_truth": spreads[quantity.key, size].of_truth,
            "spread_of_error": spreads[quantity.key, size].of_error,
            "members": spreads[quantity.key, size].members,
        }
        for quantity in known
        for size in SIZES
    ]
    return _table(plan, "spreads", "What is not decidable", rows, _ENSEMBLE)


def _head(plan: ErrorsPlan) -> dict[str, Any]:
    return {"scene": plan.scene.name, "engine": plan.engine, "profile": plan.profile}


def _run(case: Case, evaluations: Mapping[Case, Evaluation]) -> dict[str, Any]:
    """Return how a run ended and how to run it again."""
    simulation = evaluations[case].simulation
    return {
        "outcome": simulation.outcome.value,
        "case": case.digest(simulation.engine_version),
        "command": case.command(),
    }


def _less(first: Number, second: Number) -> Number:
    return None if first is None or second is None else first - second


def _table(
    plan: ErrorsPlan, name: str, title: str, rows: list[dict[str, Any]], columns: Mapping[str, str]
) -> Table:
    """Return a table whose name says scene, engine and profile."""
    return Table(
        name=f"{plan.scene.name}-{plan.engine}-{plan.profile}-{name}",
        title=f"{title}: {plan.engine}, {plan.profile}",
        frame=pd.DataFrame(rows, columns=list(columns)),
        columns=columns,
        shown=tuple(column for column in columns if column not in {"scene", "engine", "profile"}),
        scene=plan.scene.name,
    )
