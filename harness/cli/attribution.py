"""Which of an engine's gaps causes which part of its discrepancy."""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.markup import escape

from harness.cli import terminal
from harness.cli.json_output import to_json
from harness.cli.run_options import RunOptions, with_run_options
from harness.core.case import Case
from harness.core.provenance import provenance
from harness.core.report_model import Artefact, Prose, Table
from harness.evaluation.evaluate import run_cases
from harness.evaluation.evaluation import Evaluation
from harness.report.atomic_folder import check_writable
from harness.report.write import write_report
from harness.studies.attribution.ablation import ablation_path, attribution_cases
from harness.studies.attribution.report import Attribution, attribution_report
from harness.studies.attribution.report import attribution as attributed
from models.catalogue import load

_SHOWN = ("place", "gap", "quantity", "in_order", "alone", "left_open", "interaction")


@with_run_options
def attribute(  # noqa: PLR0917 - a parameter an option
    scene: Annotated[
        str, typer.Argument(metavar="SCENE", help="A scene of the catalogue, or a scene file.")
    ],
    engine: Annotated[str, typer.Option(help="Which engine (see: rockingcan engines).")],
    timestep: Annotated[
        float | None, typer.Option(help="Of the matched end, in seconds; its own if left out.")
    ] = None,
    first: Annotated[
        list[str] | None,
        typer.Option(help="A gap to close before the others; repeat it. Such as: timestep."),
    ] = None,
    out: Annotated[Path | None, typer.Option(help="Write a report into this folder.")] = None,
    json: Annotated[  # noqa: FBT002 - a switch of the command line
        bool, typer.Option("--json", help="Print one JSON object and nothing else.")
    ] = False,
    *,
    running: RunOptions,
) -> None:
    """Say who is to blame: close the gaps from default to matched one at a time, and each alone.

    For example: rockingcan attribute gentle-rock --engine mujoco
    """
    way = ablation_path(load(scene), engine, timestep, first or ())
    if out is not None:
        check_writable(out)
    found = attributed(way, evaluations(attribution_cases(way), running))
    artefacts = attribution_report(found)
    page = (
        None if out is None else report(artefacts, found.evaluations.values(), out, "attribution")
    )
    if json:
        typer.echo(to_json(_answer(found)))
        return
    console = terminal.stdout_console()
    for artefact in artefacts:
        if isinstance(artefact, Table) and artefact.name.endswith("-gaps"):
            console.print(terminal.table_artefact(artefact, _SHOWN))
        if isinstance(artefact, Table) and artefact.name.endswith("-interactions"):
            console.print(terminal.table_artefact(artefact, tuple(artefact.columns)[2:]))
    for sentence in found.sentences:
        console.print(escape(sentence))
    if page is not None:
        console.print(f"\nThe report: {page}")


def evaluations(cases: Sequence[Case], running: RunOptions) -> tuple[Evaluation, ...]:
    """Run cases beside a progress bar."""
    with terminal.progress_bar() as bar, running.executor() as executor:
        task = bar.add_task("starting the engines", total=len(cases))

        def show(evaluation: Evaluation) -> None:
            bar.update(task, advance=1, description=evaluation.simulation.case.label())

        return run_cases(cases, executor, show, store=running.store, on_kept=running.kept)


def report(
    artefacts: Sequence[Artefact], found: Iterable[Evaluation], out: Path, study: str
) -> Path:
    """Write the report of a study, its words at the top, and return its page."""
    return write_report(
        [replace(a, name="summary", scene="") if isinstance(a, Prose) else a for a in artefacts],
        out,
        title=f"rockingcan, {study}",
        cases=[case_record(e) for e in found],
        provenance=provenance(),
    )


def case_record(e: Evaluation) -> dict[str, Any]:
    """Return a case as the manifest says it."""
    return {
        "digest": e.simulation.case.digest(e.simulation.engine_version),
        "label": e.simulation.case.label(),
        "command": e.simulation.case.command(),
        "engine": e.simulation.case.engine,
        "engine_version": e.simulation.engine_version,
        "outcome": e.simulation.outcome.value,
        "settings": dict(e.simulation.settings),
    }


def _answer(found: Attribution) -> dict[str, Any]:
    """Return an attribution as `--json` says it."""
    way = found.path
    return {
        "scene": way.scene.name,
        "engine": way.engine,
        "timestep_s": way.matched_timestep,
        "order": list(way.names),
        "quantities": {
            key: {
                "as_shipped": account.shipped,
                "remains": account.remains,
                "whole": account.whole,
                "interaction": account.interaction,
                "gaps": [
                    {"gap": name, "in_order": in_order, "alone": alone, "left_open": left_open}
                    for name, in_order, alone, left_open in zip(
                        account.names,
                        account.in_order,
                        account.alone,
                        account.left_open,
                        strict=True,
                    )
                ],
            }
            for key, account in found.accounts.items()
        },
        "sentences": list(found.sentences),
    }
