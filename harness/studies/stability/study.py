"""The stability study: where an engine stops being usable, how it fails, and how the truth fares.

Engines run a map, a grid of timesteps for each hard case, and then rounds of a search for the
largest usable timestep; the reference is solved in two ways on the same cases and on random ones.
The report has a summary, one page an engine, the map, and a table of every run.
"""

import math
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from operator import attrgetter
from typing import Any

from harness.core.case import Case
from harness.core.report_model import Artefact, Column, Prose, Table, table_of
from harness.engines.ladder import finer_by, rung_of, rungs, spelled, takes_timestep
from harness.engines.registry import missing_effects
from harness.evaluation.effort import engine_group, expected_seconds
from harness.evaluation.evaluate import check_case, evaluate_case
from harness.evaluation.run_cases import failed_evaluation
from harness.execution.worker import LostTaskError
from harness.studies.shared import run_columns
from harness.studies.stability.failure_criteria import (
    MEANINGS,
    SOUND,
    ClassifiedRun,
    StabilityStatus,
    Symptom,
    classify,
)
from harness.studies.stability.limits import (
    TimestepLimit,
    by_scene,
    foreseen_cases,
    limit_figures,
    limit_sentence,
    limit_table,
    limits,
    next_round,
)
from harness.studies.stability.maps import map_figures
from harness.studies.stability.suite import Suite, random_scenes, scenes, stability_cases
from harness.studies.stability.survey import (
    EXAMINING,
    Part,
    ReferenceCheck,
    case_table,
    survey_table,
)
from harness.studies.study import Job, Results, Work, case_record, record_cache
from models.catalogue import load

classified_cache = record_cache("verdicts", classify.__module__)
"""Returns the cache of the verdicts on runs."""


def _classified(case: Case) -> ClassifiedRun:
    return classify(evaluate_case(case))


def _lost(case: Case, error: LostTaskError) -> ClassifiedRun:
    return classify(failed_evaluation(case, error))


CLASSIFYING: Work[Case, ClassifiedRun] = Work(
    name="hard cases",
    call=_classified,
    lost=_lost,
    label=Case.label,
    cache=classified_cache,
    check=check_case,
    effort=expected_seconds,
    group=engine_group,
    about=attrgetter("scene"),
    manifest=lambda _, run: case_record(run.simulation) | {"verdict": run.verdict.value},
)
"""Run a case and classify it, without its motion, so that thousands of results fit into a cache."""

_SHARE = 100
"""Random scenes in a task; a scene takes about 50 ms."""


@dataclass(frozen=True, slots=True, kw_only=True)
class StabilityStudy:
    """Run hard cases until engines fail.

    Parameters
    ----------
    suite : Suite
        One of `harness.studies.stability.suite.SUITES`.
    engines : tuple of str
    """

    suite: Suite
    engines: tuple[str, ...]

    @property
    def name(self) -> str:
        """Title of the study."""
        return f"stability, {self.suite.name} suite"

    def next_jobs(self, done: Results) -> list[Job[Any, Any]]:
        """Return the map and the scenes of the reference; then the next round of the searches."""
        runs = list(done.of(CLASSIFYING).values())
        if runs:
            further = next_round(self.suite, self.engines, by_scene(runs))
            return [Job(CLASSIFYING, case) for case in further]
        cases = stability_cases(self.suite, self.engines)
        return [
            *(Job(CLASSIFYING, case) for case in cases),
            *(Job(EXAMINING, part) for parts in self._parts() for part in parts),
        ]

    def foreseen(self, done: Results) -> list[Job[Any, Any]]:
        """Return what the searches will want after the next round, as far as it can be told."""
        known = by_scene(list(done.of(CLASSIFYING).values()))
        return [Job(CLASSIFYING, c) for c in foreseen_cases(self.suite, self.engines, known)]

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
        examined = done.of(EXAMINING)
        hard, random = (
            [check for part in own for check in examined[part]] for own in self._parts()
        )
        return hard, random

    def _rungs(self, engine: str) -> tuple[float, ...]:
        """Return the timesteps of the map, s, or the accuracies in their place."""
        return rungs(engine, self.suite.timesteps)

    def report(self, done: Results) -> tuple[Artefact, ...]:
        """Return words, maps and tables."""
        runs = list(done.of(CLASSIFYING).values())
        hard, random = self.checks(done)
        largest = limits(self.suite, self.engines, by_scene(runs))
        names = self.suite.scenes
        grid = {None, *(each for name in self.engines for each in self._rungs(name))}
        on_grid = [run for run in runs if rung_of(run.case) in grid]
        return (
            summary(runs, hard, random),
            *(engine_page(engine, on_grid, largest, names) for engine in self.engines),
            *map_figures(on_grid, names),
            *limit_figures(largest, names),
            limit_table(largest),
            count_table([run for run in on_grid if run.case.scene.name in names]),
            case_table(hard),
            survey_table(random),
            table_of(
                "verdicts", "Every run and its verdict", run_columns.without(_RUNS, "outcome"), runs
            ),
        )


