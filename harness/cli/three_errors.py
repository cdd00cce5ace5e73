"""Three errors of an engine, never mixed: model form, discretisation, solver."""

from pathlib import Path
from typing import Annotated, Any

import typer
from rich.markup import escape

from harness.cli import terminal
from harness.cli.attribution import evaluations, report
from harness.cli.json_output import to_json
from harness.cli.run_options import RunOptions, parse_settings, with_run_options
from harness.core.report_model import Table
from harness.report.atomic_folder import check_writable
from harness.studies.errors.plan import errors_cases, plan_errors
from harness.studies.errors.report import ThreeErrors, errors_report, three_errors
from models.catalogue import load

_SHOWN = {
    "-split": (
        "way",
        "quantity",
        "limit_uncertainty",
        "model_form",
        "discretisation",
        "solver",
        "total",
        "observed_order",
        "not_decidable_within",
        "verdict",
    ),
    "-spreads": ("quantity", "relative_size", "spread_of_engine", "spread_of_truth"),
}


@with_run_options
def errors(  # noqa: PLR0917 - a parameter an option
    scene: Annotated[
        str, typer.Argument(metavar="SCENE", help="A scene of the catalogue, or a scene file.")
    ],
    engine: Annotated[str, typer.Option(help="Which engine (see: rockingcan engines).")],
    profile: Annotated[str, typer.Option(help="default or matched.")] = "matched",
    timestep: Annotated[
        float | None,
        typer.Option(help="The coarsest of the ladder, in seconds; what suits if left out."),
    ] = None,
    set_: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="KEY=VALUE", help="A setting on all runs; repeat it."),
    ] = None,
    out: Annotated[Path | None, typer.Option(help="Write a report into this folder.")] = None,
    json: Annotated[  # noqa: FBT002 - a switch of the command line
        bool, typer.Option("--json", help="Print one JSON object and nothing else.")
    ] = False,
    *,
    running: RunOptions,
) -> None:
    """Tell model form, discretisation and solver error apart, and what is not decidable.

    For example: rockingcan errors gentle-rock --engine mujoco --set solref=0.005,1
    """
    chosen = plan_errors(
        load(scene), engine, profile, timestep=timestep, options=parse_settings(set_ or [])
    )
    if out is not None:
        check_writable(out)
    found = three_errors(chosen, evaluations(errors_cases(chosen), running))
    artefacts = errors_report(found)
    page = (
        None if out is None else report(artefacts, found.evaluations.values(), out, "three errors")
    )
    if json:
        typer.echo(to_json(_answer(found)))
        return
    console = terminal.stdout_console()
    for artefact in artefacts:
        for ending, columns in _SHOWN.items():
            if isinstance(artefact, Table) and artefact.name.endswith(ending):
                console.print(terminal.table_artefact(artefact, columns))
    for sentence in found.sentences:
        console.print(escape(sentence))
    if page is not None:
        console.print(f"\nThe report: {page}")


def _answer(found: ThreeErrors) -> dict[str, Any]:
    """Return the three errors as `--json` says them."""
    chosen = found.plan
    return {
        "scene": chosen.scene.name,
        "engine": chosen.engine,
        "profile": chosen.profile,
        "timestep_s": chosen.probe,
        "ladder_s": list(chosen.timesteps),
        "errors": [
            {
                "way": way,
                "quantity": quantity,
                "true": split.true,
                "value": split.value,
                "limit": split.limit and split.limit.value,
                "limit_uncertainty": split.limit and split.limit.uncertainty,
                "observed_order": split.limit and split.limit.order,
                "model_form": split.model_form,
                "discretisation": split.discretisation,
                "solver": split.solver,
                "total": split.total,
                "not_decidable_within": split.band,
                "verdict": split.verdict,
            }
            for (way, quantity), split in found.splits.items()
        ],
        "sentences": list(found.sentences),
    }
