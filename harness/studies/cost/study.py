"""The study of cost as jobs: error runs first, then times alone of what came back."""

from dataclasses import dataclass, replace
from typing import Any

from harness.core.case import Case
from harness.core.report_model import Artefact
from harness.core.simulation import Outcome
from harness.engines.base import features_of
from harness.engines.registry import engine, export_settings
from harness.evaluation.case_record import LOST, lost_errors, measured
from harness.evaluation.evaluate import check_case
from harness.evaluation.evaluation import Record
from harness.evaluation.timing import aloft, overhead, untimed
from harness.studies.cost.design import CostPlan, expected
from harness.studies.cost.prices import CHOICES, Cost, cost, hard_command
from harness.studies.cost.report import cost_report
from harness.studies.cost.tables import price_rows
from harness.studies.study import TIMING, Job, Results, Work, record_cache


def _manifest(case: Case, record: Record) -> Record:
    """Return the entry of a run in the manifest."""
    return {
        "digest": case.digest(record["version"]),
        "label": case.label(),
        "command": record["command"],
        "engine": case.engine,
        "engine_version": record["version"],
        "outcome": Outcome[record["outcome"]].value,
    }


MEASURING: Work[Case, Record] = Work(
    name="errors",
    call=measured,
    lost=lost_errors,
    label=Case.label,
    cache=record_cache("errors", measured.__module__),
    check=check_case,
    effort=expected,
    manifest=_manifest,
)
"""Run a case and keep its errors and counts: the motion itself is not kept."""

HARD_MEASURING: Work[Case, Record] = replace(
    MEASURING,
    manifest=lambda case, record: _manifest(case, record | {"command": hard_command(case)}),
)
"""The same of a scene that the study makes: its command names a scene file beside the report."""

TIMING_BY_LENGTH: Work[Case, Record] = replace(TIMING, effort=expected)
"""Time a case alone, the longest first."""

OVERHEAD: Work[Case, Record] = Work(
    name="overhead",
    call=overhead,
    lost=lambda case, error: {"ways": {}},  # noqa: ARG005 - one that does not come back has none
    label=Case.label,
    alone=True,
)
"""Time a step of one free body."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CostStudy:
    """Price every setting of every engine, tuned on another scene than the one scored.

    Parameters
    ----------
    plan : CostPlan
        From `harness.studies.cost.design.plan_cost`.
    """

    plan: CostPlan

    @property
    def name(self) -> str:
        """Title of the study."""
        return f"what accuracy costs: {self.plan.scene.name}"

    def next_jobs(self, done: Results) -> list[Job[Case, Record]]:
        """Return the error runs; then the timing of those that came back, and of steps aloft."""
        hard = frozenset(self.plan.hard_cases())
        jobs = [
            Job(HARD_MEASURING if case in hard else MEASURING, case) for case in self.plan.cases()
        ]
        errors = self._errors(done)
        if errors:
            timed = self.plan.timed_cases()
            jobs += [Job(TIMING_BY_LENGTH, c) for c in timed if errors[c]["outcome"] not in LOST]
            jobs += [Job(OVERHEAD, case) for case in self._overhead_cases().values()]
        return jobs

    def _errors(self, done: Results) -> dict[Case, Record]:
        return done.of(MEASURING) | done.of(HARD_MEASURING)

    def _overhead_cases(self) -> dict[str, Case]:
        """Return by engine the case whose world is stepped aloft, of engines that open one."""
        return {
            name: aloft(self.plan.scene, name)
            for name in self.plan.engines
            if features_of(engine(name)).open is not None
        }

    def findings(self, done: Results) -> Cost:
        """Return every point with its price."""
        times, overheads = done.of(TIMING_BY_LENGTH), done.of(OVERHEAD)
        return cost(
            self.plan,
            self._errors(done),
            {case: times.get(case, untimed(case)) for case in self.plan.timed_cases()},
            {name: overheads[case] for name, case in self._overhead_cases().items()},
        )

    def report(self, done: Results) -> tuple[Artefact, ...]:
        """Return words, the fairness contract, figures and tables."""
        return cost_report(self.findings(done))

    def answer(self, found: Cost, targets: tuple[float, ...]) -> dict[str, Any]:
        """Return the price list as `--json` prints it."""

        def paste(row: dict[str, Any]) -> str | None:
            price = found.price(row["engine"], row["choice"], row["target_deg"])
            return export_settings(price.winners[0].point.case) if price.winners else None

        return {
            "scene": self.plan.scene.name,
            "tuned_on": self.plan.tuning_scene.name,
            "tuned": {f"{name}, {choice}": own for (name, choice), own in found.tuned.items()},
            "prices": [
                row | {"paste": paste(row)}
                for choice in CHOICES
                for target in targets
                for row in price_rows(found, choice, target)
            ],
        }
