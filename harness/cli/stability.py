"""Hard cases: run the map, seek the largest usable timesteps, try the reference, report."""

from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.markup import escape

from harness import face
from harness.artefact import Prose, Table
from harness.campaign import Listener, complete
from harness.case import Case
from harness.cli import printing
from harness.cli.running import Running, runs
from harness.engines import registry
from harness.errors import InvalidSettingError, MissingPackageError
from harness.isolation import LostTaskError
from harness.provenance import provenance
from harness.report import check_writable, write_report
from harness.runner import attempt, check, lost
from harness.studies.stability import (
    SUITES,
    Finding,
    Judged,
    Suite,
    by_scene,
    design,
    examine,
    findings,
    judge,
    limits,
    next_round,
    random_scenes,
    read,
    scenes,
    verdicts,
)
from models.catalogue import load
from models.scene import Scene

_SHARE = 100
"""Random scenes in a task: one takes some 50 ms."""

Told = Callable[[str, int], None]


@dataclass(frozen=True, slots=True, kw_only=True)
class Work:
    """What runs, how, and who is told in words what was done, and how much of it."""

    executor: Executor
    running: Running
    told: Told


@runs
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
    running: Running,
) -> None:
    """Run hard cases until engines fail, say how they fail, and from which timestep on."""
    if suite not in SUITES:
        raise InvalidSettingError("--suite", suite, " or ".join(SUITES))
    chosen, engines = SUITES[suite], face.stepping_engines(engine)
    for name in engines:
        if not _steps(name):
            able = ", ".join(each for each in face.stepping_engines(None) if _steps(each))
            allowed = f"{able}: stability judges engines that take timesteps"
            raise InvalidSettingError("--engine", name, allowed)
    cases = design(chosen, engines)
    for case in cases:
        check(case)
    check_writable(out)
    with printing.progress() as bar, running.executor() as executor:
        task = bar.add_task("starting the engines", total=None)

        def told(words: str, done: int) -> None:
            bar.update(task, advance=done, description=words)

        work = Work(executor=executor, running=running, told=told)
        judged = judged_runs(chosen, engines, cases, work)
        hard = examined(scenes(chosen), work)
        random = examined(list(random_scenes(chosen.random_scenes)), work)
    artefacts = read(chosen, judged, limits(chosen, engines, by_scene(judged)), hard, random)
    page = write_report(
        artefacts,
        out,
        title=f"rockingcan, stability, {suite} suite",
        cases=[_told(one) for one in judged],
        provenance=provenance(),
    )
    console = printing.out()
    for artefact in artefacts:
        if isinstance(artefact, Table) and artefact.name in {"largest-timesteps", "random-scenes"}:
            console.print(printing.data(artefact, tuple(artefact.columns)))
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
) -> list[Judged]:
    """Run the map, then round after round of the searches; return the verdicts.

    Parameters
    ----------
    suite : Suite
    engines : sequence of str
    cases : sequence of Case
        Of the map.
    work : Work
    """
    judged: dict[Case, Judged] = {}
    store = work.running.store
    while cases:
        found = complete(
            cases,
            _judged,
            work.executor,
            lost=_lost,
            shelf=None if store is None else verdicts(store),
            listener=Listener(
                kept=work.running.kept, done=lambda case, _: work.told(case.label(), 1)
            ),
        )
        judged |= dict(zip(cases, found, strict=True))
        cases = next_round(suite, engines, by_scene(list(judged.values())))
    return list(judged.values())


def _judged(case: Case) -> Judged:
    return judge(attempt(case))


def _lost(case: Case, error: LostTaskError) -> Judged:
    return judge(lost(case, error))


def examined(chosen: Sequence[Scene], work: Work) -> list[Finding]:
    """Return how the reference fares on scenes."""
    store = work.running.store
    found = complete(
        [tuple(chosen[start : start + _SHARE]) for start in range(0, len(chosen), _SHARE)],
        _examined,
        work.executor,
        lost=_unexamined,
        shelf=None if store is None else findings(store),
        listener=Listener(
            kept=work.running.kept, done=lambda part, _: work.told("the reference", len(part))
        ),
    )
    return [finding for part in found for finding in part]


def _examined(part: Sequence[Scene]) -> list[Finding]:
    return [examine(scene) for scene in part]


def _unexamined(part: Sequence[Scene], error: LostTaskError) -> list[Finding]:
    return [Finding(scene=scene.name, failure=error.reason) for scene in part]


def _told(one: Judged) -> dict[str, Any]:
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
