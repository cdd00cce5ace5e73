"""The study of three errors: model form, discretisation and solver, separated and never mixed.

In figures: against the timestep, against effort, and what cannot be decided.
"""

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from harness.core.case import Case
from harness.core.report_model import (
    Artefact,
    Column,
    Figure,
    Panel,
    Prose,
    Series,
    Table,
    rows_of,
)
from harness.core.trajectory import Floats
from harness.engines.ladder import finer_by, rung_of, takes_timestep
from harness.evaluation.evaluation import Evaluation
from harness.metrics.quantities import Number, Quantity, less
from harness.studies.errors.extrapolation import limit
from harness.studies.errors.plan import ErrorsPlan, ThreeErrors, Way
from harness.studies.errors.split import Split, spread
from harness.studies.shared import run_columns
from harness.studies.shared.perturbation import MEMBERS, SIZES
from harness.studies.study import EVALUATION, Job, Results, evaluation_jobs


@dataclass(frozen=True, slots=True, kw_only=True)
class ErrorsStudy:
    """Run ladders, efforts and an ensemble, and separate the three errors.

    Parameters
    ----------
    plan : ErrorsPlan
        From `harness.studies.errors.plan.plan_errors`.
    """

    plan: ErrorsPlan

    name = "three errors"

    def next_jobs(self, _: Results) -> list[Job[Case, Evaluation]]:
        """Return the cases of the plan."""
        return evaluation_jobs(self.plan.cases())

    def findings(self, done: Results) -> ThreeErrors:
        """Return the three errors of every quantity on every way."""
        plan, runs = self.plan, done.of(EVALUATION)
        known = plan.quantities

        def values(case: Case, quantity: Quantity) -> tuple[Number, Number]:
            return quantity.of_run(runs[case]), quantity.of_truth(runs[case])

        spreads = {
            (q.key, size): spread(
                values(plan.tried(plan.ways[0], None), q),
                [values(plan.member(size, number), q) for number in range(MEMBERS)],
            )
            for q in known
            for size in SIZES
        }
        splits = {}
        for way in plan.ways:
            for q in known:
                ladder = [q.of_run(runs[plan.on_ladder(way, step)]) for step in plan.rungs]
                value, true = values(plan.tried(way, None), q)
                # releases that differ by no more than a few roundings show what of it is noise
                noise = spreads[q.key, SIZES[0]].of_error or 0.0
                splits[way.name, q.key] = Split(
                    case=plan.tried(way, None),
                    way=way.name,
                    quantity=q.key,
                    true=true,
                    value=value,
                    rigid=None if plan.rigid is None else q.of_run(runs[plan.rigid]),
                    ladder=tuple(ladder),
                    converged=q.of_run(runs[plan.on_ladder(way, plan.probe)]),
                    limit=limit(plan.rungs, ladder, noise=noise),
                    band=spreads[q.key, SIZES[-1]].band,
                )
        evaluations = {case: runs[case] for case in plan.cases()}
        return ThreeErrors(plan=plan, evaluations=evaluations, spreads=spreads, splits=splits)

    def report(self, done: Results) -> tuple[Artefact, ...]:
        """Return words, figures and tables."""
        return errors_report(self.findings(done))

    def answer(self, done: Results) -> dict[str, Any]:
        """Return the three errors as `--json` prints them."""
        results = self.findings(done)
        left_out = ("scene", "engine", "profile", "timestep_s", "order_spread", "command")
        return {
            "scene": self.plan.scene.name,
            "engine": self.plan.engine,
            "profile": self.plan.profile,
            _probe_key(self.plan.engine): self.plan.probe,
            "ladder_s" if takes_timestep(self.plan.engine) else "ladder": list(self.plan.rungs),
            "errors": [
                {key: value for key, value in row.items() if key not in left_out}
                for row in rows_of(_SPLIT, results.splits.values())
            ],
            "sentences": list(results.sentences),
        }


_PROFILE = Column("profile", "Where the settings start from.", "simulation.case.profile")
_HEAD = (run_columns.SCENE, run_columns.ENGINE, _PROFILE)
_WAY = Column("way", "How the timestep is shrunk.")
_QUANTITY = Column("quantity", "Which number; the unit is its suffix.")

_SPLIT = (
    run_columns.SCENE.of("case.scene.name"),
    run_columns.ENGINE.of("case.engine"),
    _PROFILE.of("case.profile"),
    _WAY,
    _QUANTITY,
    Column("timestep_s", "Timestep at which the error is split, s.", "case.timestep"),
    Column("true", "Of the exact motion."),
    Column("value", "Of the engine at this timestep, solver as set."),
    Column("limit", "Of the engine for a timestep of zero, solver converged.", "limit.value"),
    Column("limit_uncertainty", "Half-width of the interval about it.", "limit.uncertainty"),
    Column("model_form", "Limit less true: what no timestep and no solver takes away."),
    Column("discretisation", "Value with the solver converged less limit."),
    Column("solver", "Value less value with the solver converged."),
    Column("total", "Value less true: the sum of the three."),
    Column("softness", "True less that of a rigid contact, where the scene declares another."),
    Column("observed_order", "Order at which the limit is approached.", "limit.order"),
    Column("order_spread", "Half the range of the last observed orders.", "limit.spread"),
    Column("not_decidable_within", "Spread of releases that differ by 1e-6.", "band"),
    Column(
        "verdict",
        "undecidable: the total is within that band; no model error seen: model form is within "
        "band and uncertainty; model error: it stands out.",
        "verdict.value",
    ),
    run_columns.COMMAND.of("case.command"),
)

