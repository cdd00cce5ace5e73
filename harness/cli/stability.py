"""Hard cases: run the map, seek the largest usable timesteps, try the reference, report."""

from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.markup import escape

from harness import api
from harness.cli import terminal
from harness.cli.run_options import RunOptions, with_run_options
from harness.core.case import Case
from harness.core.errors import InvalidSettingError, MissingPackageError
from harness.core.provenance import provenance
from harness.core.report_model import Prose, Table
from harness.engines import registry
from harness.evaluation.evaluate import check_case, evaluate_case, failed_evaluation
from harness.execution.tasks import ProgressListener, run_tasks
from harness.execution.worker import LostTaskError
from harness.report.atomic_folder import check_writable
from harness.report.write import write_report
from harness.studies.stability.classify import classify
from harness.studies.stability.failure_criteria import ClassifiedRun
from harness.studies.stability.keeping import classified_cache, reference_check_cache
from harness.studies.stability.limits import by_scene, limits, next_round
from harness.studies.stability.report import stability_report
from harness.studies.stability.suite import SUITES, Suite, random_scenes, scenes, stability_cases
from harness.studies.stability.survey import ReferenceCheck, examine
from models.catalogue import load
from models.scene import Scene

_SHARE = 100
"""Random scenes in a task: one takes some 50 ms."""

Told = Callable[[str, int], None]


@dataclass(frozen=True, slots=True, kw_only=True)
class Work:
    """What runs, how, and who is told in words what was done, and how much of it."""

    executor: Executor
    running: RunOptions
    told: Told


@with_run_options
def stability(
    suite: Annotated[
        str, typer.Option(help="quick: about two minutes; full: every hard case.")
    ] = "quick",
    engine: Annotated[
        list[str] | None, typer.Option(help="An engine to judge; repeat it. All if left out.")
    ] = None,
    out: Annotated[Path, typer.Option(help="Folder of the report; replaced as a whole.")] = Path(
        "reports/stability"
    ),
    *,
    running: RunOptions,
) -> None:
    """Run hard cases until engines fail, say how they fail, and from which timestep on."""
    if suite not in SUITES:
        raise InvalidSettingError("--suite", suite, " or ".join(SUITES))
    chosen, engines = SUITES[suite], api.stepping_engines(engine)
    for name in engines:
        if not _steps(name):
            able = ", ".join(each for each in api.stepping_engines(None) if _steps(each))
            allowed = f"{able}: stability judges engines that take timesteps"
            raise InvalidSettingError("--engine", name, allowed)
    cases = stability_cases(chosen, engines)
    for case in cases:
        check_case(case)
    check_writable(out)
    with terminal.progress_bar() as bar, running.executor() as executor:
        task = bar.add_task("starting the engines", total=None)

        def told(words: str, done: int) -> None:
            bar.update(task, advance=done, description=words)

        work = Work(executor=executor, running=running, told=told)
        judged = judged_runs(chosen, engines, cases, work)
        hard = examined(scenes(chosen), work)
        random = examined(list(random_scenes(chosen.random_scenes)), work)
    artefacts = stability_report(
        chosen, judged, limits(chosen, engines, by_scene(judged)), hard, random
    )
    page = write_report(
        artefacts,
        out,
        title=f"rockingcan, stability, {suite} suite",
        cases=[_told(one) for one in judged],
        provenance=provenance(),
    )
    console = terminal.stdout_console()
    for artefact in artefacts:
        if isinstance(artefact, Table) and artefact.name in {"largest-timesteps", "random-scenes"}:
            console.print(terminal.table_artefact(artefact, tuple(artefact.columns)))
        if isinstance(artefact, Prose):
            console.print(f"\n[bold]{escape(artefact.title)}[/]\n{escape(artefact.text)}")
    console.print(f"\nThe report: {page}")
    if any(finding.failure for finding in (*hard, *random)):
        raise typer.Exit(1)


def _steps(name: str) -> bool:
    """Whether an engine takes timesteps; one whose package is missing may."""
    try:
        return registry.timestep_of(Case(scene=load("gentle-rock"), engine=name)) is not None
    except MissingPackageError:
        return True


def judged_runs(
    suite: Suite, engines: Sequence[str], cases: Sequence[Case], work: Work
) -> list[ClassifiedRun]:
    """Run the map, then round after round of the searches; return the verdicts.

    Parameters
    ----------
    suite : Suite
    engines : sequence of str
    cases : sequence of Case
        Of the map.
    work : Work
    """
    judged: dict[Case, ClassifiedRun] = {}
    store = work.running.store
    while cases:
        found = run_tasks(
            cases,
            _judged,
            work.executor,
            lost=_lost,
            cache=None if store is None else classified_cache(store),
            listener=ProgressListener(
                kept=work.running.kept, done=lambda case, _: work.told(case.label(), 1)
            ),
        )
        judged |= dict(zip(cases, found, strict=True))
        cases = next_round(suite, engines, by_scene(list(judged.values())))
    return list(judged.values())


def _judged(case: Case) -> ClassifiedRun:
    return classify(evaluate_case(case))


def _lost(case: Case, error: LostTaskError) -> ClassifiedRun:
    return classify(failed_evaluation(case, error))


def examined(chosen: Sequence[Scene], work: Work) -> list[ReferenceCheck]:
    """Return how the reference fares on scenes."""
    store = work.running.store
    found = run_tasks(
        [tuple(chosen[start : start + _SHARE]) for start in range(0, len(chosen), _SHARE)],
        _examined,
        work.executor,
        lost=_unexamined,
        cache=None if store is None else reference_check_cache(store),
        listener=ProgressListener(
            kept=work.running.kept, done=lambda part, _: work.told("the reference", len(part))
        ),
    )
    return [finding for part in found for finding in part]


def _examined(part: Sequence[Scene]) -> list[ReferenceCheck]:
    return [examine(scene) for scene in part]


def _unexamined(part: Sequence[Scene], error: LostTaskError) -> list[ReferenceCheck]:
    return [ReferenceCheck(scene=scene.name, failure=error.reason) for scene in part]


def _told(one: ClassifiedRun) -> dict[str, Any]:
    """Return a case as the manifest says it."""
    s = one.simulation
    return {
        "digest": s.case.digest(s.engine_version),
        "label": s.case.label(),
        "command": s.case.command(),
        "engine": s.case.engine,
        "engine_version": s.engine_version,
        "outcome": s.outcome.value,
        "verdict": one.verdict.value,
        "settings": dict(s.settings),
    }
