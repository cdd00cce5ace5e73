"""The stability study: where an engine stops being usable, how it fails, and how the truth fares.

Engines run a map, a grid of timesteps for each hard case, and then rounds of a search for the
largest usable timestep; the reference is solved in two ways on the same cases and on random ones.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from harness.core.case import Case
from harness.core.report_model import Artefact, Column, Table, table_of
from harness.evaluation.case_cache import case_key, case_metadata
from harness.evaluation.evaluate import check_case, evaluate_case, failed_evaluation
from harness.execution.cache import CacheFolder
from harness.execution.cache_entry import Metadata, checksum
from harness.execution.tasks import ResultCache
from harness.execution.worker import LostTaskError
from harness.studies.shared.run_columns import ENGINE, OUTCOME, run_cells, without
from harness.studies.stability.classify import classify
from harness.studies.stability.failure_criteria import ClassifiedRun
from harness.studies.stability.limits import TimestepLimit, by_scene, limits, next_round
from harness.studies.stability.report import engine_page, limit_figure, map_figures, summary
from harness.studies.stability.suite import Suite, random_scenes, scenes, stability_cases
from harness.studies.stability.survey import ALLOWED, ReferenceCheck, examine
from harness.studies.study import Job, Results, Work, case_record
from models.catalogue import load
from models.effects import IDEAL
from models.scene import Scene

_SHARE = 100
"""Random scenes in a task: one takes some 50 ms."""

Part = tuple[Scene, ...]
"""Scenes that are examined in one task."""


def classified_cache(store: CacheFolder) -> ResultCache[Case, ClassifiedRun]:
    """Return where the verdicts on runs are kept."""
    return ResultCache(
        store=store,
        kind="verdicts",
        key=lambda case: case_key(case, classify.__module__),
        metadata=lambda case: case_metadata(case, classify.__module__),
    )


def reference_check_cache(store: CacheFolder) -> ResultCache[Part, list[ReferenceCheck]]:
    """Return where it is kept how the reference fares on scenes."""
    module = examine.__module__

    def case(part: Part) -> Case:  # of the reference, which carries no effects
        return Case(scene=replace(part[0], effects=IDEAL), engine="reference")

    def key(part: Part) -> str:
        texts = [case_key(case(part), module), *(str(scene.to_dict()) for scene in part)]
        return checksum("\n".join(texts).encode())[:32]

    def metadata(part: Part) -> Metadata:
        label = f"the reference on {len(part)} scenes from {part[0].name}"
        own = case_metadata(case(part), module)
        return replace(own, label=label, command="rockingcan stability")

    return ResultCache(store=store, kind="findings", key=key, metadata=metadata)


def _classified(case: Case) -> ClassifiedRun:
    return classify(evaluate_case(case))


def _lost(case: Case, error: LostTaskError) -> ClassifiedRun:
    return classify(failed_evaluation(case, error))


def _examined(part: Part) -> list[ReferenceCheck]:
    return [examine(scene) for scene in part]


def _unexamined(part: Part, error: LostTaskError) -> list[ReferenceCheck]:
    return [ReferenceCheck(scene=scene.name, failure=error.reason) for scene in part]


CLASSIFYING: Work[Case, ClassifiedRun] = Work(
    name="hard cases",
    call=_classified,
    lost=_lost,
    label=Case.label,
    cache=classified_cache,
    check=check_case,
    manifest=lambda _, run: case_record(run.simulation) | {"verdict": run.verdict.value},
)
"""Run a case and say how it went, without its motion, so that thousands can be kept."""

EXAMINING: Work[Part, list[ReferenceCheck]] = Work(
    name="the reference",
    call=_examined,
    lost=_unexamined,
    label=lambda part: f"{len(part)} scenes from {part[0].name}",
    cache=reference_check_cache,
    effort=lambda part: float(len(part)),
)
"""Solve scenes in two ways, and compare."""


@dataclass(frozen=True, slots=True, kw_only=True)
class StabilityStudy:
    """Run hard cases until engines fail.

    Parameters
    ----------
    suite : Suite
        One of `harness.studies.stability.suite.SUITES`.
    engines : tuple of str
        That take timesteps.
    """

    suite: Suite
    engines: tuple[str, ...]

    @property
    def name(self) -> str:
        """Title of the study."""
        return f"stability, {self.suite.name} suite"

    def next_jobs(self, done: Results) -> list[Job[Any, Any]]:
        """Return the map and the scenes of the reference, and what the searches want next."""
        runs = list(done.of(CLASSIFYING).values())
        if runs:
            further = next_round(self.suite, self.engines, by_scene(runs))
            return [Job(CLASSIFYING, case) for case in further]
        cases = stability_cases(self.suite, self.engines)
        return [
            *(Job(CLASSIFYING, case) for case in cases),
            *(Job(EXAMINING, part) for parts in self._parts() for part in parts),
        ]

    def _parts(self) -> tuple[list[Part], list[Part]]:
        """Return the hard cases and the random scenes in parts of one task each."""
        drawn = tuple(random_scenes(self.suite.random_scenes))
        hard, random = (
            [chosen[start : start + _SHARE] for start in range(0, len(chosen), _SHARE)]
            for chosen in (scenes(self.suite), drawn)
        )
        return hard, random

    def checks(self, done: Results) -> tuple[list[ReferenceCheck], list[ReferenceCheck]]:
        """Return how the reference fares on the hard cases and on random scenes."""
        found = done.of(EXAMINING)
        hard, random = ([check for part in own for check in found[part]] for own in self._parts())
        return hard, random

    def report(self, done: Results) -> tuple[Artefact, ...]:
        """Return words, maps and tables."""
        runs, names = list(done.of(CLASSIFYING).values()), self.suite.scenes
        largest = limits(self.suite, self.engines, by_scene(runs))
        hard, random = self.checks(done)
        on_grid = [run for run in runs if run.case.timestep in {None, *self.suite.timesteps}]
        return (
            summary(runs, hard, random),
            *(engine_page(engine, on_grid, largest, names) for engine in self.engines),
            *map_figures(on_grid, names),
            limit_figure(largest, names),
            _limit_table(largest),
            table_of("hard-cases", "The hard cases, and the reference on each", _CASES, hard),
            _survey_table(random),
            _run_table(runs),
        )


_RUNS = (
    Column("scene", "Name of the hard case, or of a release perturbed from it."),
    ENGINE,
    Column("profile", "default: as it ships; matched: as the scene declares; adaptive: own steps."),
    Column("timestep_s", "Timestep of the engine; the largest of an adaptive run."),
    Column("verdict", "How the run went, by the criteria of the study."),
    Column("number", "The number behind the verdict."),
    Column("number_is", "What the number is."),
    Column("time_s", "When it was seen first, or was largest."),
    OUTCOME,
    Column("steps", "Timesteps taken."),
    Column("case", "Digest of the case; its command is in the list of cases."),
)


def _run_table(runs: Sequence[ClassifiedRun]) -> Table:
    """Return every run and its verdict."""
    rows = [
        run_cells(run.simulation)
        | {
            "verdict": run.verdict.value,
            "number": run.symptom.number,
            "number_is": run.symptom.words,
            "time_s": run.symptom.time,
            "outcome": run.simulation.outcome.value.partition(":")[0],
        }
        for run in runs
    ]
    return table_of("verdicts", "Every run and its verdict", without(_RUNS, "outcome"), rows)


_LIMITS = (
    Column("scene", "Name of the hard case."),
    Column("engine", "Name of the engine, profile matched."),
    Column("accurate_timestep_s", "Largest that follows the exact motion, median of releases."),
    Column("accurate_spread", "Largest over smallest of the releases; empty if some have none."),
    Column("accurate_releases", "Of how many releases some timestep is accurate."),
    Column("sound_timestep_s", "Largest timestep at which nothing fails, median of releases."),
    Column("sound_spread", "Largest over smallest of the releases; empty if some have none."),
    Column("sound_releases", "Of how many releases some timestep is sound."),
    Column("finest_s", "Finest timestep that was tried."),
    Column("coarsest_s", "Coarsest timestep tried: a limit that equals it may lie beyond."),
)


def _limit_table(largest: Sequence[TimestepLimit]) -> Table:
    """Return the largest usable timesteps, a row a case and engine."""
    rows: dict[tuple[str, str], dict[str, object]] = {}
    for limit in largest:
        row = rows.setdefault((limit.scene, limit.engine), {})
        row |= {
            "scene": limit.scene,
            "engine": limit.engine,
            f"{limit.standard}_timestep_s": limit.middle,
            f"{limit.standard}_spread": limit.spread,
            f"{limit.standard}_releases": len(limit.known),
            "finest_s": limit.finest,
            "coarsest_s": limit.coarsest,
        }
    title = "The largest usable timestep"
    return table_of("largest-timesteps", title, _LIMITS, rows.values())


def _reference(check: ReferenceCheck) -> str:
    """Return what the reference makes of a scene."""
    solved = f"refused: {check.refusal}" if check.refusal else f"solved: {check.outcome}"
    return check.failure or solved


_CASES = (
    Column("scene", "Name of the hard case."),
    Column(
        "why",
        "Why it is hard, and where it comes from.",
        lambda check: load(check.scene).cite.removeprefix("Hard because "),
    ),
    Column("reference", "What the reference makes of it.", _reference),
    Column(
        "disagreement",
        "Largest relative difference of formula and integration.",
        lambda check: math.nan if check.refusal else check.disagreement,
    ),
    Column(
        "energy_error",
        "Largest change of energy over what the can has to spend.",
        lambda check: math.nan if check.refusal else check.energy_error,
    ),
    Column(
        "evaluations",
        "Evaluations of the equations that the integration needed.",
        lambda check: None if check.refusal else check.evaluations,
    ),
)

_SURVEY = (
    Column("ends", "How the motion ends."),
    Column("scenes", "How many random scenes."),
    Column("failures", "How many of them failed."),
    Column("ill_conditioned", "In how many one ulp of the input does more than 1e-9: refused."),
    Column("largest_disagreement", "Of formula and integration, relative."),
    Column("largest_energy_error", "Over what the can has to spend."),
    Column("most_evaluations", "Of the equations, in one bounce."),
)


def _survey_table(checks: Iterable[ReferenceCheck]) -> Table:
    """Return how the reference fared on random scenes, by how they end."""
    groups: dict[str, list[ReferenceCheck]] = {}
    for check in checks:
        ends = "refused" if check.refusal else check.outcome or "crash"
        groups.setdefault(ends, []).append(check)
    rows: list[Mapping[str, object]] = [
        {
            "ends": ends,
            "scenes": len(group),
            "failures": sum(bool(check.failure) for check in group),
            "ill_conditioned": sum(check.conditioning > ALLOWED for check in group),
            "largest_disagreement": max(
                (c.disagreement for c in group if c.conditioning <= ALLOWED), default=math.nan
            ),
            "largest_energy_error": max(check.energy_error for check in group),
            "most_evaluations": max(check.evaluations for check in group),
        }
        for ends, group in sorted(groups.items())
    ]
    return table_of("random-scenes", "The reference on random scenes", _SURVEY, rows)