_PROFILES = (
    ("default", "As it ships"),
    ("matched", "Matched to the scene"),
    ("adaptive", "With steps that follow the motion"),
)


_COUNTS = (
    Column("engine", "Name of the engine."),
    Column("profile", "Which settings."),
    Column("verdict", "How the runs went."),
    Column("runs", "How many runs of hard cases in this profile on the grid of timesteps."),
)


def count_table(judged: Sequence[ClassifiedRun]) -> Table:
    """Return how many runs of each engine and profile have each verdict, good verdicts first."""
    counts = Counter((run.verdict, run.case.profile, run.case.engine) for run in judged)
    rows = [
        {"engine": engine, "profile": profile, "verdict": verdict.value, "runs": runs}
        for engine in sorted({run.case.engine for run in judged})
        for profile, _ in _PROFILES
        for verdict in StabilityStatus
        if (runs := counts[verdict, profile, engine])
    ]
    return table_of("verdict-counts", "How many runs have each verdict", _COUNTS, rows)


_VERBS = {StabilityStatus.UNRESOLVED: "is unresolved", StabilityStatus.REFUSED: "is refused"}
"""What an engine is said to do where the verdict is no verb."""

_UNITS = {"rad", "m/s", "s"}
"""Units in which the words of a symptom may end."""


def summary(
    judged: Sequence[ClassifiedRun],
    hard: Sequence[ReferenceCheck],
    random: Sequence[ReferenceCheck],
) -> Prose:
    """Return the summary: counts, and how the reference fared."""
    engines = dict.fromkeys(run.case.engine for run in judged)
    solved = sum(not finding.failure and not finding.refusal for finding in hard)
    refused = sum(bool(finding.refusal) for finding in hard)
    failed = [finding for finding in hard if finding.failure]
    unsure = sum(bool(finding.refusal) for finding in random)
    wrong = sum(bool(finding.failure) for finding in random)
    sentences = [
        f"{len(judged)} runs of {' and '.join(engines)} over {len(hard)} hard cases were judged.",
        (
            f"The reference solves {solved} of the hard cases to 1e-9 in two ways that agree, and "
            f"refuses {refused} with a sentence."
        ),
        *(f"It fails on {finding.scene}: {finding.failure}." for finding in failed),
        f"Of {len(random)} random scenes it refuses {unsure} and fails on {wrong}.",
    ]
    meanings = "; ".join(f"{verdict.value}: {MEANINGS[verdict]}" for verdict in StabilityStatus)
    text = " ".join(sentences) + f"\n\nThe verdicts are {meanings}."
    return Prose(name="summary", title="Hard cases stay numerically stable", text=text)


def engine_page(
    engine: str,
    judged: Sequence[ClassifiedRun],
    limits: Sequence[TimestepLimit],
    names: Sequence[str],
) -> Prose:
    """Return the one-page verdict on an engine.

    Parameters
    ----------
    engine : str
    judged : sequence of ClassifiedRun
        Of the map.
    limits : sequence of TimestepLimit
    names : sequence of str
        Of the hard cases.
    """
    own = [run for run in judged if run.case.engine == engine and run.case.scene.name in names]
    paragraphs = [
        *(_counted(runs, words) for profile, words in _PROFILES if (runs := _of(own, profile))),
        limit_sentence([limit for limit in limits if limit.engine == engine]),
        " ".join(_cures(own, names)),
        *_left_out(engine, names),
    ]
    return Prose(
        name=f"verdict-{engine}", title=f"The verdict on {engine}", text="\n\n".join(paragraphs)
    )