_LADDER = (
    *_HEAD,
    _WAY,
    _QUANTITY,
    run_columns.TIMESTEP,
    Column("value", "Of the engine, solver converged."),
    Column("off_true", "Value less that of the exact motion."),
    Column("off_limit", "Value less the engine's own limit: discretisation."),
    run_columns.OUTCOME,
    run_columns.CASE,
    run_columns.COMMAND,
)

_EFFORTS = (
    *_HEAD,
    _WAY,
    _QUANTITY,
    run_columns.TIMESTEP,
    Column("effort", "How hard the solver tries."),
    Column("value", "Of the engine."),
    Column("off_converged", "Value less that with the solver converged."),
    run_columns.OUTCOME,
    run_columns.CASE,
    run_columns.COMMAND,
)

_ENSEMBLE = (
    *_HEAD,
    _QUANTITY,
    run_columns.TIMESTEP.of("rung"),
    Column("relative_size", "Of the perturbations of phi, psi' and theta' at release."),
    Column(
        "spread_of_engine",
        "Largest departure from that of the exact release.",
        "spread.of_engine",
    ),
    Column("spread_of_truth", "The same of the exact motion.", "spread.of_truth"),
    Column("spread_of_error", "The same of engine minus truth.", "spread.of_error"),
    Column("members", "Perturbed releases that it rests on.", "spread.members"),
)


def errors_report(results: ThreeErrors) -> tuple[Artefact, ...]:
    """Return words, figures, tables."""
    plan = results.plan
    return (
        Prose(
            name=f"{plan.scene.name}-{plan.engine}-three-errors",
            title=f"Three errors of {plan.engine}, never mixed",
            text=" ".join(results.sentences),
            scene=plan.scene.name,
        ),
        _ladder_figure(results),
        *([_effort_figure(results)] if plan.efforts[:-1] else ()),
        _ensemble_figure(results),
        _table(plan, "split", "Three errors, never mixed", _SPLIT, results.splits.values()),
        _table(plan, "ladder", "Every rung of the ladders", _LADDER, _ladder_rows(results)),
        _table(plan, "efforts", "The solver at several efforts", _EFFORTS, _effort_rows(results)),
        _table(plan, "spreads", "What is not decidable", _ENSEMBLE, _ensemble_rows(results)),
    )


def _table(
    plan: ErrorsPlan, name: str, title: str, columns: tuple[Column, ...], records: Iterable[object]
) -> Table:
    name, title = f"{plan.engine}-{plan.profile}-{name}", f"{title}: {plan.engine}, {plan.profile}"
    hidden = ("scene", "engine", "profile")
    if not takes_timestep(plan.engine):
        own = Column(finer_by(plan.engine), "Error allowed in a step of its own.", _rung)
        columns = tuple(own if column.name == "timestep_s" else column for column in columns)
    return run_columns.scene_table(plan.scene.name, name, title, columns, records, *hidden)


def _rung(record: Any) -> float | None:  # noqa: ANN401 - of any table here
    """Return the accuracy of a row, which is a split error or a mapping."""
    accuracy: float | None = record["rung"] if isinstance(record, dict) else rung_of(record.case)
    return accuracy


def _probe_key(engine: str) -> str:
    """Return the key of the timestep in `--json`, or of the accuracy in its place."""
    return "timestep_s" if takes_timestep(engine) else finer_by(engine)


def _run(results: ThreeErrors, case: Case, way: Way, quantity: Quantity) -> dict[str, Any]:
    """Return the cells of a run that is read for one quantity."""
    e, split = results.evaluations[case], results.splits[way.name, quantity.key]
    value = quantity.of_run(e)
    return {
        "simulation": e.simulation,
        "timestep_s": case.timestep,
        "rung": rung_of(case),
        "way": way.name,
        "quantity": quantity.key,
        "value": value,
        "off_true": less(value, split.true),
        "off_limit": less(value, split.limit_value),
        "off_converged": less(value, split.converged) if results.plan.efforts else None,
    }


def _ladder_rows(results: ThreeErrors) -> list[dict[str, Any]]:
    """Return every rung of every ladder."""
    plan = results.plan
    return [
        _run(results, plan.on_ladder(way, step), way, quantity)
        for way in plan.ways
        for quantity in plan.quantities
        for step in plan.rungs
    ]


