"""The commands of the studies of what an engine promises: tolerance, gradients."""

from pathlib import Path
from typing import Annotated

import typer

from harness import api
from harness.cli import options, run_options
from harness.cli.study_command import run_command, shown
from harness.core.errors import InvalidSettingError
from harness.studies.gradients.design import plan_gradients
from harness.studies.gradients.study import GradientsStudy
from harness.studies.tolerance.design import SUITES
from harness.studies.tolerance.ladder import Honesty
from harness.studies.tolerance.study import ToleranceStudy
from models.catalogue import load


@run_options.with_run_options
def tolerance(
    suite: Annotated[
        str,
        typer.Option(help="quick: about two minutes; full: every decade and hard case, about ten."),
    ] = "quick",
    engine: options.EngineNames = None,
    out: options.ReplacedFolder = Path("reports/tolerance"),
    figures: options.Figures = False,  # noqa: FBT002 - a switch of the command line
    json: options.Json = False,  # noqa: FBT002 - a switch of the command line
    *,
    running: run_options.RunOptions,
) -> None:
    """Whether the error asked for is the error delivered.

    Every setting that asks for an accuracy is run over its decades on hard cases: the tolerance of
    each integrator, the accuracy of engines with error control, and eta of adaptive stepping.

    For example: rockingcan tolerance --engine reference
    """
    if suite not in SUITES:
        raise InvalidSettingError("--suite", suite, " or ".join(SUITES))
    named = engine or ()
    stepping = api.stepping_engines(engine)
    engines = stepping if named else ("reference", *stepping)
    study = ToleranceStudy(suite=SUITES[suite], engines=engines)
    show = shown(
        {
            "settings": {
                "engine",
                "coarsest",
                "worst_asked",
                "level_scene",
                *(kind.value.replace(" ", "_") for kind in Honesty),
            },
            "summary": (),
        }
    )
    absent = api.absent_engines(engine)
    run_command(study, running, out=out, json=json, figures=figures, absent=absent, show=show)


@run_options.with_run_options
def gradients(  # noqa: PLR0917 - a parameter an option
    scene: options.SceneName,
    suite: Annotated[
        str,
        typer.Option(
            help="quick: some minutes; full: every key, half decades, four timesteps; "
            "own: engines' own derivatives by the release, beside differences of two steps."
        ),
    ] = "quick",
    engine: options.EngineNames = None,
    out: options.ReportFolder = None,
    figures: options.Figures = False,  # noqa: FBT002 - a switch of the command line
    json: options.Json = False,  # noqa: FBT002 - a switch of the command line
    *,
    running: run_options.RunOptions,
) -> None:
    """What an engine says a small change does, against the exact derivative.

    Central differences over eight decades of steps, at several timesteps, and an engine's own
    derivatives where it has them.

    For example: rockingcan gradients gentle-rock
    """
    stepping = (name for name in api.stepping_engines(engine) if name != "reference")
    plan = plan_gradients(load(scene), ("reference", *stepping), suite)
    show = shown({"-timesteps": (), "-summary": ()})
    absent = api.absent_engines(engine)
    study = GradientsStudy(plan=plan)
    run_command(study, running, out=out, json=json, figures=figures, absent=absent, show=show)