def _left_out(engine: str, names: Sequence[str]) -> Iterator[str]:
    """Yield a sentence on the hard cases that an engine cannot represent, if there are any."""
    lacking = {name: missing_effects(engine, load(name)) for name in names}
    if cases := [f"{name} ({', '.join(effects)})" for name, effects in lacking.items() if effects]:
        yield f"Left out is what it cannot represent: {'; '.join(cases)}."


def _of(own: Sequence[ClassifiedRun], profile: str) -> list[ClassifiedRun]:
    """Return the runs of a profile."""
    return [run for run in own if run.case.profile == profile]


def _counted(runs: Sequence[ClassifiedRun], words: str) -> str:
    """Return how the runs of a profile went, and an example of each failure."""
    by_verdict = {v: [run for run in runs if run.verdict is v] for v in StabilityStatus}
    counts = ", ".join(f"{v.value} {len(group)}" for v, group in by_verdict.items() if group)
    examples = []
    for verdict, group in by_verdict.items():
        if group and verdict not in SOUND:
            # at the finest timestep at which it happens, where it is least to be expected
            run = min(group, key=lambda run: run.rung)
            of = "a timestep of " if takes_timestep(run.case.engine) else ""
            examples.append(
                f"{_VERBS.get(verdict, verdict.value)} in {run.case.scene.name} down to "
                f"{of}{spelled(run.case.engine, run.rung)} ({seen(run.symptom)})"
            )
    tail = f" It {'; it '.join(examples)}." if examples else ""
    return f"{words}, {len(runs)} runs: {counts}.{tail}"


def seen(symptom: Symptom) -> str:
    """Return a symptom in words: its kind, its size, and the time."""
    if math.isnan(symptom.number):
        return symptom.words
    words, _, unit = symptom.words.rpartition(", ")
    much = f"{symptom.number:.2g}"
    text = f"{words} {much} {unit}" if words and unit in _UNITS else f"{symptom.words} {much}"
    return f"{text}, at {symptom.time:.2g} s"


def _cures(own: Sequence[ClassifiedRun], names: Sequence[str]) -> list[str]:
    """Return sentences on the cases that fail as shipped, by the setting that cures them."""
    cured: dict[str, list[str]] = {}
    for name in names:
        runs = [run for run in own if run.case.scene.name == name]
        shipped = next((run for run in _of(runs, "default") if rung_of(run.case) is None), None)
        if shipped is not None and not shipped.good:
            cured.setdefault(_cure(runs, shipped), []).append(f"{name} ({shipped.verdict.value})")
    return [f"{cure}: {', '.join(cases)}." for cure, cases in sorted(cured.items())]


def _cure(runs: Sequence[ClassifiedRun], shipped: ClassifiedRun) -> str:
    """Return the setting that makes a case good, the simplest first."""
    best = {
        profile: max((run.rung for run in _of(runs, profile) if run.good), default=0.0)
        for profile, _ in _PROFILES
    }
    engine = shipped.case.engine
    if best["default"]:
        than = "a shorter" if best["default"] < shipped.rung else "a longer"
        than = than if takes_timestep(engine) else "another"
        at = spelled(engine, best["default"])
        return f"Cured by {than} {finer_by(engine)} alone, at {at}"
    if best["matched"]:
        return f"Cured by profile matched at {spelled(engine, best['matched'])}"
    if best["adaptive"]:
        return "Cured by profile adaptive"
    return "Cured by nothing that was tried"


_RUNS = (
    replace(run_columns.SCENE, meaning="Name of the hard case, or of a release perturbed from it."),
    run_columns.ENGINE,
    run_columns.PROFILE,
    run_columns.TIMESTEP,
    Column("verdict", "How the run went, by the criteria of the study.", "verdict.value"),
    Column("number", "The number behind the verdict.", "symptom.number"),
    Column("number_is", "What the number is.", "symptom.words"),
    Column("time_s", "When it was seen first, or was largest.", "symptom.time"),
    run_columns.OUTCOME.of(lambda run: run.simulation.outcome.value.partition(":")[0]),
    Column("steps", "Timesteps taken.", "simulation.steps"),
    run_columns.LINK,
)
