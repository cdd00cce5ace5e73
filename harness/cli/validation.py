"""The main job: run the suite, write the report, show the summary."""

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.markup import escape

from harness import face
from harness.artefact import Prose, Table
from harness.cli import printing
from harness.cli.running import Running, runs
from harness.errors import InvalidSettingError
from harness.provenance import provenance
from harness.report import check_writable, write_report
from harness.runner import Evaluation, check
from harness.simulation import Outcome
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


@runs
def validate(
    suite: Annotated[
        str, typer.Option(help="quick: a minute or so; full: every scene on a long ladder.")
    ] = "quick",
    engine: Annotated[
        list[str] | None, typer.Option(help="An engine to compare; repeat it. All if left out.")
    ] = None,
    out: Annotated[Path, typer.Option(help="Folder of the report; replaced as a whole.")] = Path(
        "reports/latest"
    ),
    *,
    running: Running,
) -> None:
    """Run the validation suite in every engine and write the report: the main job."""
    if suite not in SUITES:
        raise InvalidSettingError("--suite", suite, " or ".join(SUITES))
    cases = face.suite(suite, engine)
    for case in cases:
        check(case)
    check_writable(out)
    with printing.progress() as bar, running.executor() as executor:
        task = bar.add_task("starting the engines", total=len(cases))

        def show(evaluation: Evaluation) -> None:
            bar.update(task, advance=1, description=evaluation.simulation.case.label())

        evaluations, artefacts = face.validate(
            suite,
            engine,
            executor=executor,
            store=running.store,
            on_done=show,
            on_kept=running.kept,
        )
    page = write_report(
        artefacts,
        out,
        title=f"rockingcan, {suite} suite",
        cases=[_told(evaluation) for evaluation in evaluations],
        provenance=provenance(),
    )
    console = printing.out()
    for artefact in artefacts:
        if isinstance(artefact, Table) and artefact.name == "scorecard":
            console.print(printing.data(artefact, _SHOWN))
        if isinstance(artefact, Prose) and artefact.name == "summary":
            console.print(escape(artefact.text))
    console.print(f"\nThe report: {page}")
    _stop_at_mismatch(evaluations)


def _told(evaluation: Evaluation) -> dict[str, Any]:
    """Return a case as the manifest says it."""
    simulation = evaluation.simulation
    return {
        "digest": simulation.case.digest(simulation.engine_version),
        "label": simulation.case.label(),
        "command": simulation.case.command(),
        "engine": simulation.case.engine,
        "engine_version": simulation.engine_version,
        "outcome": simulation.outcome.value,
        "settings": dict(simulation.settings),
    }


def _stop_at_mismatch(evaluations: Sequence[Evaluation]) -> None:
    """Leave with code 1 if an engine compiled another can than the scene's, after the tables."""
    wrong = [e for e in evaluations if e.simulation.outcome is Outcome.MISMATCH]
    for evaluation in wrong:
        printing.out().print(printing.parity(evaluation.simulation.parity))
    if wrong:
        raise typer.Exit(1)
