"""The study of three errors: model form, discretisation and solver, told apart and never mixed."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from harness.core.case import Case
from harness.core.report_model import Artefact, Column, Prose, Table, rows_of, table_of
from harness.evaluation.evaluation import Evaluation
from harness.metrics.quantities import QUANTITIES, Number, Quantity
from harness.studies.errors.extrapolation import limit
from harness.studies.errors.figures import effort_figure, ensemble_figure, ladder_figure
from harness.studies.errors.plan import ErrorsPlan, Way
from harness.studies.errors.split import ErrorStatus, Split, Spread, less, spread
from harness.studies.shared.perturbation import MEMBERS, SIZES
from harness.studies.shared.run_columns import (
    CASE,
    COMMAND,
    ENGINE,
    OUTCOME,
    SCENE,
    TIMESTEP,
    run_cells,
    without,
)
from harness.studies.study import EVALUATION, Job, Results, evaluation_jobs

_OF_THE_BOUNCE = ("turn_deg", "bounce_time_s", "phi_min_rad", "peak_friction_ratio")
_OF_THE_END = ("psi_end_deg", "phi_end_deg")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ThreeErrors:
    """A plan with its evaluations and what they say.

    Parameters
    ----------
    plan : ErrorsPlan
    evaluations : mapping of Case to Evaluation
    spreads : mapping of (str, float) to Spread
        By quantity and relative size of the perturbations.
    splits : mapping of (str, str) to Split
        By way and quantity.
    """

    plan: ErrorsPlan
    evaluations: Mapping[Case, Evaluation]
    spreads: Mapping[tuple[str, float], Spread]
    splits: Mapping[tuple[str, str], Split]

    @property
    def sentences(self) -> tuple[str, ...]:
        """A sentence or two a way, and one on what is not decidable."""
        plan = self.plan
        for quantity in quantities(plan):
            splits = {way.name: self.splits[way.name, quantity.key] for way in plan.ways}
            if all(split.total is not None for split in splits.values()):
                told = [_way(plan, name, quantity, split) for name, split in splits.items()]
                return (*(one for pair in told for one in pair), self._undecidable(quantity))
        nothing = (
            f"{plan.engine} completes no motion of {plan.scene.name} at {plan.probe:.2g} s that "
            "could be compared, so that its errors cannot be told apart."
        )
        return (nothing,)

    def _undecidable(self, quantity: Quantity) -> str:
        """Return how far releases spread that no one can tell apart."""
        small, large = (self.spreads[quantity.key, size] for size in (SIZES[0], SIZES[-1]))
        return (
            f"Releases that differ by {SIZES[-1]:.0e} spread the {quantity.label} by "
            f"{_amount(quantity, large.of_truth, sign=False)} in the exact motion and by "
            f"{_amount(quantity, large.of_engine, sign=False)} in the engine (by "
            f"{_amount(quantity, small.of_truth, sign=False)} and "
            f"{_amount(quantity, small.of_engine, sign=False)} for {SIZES[0]:.0e}): a discrepancy "
            "smaller than that is not decidable."
        )

    def artefacts(self) -> tuple[Artefact, ...]:
        """Return words, figures, tables."""
        plan, known = self.plan, quantities(self.plan)
        figures = (
            ladder_figure(plan, self.evaluations, self.splits, known),
            effort_figure(plan, self.evaluations, known),
            ensemble_figure(plan, self.spreads, known),
        )
        return (
            Prose(
                name=f"{plan.scene.name}-{plan.engine}-three-errors",
                title=f"Three errors of {plan.engine}, never mixed",
                text=" ".join(self.sentences),
                scene=plan.scene.name,
            ),
            *(figure for figure in figures if figure is not None),
            self._table("split", "Three errors, never mixed", _SPLIT, self.splits.values()),
            self._table("ladder", "Every rung of the ladders", _LADDER, self._ladder_rows()),
            self._table("efforts", "The solver at several efforts", _EFFORTS, self._effort_rows()),
            self._table("spreads", "What is not decidable", _ENSEMBLE, self._ensemble_rows()),
        )

    def _table(
        self, name: str, title: str, columns: tuple[Column, ...], records: Iterable[object]
    ) -> Table:
        plan = self.plan
        return table_of(
            f"{plan.scene.name}-{plan.engine}-{plan.profile}-{name}",
            f"{title}: {plan.engine}, {plan.profile}",
            without(columns, "scene", "engine", "profile"),
            records,
            scene=plan.scene.name,
        )

    def _ways_and_quantities(self) -> list[tuple[Way, Quantity]]:
        return [(way, quantity) for way in self.plan.ways for quantity in quantities(self.plan)]

    def _run(self, case: Case, way: Way, quantity: Quantity) -> dict[str, Any]:
        """Return the cells of a run that is read for one quantity."""
        e = self.evaluations[case]
        own = {"way": way.name, "quantity": quantity.key, "value": quantity.of_run(e)}
        return run_cells(e.simulation) | own | {"timestep_s": case.timestep}

    def _ladder_rows(self) -> list[dict[str, Any]]:
        """Return every rung of every ladder."""
        rows = []
        for way, quantity in self._ways_and_quantities():
            found = self.splits[way.name, quantity.key]
            for step in self.plan.timesteps:
                row = self._run(self.plan.on_ladder(way, step), way, quantity)
                row["off_true"] = less(row["value"], found.true)
                row["off_limit"] = less(row["value"], found.limit_value)
                rows.append(row)
        return rows

    def _effort_rows(self) -> list[dict[str, Any]]:
        """Return the solver at every effort, at one timestep."""
        plan, rows = self.plan, []
        for way, quantity in self._ways_and_quantities():
            converged = quantity.of_run(self.evaluations[plan.on_ladder(way, plan.probe)])
            for effort in (None, *plan.efforts):
                row = self._run(plan.tried(way, effort), way, quantity)
                row["effort"] = "as set" if effort is None else effort.name
                row["off_converged"] = less(row["value"], converged) if plan.efforts else None
                rows.append(row)
        return rows

    def _ensemble_rows(self) -> list[dict[str, Any]]:
        """Return how far perturbed releases spread."""
        plan = self.plan
        return [
            {
                "scene": plan.scene.name,
                "engine": plan.engine,
                "profile": plan.profile,
                "quantity": key,
                "timestep_s": plan.probe,
                "relative_size": size,
                "spread_of_engine": found.of_engine,
                "spread_of_truth": found.of_truth,
                "spread_of_error": found.of_error,
                "members": found.members,
            }
            for (key, size), found in self.spreads.items()
        ]


_PROFILE = Column("profile", "Where the settings start from.")
_HEAD = (SCENE, ENGINE, _PROFILE)
_WAY = Column("way", "How the timestep is shrunk.")
_QUANTITY = Column("quantity", "Which number; the unit is its suffix.")

_SPLIT = (
    Column("scene", SCENE.meaning, "case.scene.name"),
    Column("engine", ENGINE.meaning, "case.engine"),
    Column("profile", _PROFILE.meaning, "case.profile"),
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
    Column("observed_order", "Order at which the limit is approached.", "limit.order"),
    Column("order_spread", "Half the range of the last observed orders.", "limit.spread"),
    Column("not_decidable_within", "Spread of releases that differ by 1e-6.", "band"),
    Column(
        "verdict",
        "undecidable: the total is within that band; no model error seen: model form is within "
        "band and uncertainty; model error: it stands out.",
        "verdict.value",
    ),
    Column("command", COMMAND.meaning, lambda split: split.case.command()),
)

_LADDER = (
    *_HEAD,
    _WAY,
    _QUANTITY,
    TIMESTEP,
    Column("value", "Of the engine, solver converged."),
    Column("off_true", "Value less that of the exact motion."),
    Column("off_limit", "Value less the engine's own limit: discretisation."),
    OUTCOME,
    CASE,
    COMMAND,
)

_EFFORTS = (
    *_HEAD,
    _WAY,
    _QUANTITY,
    TIMESTEP,
    Column("effort", "How hard the solver tries."),
    Column("value", "Of the engine."),
    Column("off_converged", "Value less that with the solver converged."),
    OUTCOME,
    CASE,
    COMMAND,
)

_ENSEMBLE = (
    *_HEAD,
    _QUANTITY,
    TIMESTEP,
    Column("relative_size", "Of the perturbations of phi, psi' and theta' at release."),
    Column("spread_of_engine", "Largest departure from that of the exact release."),
    Column("spread_of_truth", "The same of the exact motion."),
    Column("spread_of_error", "The same of engine minus truth."),
    Column("members", "Perturbed releases that it rests on."),
)


def quantities(plan: ErrorsPlan) -> tuple[Quantity, ...]:
    """Return the numbers of a run that have a limit: of its first bounce, or of its end."""
    keys = _OF_THE_BOUNCE if plan.scene.horizon.seconds is None else _OF_THE_END
    return tuple(QUANTITIES[key] for key in keys)


_VERDICTS = {
    ErrorStatus.MODEL_ERROR: "However small the timestep, this is another can: {}.",
    ErrorStatus.NO_MODEL_ERROR: "For a timestep of zero no model error is seen; {}.",
    ErrorStatus.UNDECIDABLE: "That is less than releases spread that differ by 1e-6; {}.",
    ErrorStatus.UNKNOWN: "Its limit is not known.",
}


def _way(plan: ErrorsPlan, name: str, quantity: Quantity, found: Split) -> tuple[str, str]:
    """Return the three errors on one way, and what they come to."""
    known, approach = "", "no order is seen on the way to its limit"
    if found.limit is not None:
        known = f" (known to {_amount(quantity, found.limit.uncertainty, sign=False)})"
        if found.limit.order is not None:
            approach = f"it approaches its limit with order {found.limit.order:.2f}"
            if found.limit.spread is not None:
                approach += f", give or take {found.limit.spread:.2f}"
    opening = (
        f"{plan.engine}, {name}, at a timestep of {plan.probe:.2g} s: the {quantity.label} of "
        f"{plan.scene.name} is off by {_amount(quantity, found.total)}, of which "
        f"model form {_amount(quantity, found.model_form)}{known}, "
        f"discretisation {_amount(quantity, found.discretisation)}, "
        f"solver {_amount(quantity, found.solver)}."
    )
    return opening, _VERDICTS[found.verdict].format(approach)


def _amount(quantity: Quantity, value: Number, *, sign: bool = True) -> str:
    if value is None:
        return "an unknown amount"
    number = f"{value:+.2g}" if sign else f"{value:.2g}"
    return f"{number} {quantity.unit}".rstrip()


@dataclass(frozen=True, slots=True, kw_only=True)
class ErrorsStudy:
    """Run ladders, efforts and an ensemble, and tell the three errors apart.

    Parameters
    ----------
    plan : ErrorsPlan
        From `harness.studies.errors.plan.plan_errors`.
    """

    plan: ErrorsPlan

    name = "three errors"

    def next_jobs(self, done: Results) -> list[Job[Case, Evaluation]]:
        """Return the cases of the plan."""
        del done
        return evaluation_jobs(self.plan.cases())

    def findings(self, done: Results) -> ThreeErrors:
        """Return the three errors of every quantity on every way."""
        plan, runs, known = self.plan, done.of(EVALUATION), quantities(self.plan)

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
                ladder = [q.of_run(runs[plan.on_ladder(way, step)]) for step in plan.timesteps]
                value, true = values(plan.tried(way, None), q)
                # releases that differ by no more than a few roundings show what of it is noise
                noise = spreads[q.key, SIZES[0]].of_error or 0.0
                splits[way.name, q.key] = Split(
                    case=plan.tried(way, None),
                    way=way.name,
                    quantity=q.key,
                    true=true,
                    value=value,
                    converged=q.of_run(runs[plan.on_ladder(way, plan.probe)]),
                    limit=limit(plan.timesteps, ladder, noise=noise),
                    band=spreads[q.key, SIZES[-1]].band,
                )
        evaluations = {case: runs[case] for case in plan.cases()}
        return ThreeErrors(plan=plan, evaluations=evaluations, spreads=spreads, splits=splits)

    def report(self, done: Results) -> tuple[Artefact, ...]:
        """Return words, figures and tables."""
        return self.findings(done).artefacts()

    def answer(self, done: Results) -> dict[str, Any]:
        """Return the three errors as `--json` prints them."""
        found = self.findings(done)
        left_out = ("scene", "engine", "profile", "timestep_s", "order_spread", "command")
        return {
            "scene": self.plan.scene.name,
            "engine": self.plan.engine,
            "profile": self.plan.profile,
            "timestep_s": self.plan.probe,
            "ladder_s": list(self.plan.timesteps),
            "errors": [
                {key: value for key, value in row.items() if key not in left_out}
                for row in rows_of(_SPLIT, found.splits.values())
            ],
            "sentences": list(found.sentences),
        }
