"""Hard cases: run the map, seek the largest usable timesteps, try the reference, report."""

import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor
from itertools import islice
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.markup import escape

from harness import face
from harness.artefact import Prose, Table
from harness.case import Case
from harness.cli import printing
from harness.errors import InvalidSettingError
from harness.executors import local
from harness.provenance import provenance
from harness.report import check_writable, write_report
from harness.runner import check, run
from harness.studies.stability import (
    SUITES,
    Finding,
    Judged,
    Suite,
    by_scene,
    design,
    examine,
    judge,
    limits,
    next_round,
    random_scenes,
    read,
    scenes,
)
from models.scene import Scene

_AT_ONCE = 48
"""Cases whose motions are held in memory together, some megabytes each."""

_SHARE = 100
"""Random scenes in a task: one takes some 50 ms."""

Told = Callable[[str, int], None]


def stability(
    suite: Annotated[
        str, typer.Option(help="quick: about two minutes; full: every hard case.")
    ] = "quick",
    engine: Annotated[
        list[str] | None, typer.Option(help="An engine to judge; repeat it. All if left out.")
    ] = None,
    jobs: Annotated[
        int | None, typer.Option(min=1, help="Processes; one a core if left out.")
    ] = None,
    out: Annotated[Path, typer.Option(help="Folder of the report; replaced as a whole.")] = Path(
        "reports/stability"
    ),
) -> None:
    """Run hard cases until engines fail, say how they fail, and from which timestep on."""
    if suite not in SUITES:
        raise InvalidSettingError("--suite", suite, " or ".join(SUITES))
    chosen, engines = SUITES[suite], face.stepping_engines(engine)
    cases = design(chosen, engines)
    for case in cases:
        check(case)
    check_writable(out)
    with printing.progress() as bar, local(jobs or len(os.sched_getaffinity(0))) as executor:
        task = bar.add_task("starting the engines", total=None)

        def told(words: str, done: int) -> None:
            bar.update(task, advance=done, description=words)

        judged = judged_runs(chosen, engines, cases, executor, told)
        hard = examined(scenes(chosen), executor, told)
        random = examined(list(random_scenes(chosen.random_scenes)), executor, told)
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


def judged_runs(
    suite: Suite, engines: Sequence[str], cases: Sequence[Case], executor: Executor, told: Told
) -> list[Judged]:
    """Run the map, then round after round of the searches; return the verdicts.

    Parameters
    ----------
    suite : Suite
    engines : sequence of str
    cases : sequence of Case
        Of the map.
    executor : Executor
    told : callable
        Is told in words what was done, and how many cases.
    """
    judged: dict[Case, Judged] = {}
    while cases:
        for batch in _batches(iter(cases)):
            for evaluation in run(batch, executor):
                judged[evaluation.simulation.case] = judge(evaluation)
            told(batch[-1].label(), len(batch))
        cases = next_round(suite, engines, by_scene(list(judged.values())))
    return list(judged.values())


def examined(chosen: Sequence[Scene], executor: Executor, told: Told) -> list[Finding]:
    """Return how the reference fares on scenes."""
    parts = [list(chosen[start : start + _SHARE]) for start in range(0, len(chosen), _SHARE)]
    found: list[Finding] = []
    for part in executor.map(_examined, parts):
        found += part
        told("the reference", len(part))
    return found


def _examined(part: Sequence[Scene]) -> list[Finding]:
    return [examine(scene) for scene in part]


def _batches(cases: Iterator[Case]) -> Iterator[list[Case]]:
    while batch := list(islice(cases, _AT_ONCE)):
        yield batch


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
