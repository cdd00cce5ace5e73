"""What the commands of studies share: options, running with progress, the report, the answer."""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import typer
from rich.markup import escape

from harness.api import unusable_engines
from harness.cli import terminal
from harness.cli.run_options import RunOptions
from harness.cli.terminal import to_json
from harness.core.errors import HarnessError
from harness.core.provenance import provenance
from harness.core.report_model import Artefact, Prose, Table
from harness.engines.registry import how_to_add
from harness.evaluation.timing import single_thread_executor
from harness.execution.isolated_pool import IsolatedProcessPool
from harness.progress import ProgressBar, report_progress
from harness.report.atomic_folder import check_writable
from harness.report.tables import records
from harness.report.write import write_report
from harness.studies.comparison.rim import RimStudy
from harness.studies.study import Results, Study, StudyProgress, run_study

Shown = Mapping[str, Collection[str]]
"""Artefacts that the terminal shows, by the end of their names, and columns of tables left out."""


class FiguresWithoutReportError(HarnessError, ValueError):
    """Figures for paper are asked for, and no report that would have them."""

    def __str__(self) -> str:
        """Name the option that is missing."""
        return "--figures needs --out: the figures are written into the folder of the report"


def run_with_progress(study: Study, running: RunOptions) -> Results:
    """Run a study with a progress bar, on the executor and within the limits of the options."""

    def show(progress: StudyProgress) -> None:
        bar.show(progress)
        if not progress.label:
            running.kept(progress.kept, progress.total)

    with ProgressBar() as bar, running.executor() as executor:
        if isinstance(executor, IsolatedProcessPool):
            executor.on_compiling = bar.compiling
        return run_study(
            study,
            executor=executor,
            cache=running.store,
            on_progress=show,
            timer=lambda: single_thread_executor(running.limits),
        )


def run_command(
    study: Study,
    running: RunOptions,
    *,
    out: Path | None,
    json: bool,
    figures: bool,
    answer: Callable[[Results], Mapping[str, Any]] | None = None,
    absent: Sequence[str] = (),
    show: Callable[[Results, Sequence[Artefact]], None],
) -> Results:
    """Run a study, write its report, and print its tables and words, or one JSON object.

    Parameters
    ----------
    study : Study
    running : RunOptions
    out : Path, optional
        Folder of the report; none is written if left out.
    json : bool
    figures : bool
        Whether the report has its figures for paper too.
    answer : callable, optional
        Returns what `--json` prints; all tables by name, row by row, if left out.
    absent : sequence of str
        Engines that would have run if they were installed.
    show : callable
        Prints what a person reads.
    """
    if figures and out is None:
        raise FiguresWithoutReportError
    if out is not None:
        check_writable(out)
    done = run_with_progress(study, running)
    artefacts, notes = study.report(done), not_installed(absent)
    if out is not None:
        artefacts = [*artefacts, *_under_the_rim(done, running)]
    page = None
    if out is not None:
        with report_progress() as progress:
            page = write_report(
                [*_with_summary(artefacts), *notes],
                out,
                title=f"rockingcan, {study.name}",
                cases=done.manifest(),
                provenance=provenance(),
                figures=figures,
                jobs=running.jobs,
                on_progress=progress,
            )
    if json:
        tables = (a for a in artefacts if isinstance(a, Table))
        typer.echo(to_json(answer(done) if answer else {a.name: records(a) for a in tables}))
        return done
    show(done, artefacts)
    shown({"summary": ()})(done, notes)
    if page is not None:
        terminal.stdout_console().print(escape(f"\nThe report: {page}"))
    return done


def _under_the_rim(done: Results, running: RunOptions) -> Sequence[Artefact]:
    """Return what `probe` or `validate` has kept of the colliders of the engines that ran."""
    engines = {str(run["engine"]) for run in done.manifest()}
    if running.store is None or not engines:
        return ()
    study = RimStudy(engines=tuple(sorted(engines))).kept(running.store)
    return study.report(run_study(study, cache=running.store)) if study.engines else ()


def not_installed(engines: Sequence[str]) -> tuple[Prose, ...]:
    """Return what a report and the terminal say of engines that are absent; nothing without any."""
    unusable = {name: why for name, why in unusable_engines().items() if name in engines}
    added = how_to_add([name for name in engines if name not in unusable])
    said = ([added] if added else []) + [f"left out: {why}" for why in unusable.values()]
    return tuple(
        Prose(name="summary", title="Engines", text=f"{sentence[:1].upper()}{sentence[1:]}.")
        for sentence in said
    )


def _with_summary(artefacts: Sequence[Artefact]) -> list[Artefact]:
    """Return artefacts with their texts as the summary, which opens the page."""
    if any(a.name == "summary" for a in artefacts):
        return list(artefacts)
    return [replace(a, name="summary", scene="") if isinstance(a, Prose) else a for a in artefacts]


def shown(names: Shown) -> Callable[[Results, Sequence[Artefact]], None]:
    """Return a function that prints artefacts of a report: columns of tables, and words."""

    def show(_: Results, artefacts: Sequence[Artefact]) -> None:
        console = terminal.stdout_console()
        for artefact in artefacts:
            ending = next((end for end in names if artefact.name.endswith(end)), None)
            if ending is not None and isinstance(artefact, Table):
                console.print(terminal.table_artefact(artefact, names[ending]))
            elif ending is not None and isinstance(artefact, Prose):
                console.print(f"\n[bold]{escape(artefact.title)}[/]\n{escape(artefact.text)}")

    return show