def _effort_rows(results: ThreeErrors) -> list[dict[str, Any]]:
    """Return the solver at every effort, at one timestep."""
    plan = results.plan
    return [
        _run(results, plan.tried(way, effort), way, quantity)
        | {"effort": "as set" if effort is None else effort.name}
        for way in plan.ways
        for quantity in plan.quantities
        for effort in (None, *plan.efforts)
    ]


def _ensemble_rows(results: ThreeErrors) -> list[dict[str, Any]]:
    """Return how far perturbed releases spread."""
    plan = results.plan
    head = {"scene": plan.scene.name, "engine": plan.engine, "profile": plan.profile}
    return [
        head | {"quantity": key, "rung": plan.probe, "relative_size": size, "spread": spread}
        for (key, size), spread in results.spreads.items()
    ]


def _figure(
    plan: ErrorsPlan,
    name: str,
    title: str,
    x_label: str,
    curves: Callable[[Quantity], Iterator[Series]],
    *,
    seen: str,
    names: tuple[str, ...] = (),
) -> Figure:
    """Return a figure with a panel for each quantity; its name and title say engine and profile."""
    return Figure(
        name=f"{plan.scene.name}-{plan.engine}-{plan.profile}-{name}",
        title=f"{title}: {plan.engine}, {plan.profile}",
        seen=seen,
        panels=tuple(
            Panel(
                title=quantity.label.capitalize(),
                x_label=x_label,
                y_label=f"off by [{quantity.unit}]" if quantity.unit else "off by",
                series=tuple(curves(quantity)),
                log_x=not names,
                log_y=True,
                x_names=names,
            )
            for quantity in plan.quantities
        ),
        scene=plan.scene.name,
    )


def _ladder_figure(results: ThreeErrors) -> Figure:
    """Return the errors against the timestep: from the truth, and from the engine's own limit."""
    plan = results.plan

    def curves(quantity: Quantity) -> Iterator[Series]:
        for way in plan.ways:
            split = results.splits[way.name, quantity.key]
            for name, level in (("truth", split.true), ("limit", split.limit_value)):
                yield Series(
                    label=f"off {name}, {way.name}",
                    kind=_kind(plan, way),
                    x=np.array(plan.rungs),
                    y=_off(split.ladder, level),
                    mark="both",
                    dashed=name == "limit",
                )

    seen = (
        "Off its own limit (dashed) an engine falls with the timestep: discretisation. Where the "
        "error against the truth (solid) falls with it, the limit is the truth; where it levels "
        "off, what is left is model form, and no timestep takes it away."
    )
    title = "Model form and discretisation"
    along = finer_by(plan.engine)
    x_label = "timestep [s]" if takes_timestep(plan.engine) else along
    return _figure(plan, "errors", title, x_label, curves, seen=seen.replace("timestep", along))


def _effort_figure(results: ThreeErrors) -> Figure:
    """Return the solver error against the effort."""
    plan, lesser = results.plan, results.plan.efforts[:-1]

    def curves(quantity: Quantity) -> Iterator[Series]:
        for way in plan.ways:
            runs = [results.evaluations[plan.tried(way, effort)] for effort in lesser]
            converged = results.splits[way.name, quantity.key].converged
            yield Series(
                label=way.name,
                kind=_kind(plan, way),
                x=np.arange(float(len(lesser))),
                y=_off([quantity.of_run(e) for e in runs], converged),
                mark="points",
            )

    seen = (
        f"Each mark is how far the engine, at {plan.at_probe}, is from itself "
        "with its solver converged. Efforts without a mark are equal to it in every digit."
    )
    names = tuple(effort.name for effort in lesser)
    x_label = "effort of the solver"
    return _figure(plan, "solver", "Solver error", x_label, curves, seen=seen, names=names)


def _ensemble_figure(results: ThreeErrors) -> Figure:
    """Return how far slightly perturbed releases spread."""
    plan = results.plan

    def curves(quantity: Quantity) -> Iterator[Series]:
        own = [results.spreads[quantity.key, size] for size in SIZES]
        engine = f"{plan.engine}, {plan.profile}, {plan.probe_words}"
        for label, kind, values in (
            ("exact motion", "reference", [s.of_truth for s in own]),
            (engine, plan.engine, [s.of_engine for s in own]),
        ):
            y = _off(values, 0.0)
            yield Series(label=label, kind=kind, x=np.array(SIZES), y=y, mark="both")

    seen = (
        "How far releases spread that differ by so little. A discrepancy smaller than that cannot "
        "be told from a release known no better; where the engine lies above the exact motion, it "
        "is itself not smooth at this size."
    )
    x_label = "relative size of the perturbation"
    return _figure(plan, "ensemble", "What is not decidable", x_label, curves, seen=seen)


def _kind(plan: ErrorsPlan, way: Way) -> str:
    """Return the kind of the curves of a way, which decides their colour."""
    return plan.engine if way is plan.ways[0] else f"{plan.engine}, {way.name}"


def _off(values: Sequence[Number], level: Number) -> Floats:
    """Return magnitudes of differences, NaN where unknown or zero: no place on a log axis."""
    differences = [less(value, level) for value in values]
    return np.array([abs(difference) if difference else math.nan for difference in differences])
