"""The main job: run the suite, write the report, show the summary.

What the full suite asks beyond the comparison: who is to blame, and which error it is.
"""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from harness import api
from harness.cli import terminal
from harness.cli.gate import (
    BASELINE,
    GateRequest,
    accept_baseline,
    compare_to_baseline,
    open_gate,
    show_changes,
)
from harness.cli.paper import joined_sections
from harness.cli.run_options import RunOptions, engine_settings, settings_to_dict, with_run_options
from harness.cli.study_command import run_with_progress, shown
from harness.core.provenance import provenance
from harness.core.report_model import Prose
from harness.core.simulation import Outcome
from harness.evaluation.evaluation import Evaluation
from harness.execution.cache import CacheFolder
from harness.gate.baseline import gate_keys
from harness.report.atomic_folder import check_writable
from harness.report.layout import Section
from harness.report.write import write_chapters
from harness.studies.attribution.study import AttributionStudy
from harness.studies.comparison.study import plan_comparison
from harness.studies.errors.plan import plan_errors
from harness.studies.errors.study import ErrorsStudy
from harness.studies.shared.ablation import ablation_path
from harness.studies.study import StudyGroup
from models.catalogue import load

_ATTRIBUTED = ("gentle-rock", "paper-release")
_SPLIT = ("gentle-rock",)
"""Scenes that both studies can carry: under gravity, ideal, with a bounce."""


def further(names: Sequence[str], running: RunOptions) -> list[Section]:
    """Return the attribution and the three errors of every engine, as chapters of a report."""
    groups = (
        StudyGroup(
            name="Attribution",
            studies=tuple(
                AttributionStudy(path=ablation_path(load(scene), name))
                for scene in _ATTRIBUTED
                for name in names
            ),
        ),
        StudyGroup(
            name="Three errors",
            studies=tuple(
                ErrorsStudy(plan=plan_errors(load(scene), name))
                for scene in _SPLIT
                for name in names
            ),
        ),
    )
    done = run_with_progress(StudyGroup(name="causes", studies=groups), running)
    return [
        Section(
            title=group.name,
            # the words of all parts first
            artefacts=tuple(sorted(group.report(done), key=lambda a: not isinstance(a, Prose))),
            cases=tuple(done.only(group.next_jobs(done)).manifest()),
            provenance=provenance(),
        )
        for group in groups
    ]


_WHOLE = "full"
"""The suite that goes on to ask who is to blame."""


@with_run_options
def validate(  # noqa: PLR0917 - a parameter an option
    suite: Annotated[
        str, typer.Option(help="quick: a minute or so; full: long ladders, causes, three errors.")
    ] = "quick",
    engine: Annotated[
        list[str] | None, typer.Option(help="An engine to compare; repeat it. All if left out.")
    ] = None,
    out: Annotated[Path, typer.Option(help="Folder of the report; replaced as a whole.")] = Path(
        "reports/latest"
    ),
    set_: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="ENGINE.KEY=VALUE",
            help="A setting on top of every case of an engine, to see what it does; repeat it.",
        ),
    ] = None,
    baseline: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR",
            help="Hold the results against accepted ones; leave with code 1 if one got worse.",
        ),
    ] = None,
    accept: Annotated[  # noqa: FBT002 - a switch of the command line
        bool,
        typer.Option(
            "--accept",
            help=f"Measure how far each result may move and accept it, into {BASELINE} or "
            "--baseline, in place of what was accepted there.",
        ),
    ] = False,
    with_: Annotated[
        list[Path] | None,
        typer.Option(
            "--with",
            metavar="DIR",
            help="A report of another study to join, such as reports/stability; repeat it.",
        ),
    ] = None,
    *,
    running: RunOptions,
) -> None:
    """Run the validation suite in every engine and write the report: the main job."""
    engines = api.stepping_engines(engine)
    chosen = engine_settings(set_ or [], engines)
    study = plan_comparison(suite, engines, chosen)
    check_writable(out)
    others = joined_sections(with_ or [])
    gate = open_gate(
        study, settings_to_dict(chosen), baseline, accept=accept, every_engine=not engine
    )
    running = replace(running, store=_store(running.store, gate))
    done = run_with_progress(study, running)
    evaluations, artefacts = study.evaluations(done), study.report(done)
    run = compare_to_baseline(gate, evaluations)
    comparison = Section(
        title=f"rockingcan, {study.name}",
        artefacts=(*run.artefacts, *artefacts),
        cases=tuple(
            {**record, **gate_keys(case, suite, gate.settings)}
            for record, case in zip(done.manifest(), study.designed, strict=True)
        ),
        provenance=provenance(),
    )
    if suite == _WHOLE:
        others = further(engines, running) + others
    page = write_chapters(
        [comparison, *others], out, title=comparison.title, provenance=comparison.provenance
    )
    shown({"scorecard": (), "summary": ()})(done, artefacts)
    console = terminal.stdout_console()
    show_changes(run.artefacts, console)
    if accept:
        with running.executor() as executor:
            console.print(f"\nAccepted: {accept_baseline(gate, run, executor)}")
    console.print(f"\nThe report: {page}")
    _stop_at_mismatch(evaluations)
    if run.failed and not accept:
        raise typer.Exit(1)


def _store(store: CacheFolder | None, gate: GateRequest) -> CacheFolder | None:
    """Return the store, which a gate does not look into.

    An engine that was built anew often has the version of its last release, and so its results
    the key of those that are kept.
    """
    gated = gate.accepted is not None or gate.place is not None
    return replace(store, fresh=True) if store is not None and gated else store


def _stop_at_mismatch(evaluations: Sequence[Evaluation]) -> None:
    """Leave with code 1 if an engine compiled another can than the scene's, after the tables."""
    wrong = [e for e in evaluations if e.simulation.outcome is Outcome.MISMATCH]
    for evaluation in wrong:
        terminal.stdout_console().print(terminal.parity(evaluation.simulation.parity))
    if wrong:
        raise typer.Exit(1)
