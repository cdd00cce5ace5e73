"""The main job: run the suite, write the report, show the summary."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer
from rich.markup import escape

from harness import face
from harness.artefact import Prose, Table
from harness.cli import printing
from harness.cli.attribution import told
from harness.cli.engine_settings import engine_settings, spelled
from harness.cli.further import further
from harness.cli.gate import BASELINE, COLUMNS, Gate, accepted, held, opened, show_changes
from harness.cli.joining import joined
from harness.cli.running import Running, runs
from harness.errors import InvalidSettingError
from harness.gate import gate_keys
from harness.provenance import provenance
from harness.report import Chapter, check_writable, write_chapters
from harness.runner import Evaluation, check
from harness.simulation import Outcome
from harness.store import Store
from harness.studies.comparison import SUITES

_SHOWN = (
    "scene",
    "engine",
    "shipped_turn_error_deg",
    "shipped_phi_rms_rad",
    "shipped_verdict",
    "best_turn_error_deg",
    "best_phi_rms_rad",
    "best_run",
    "best_verdict",
)


_WHOLE = "full"
"""The suite that goes on to ask who is to blame."""


@runs
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
    running: Running,
) -> None:
    """Run the validation suite in every engine and write the report: the main job."""
    if suite not in SUITES:
        raise InvalidSettingError("--suite", suite, " or ".join(SUITES))
    chosen = engine_settings(set_ or [], face.stepping_engines(engine))
    designed, cases = face.suite(suite, engine), face.suite(suite, engine, chosen)
    for case in cases:
        check(case)
    check_writable(out)
    others = joined(with_ or [])
    gate = opened(
        suite, designed, spelled(chosen), baseline, accept=accept, every_engine=not engine
    )
    with printing.progress() as bar, running.executor() as executor:
        task = bar.add_task("starting the engines", total=len(cases))

        def show(evaluation: Evaluation) -> None:
            bar.update(task, advance=1, description=evaluation.simulation.case.label())

        evaluations, artefacts = face.validate(
            suite,
            engine,
            settings=chosen,
            executor=executor,
            store=_store(running.store, gate),
            on_done=show,
            on_kept=running.kept,
        )
    run = held(gate, evaluations)
    comparison = Chapter(
        title=f"rockingcan, {suite} suite",
        artefacts=(*run.artefacts, *artefacts),
        cases=tuple(
            told(evaluation) | gate_keys(case, suite, gate.settings)
            for evaluation, case in zip(evaluations, designed, strict=True)
        ),
        provenance=provenance(),
    )
    if suite == _WHOLE:
        others = further(engine, replace(running, store=_store(running.store, gate))) + others
    page = write_chapters(
        [comparison, *others], out, title=comparison.title, provenance=comparison.provenance
    )
    console = printing.out()
    for artefact in artefacts:
        if isinstance(artefact, Table) and artefact.name == "scorecard":
            console.print(printing.data(artefact, _SHOWN))
        if isinstance(artefact, Prose) and artefact.name == "summary":
            console.print(escape(artefact.text))
    show_changes(run.artefacts, console, COLUMNS)
    if accept:
        with running.executor() as executor:
            console.print(f"\nAccepted: {accepted(gate, run, executor)}")
    console.print(f"\nThe report: {page}")
    _stop_at_mismatch(evaluations)
    if run.failed and not accept:
        raise typer.Exit(1)


def _store(store: Store | None, gate: Gate) -> Store | None:
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
        printing.out().print(printing.parity(evaluation.simulation.parity))
    if wrong:
        raise typer.Exit(1)
