"""The command that runs releases of an engine, and says at which of them contact changed."""

from pathlib import Path
from typing import Annotated

import typer

from harness.cli import options, run_options
from harness.cli.settings import parse_settings
from harness.cli.study_command import run_command, shown
from harness.core.errors import InvalidSettingError
from harness.engines.new_environment import remove_environment
from harness.gate.history.study import plan_history
from harness.results.files import check_place, result_name, write_result

_PLACE = "name a folder that you may write to with --results"


@run_options.with_run_options
def history(  # noqa: PLR0917 - a parameter an option
    engine: Annotated[
        str, typer.Argument(metavar="ENGINE", help="Any engine with a package of its own.")
    ],
    versions: Annotated[
        str,
        typer.Option(
            metavar="V,V,...", help="Released versions, or 'all' that have a wheel for this Python."
        ),
    ],
    suite: Annotated[
        str, typer.Option(help="quick, full, field or contact: see `validate`.")
    ] = "quick",
    scene: Annotated[
        list[str] | None,
        typer.Option(help="A scene of the suite to run; repeat it. All of them if left out."),
    ] = None,
    set_: options.Settings = None,
    bisect: Annotated[  # noqa: FBT002 - a switch of the command line
        bool,
        typer.Option(
            "--bisect", help="Look for each change in the releases between two, case by case."
        ),
    ] = False,
    keep: Annotated[  # noqa: FBT002 - a switch of the command line
        bool,
        typer.Option("--keep", help="Leave the environments that were made: see `engines list`."),
    ] = False,
    out: Annotated[
        Path | None,
        typer.Option(help="Folder of the report, replaced as a whole; reports/history-ENGINE."),
    ] = None,
    results: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR",
            help="Write the result of each release that ran the whole suite there, to publish.",
        ),
    ] = None,
    figures: options.Figures = False,  # noqa: FBT002 - a switch of the command line
    json: options.Json = False,  # noqa: FBT002 - a switch of the command line
    *,
    running: run_options.RunOptions,
) -> None:
    """At which release of an engine its contact changed.

    Each release runs the suite in an environment of its own, and is held against the one before:
    in which quantity it changed, and by how much. A release that cannot be installed, or that the
    adapter cannot run, is a row with the reason.

    For example: rockingcan history mujoco --versions 3.4.0,4.0.0 --bisect
    """
    if results is not None:
        if scene:
            allowed = "no scene beside --results, whose files are of the whole suite"
            raise InvalidSettingError("--scene", scene[0], allowed)
        check_place(results, _PLACE)
    study = plan_history(
        engine, versions, suite, parse_settings(set_ or []), scenes=scene or (), bisect=bisect
    )
    done = run_command(
        study,
        running,
        out=out or Path("reports") / f"history-{engine}",
        json=json,
        figures=figures,
        show=shown({"change-points": (), "versions": (), "summary": ()}),
    )
    if results is not None:
        for version, result in study.whole_results(done).items():
            name = result_name(engine, version, suite, result.settings)
            write_result(result, results / name, _PLACE)
    if not keep:
        for name in study.made(done):
            remove_environment(name)
