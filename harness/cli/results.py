"""Commands on files of results: write one, verify some, compare two."""

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated

import typer
from rich.markup import escape

from harness import api
from harness.cli import options, run_options, terminal
from harness.cli.settings import engine_settings, settings_to_dict
from harness.cli.study_command import run_with_progress
from harness.engines.registry import engine_version
from harness.evaluation.effort import expected_seconds
from harness.evaluation.evaluation import Evaluation
from harness.execution.cache import CacheFolder
from harness.gate.spread import SIZES, measured, planned_members
from harness.progress import ItemBar
from harness.results.files import check_place, write_result
from harness.results.result import Result, input_digests, make_result
from harness.results.scores import scored
from harness.studies.comparison.study import ComparisonStudy, plan_comparison

_FOLDER = Path("reports/results")
"""Where results are written if nothing else is said."""

_PLACE = "name a file that you may write to with --out"

results = typer.Typer(no_args_is_help=True, help="Files of results: verify them, compare two.")


def result_of(
    study: ComparisonStudy, evaluations: Sequence[Evaluation], settings: Mapping[str, str]
) -> Result:
    """Return the result of a run, without any spread.

    Parameters
    ----------
    study : ComparisonStudy
    evaluations : sequence of Evaluation
        Of its cases, in their order.
    settings : mapping of str to str
        What the run put on top, by `engine.name`.
    """
    return make_result(
        study.suite,
        scored(study.designed, evaluations, settings),
        versions={e.simulation.case.engine: e.simulation.engine_version for e in evaluations},
        inputs=input_digests(case.scene for case in study.designed),
        settings=settings,
    )


def with_spread(
    study: ComparisonStudy,
    result: Result,
    running: run_options.RunOptions,
    store: CacheFolder | None = None,
) -> Result:
    """Return a result with the measured spread of each case, showing a progress bar.

    Parameters
    ----------
    study : ComparisonStudy
    result : Result
        Of its cases, in their order.
    running : RunOptions
    store : CacheFolder, optional
        Where perturbed runs are kept and found; nowhere if left out.
    """
    efforts = {
        case.label(): expected_seconds(study.cases[number])
        for number, case in planned_members(study.cases, result.cases)
    }
    with running.executor() as executor, ItemBar(efforts, "run", executor) as bar:
        bar.label("measuring the spread")
        cases = measured(study.cases, result.cases, executor, bar.advance, store=store)
    return result.model_copy(update={"cases": cases, "perturbed_by": SIZES})


@run_options.with_run_options
def submit(  # noqa: PLR0917 - a parameter an option
    engine: options.EngineName,
    suite: Annotated[
        str, typer.Option(help="quick: a minute or so; full: long ladders; field: what users ask.")
    ] = "quick",
    set_: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="ENGINE.KEY=VALUE",
            help="A setting on top of every case, which makes the division 'open'; repeat it.",
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(help=f"File of the result; {_FOLDER}/ENGINE-VERSION-SUITE.json if left out."),
    ] = None,
    name: Annotated[str, typer.Option(help="Who submits, for the leaderboard.")] = "",
    note: Annotated[str, typer.Option(help="What there is to say of it.")] = "",
    json: options.Json = False,  # noqa: FBT002 - a switch of the command line
    *,
    running: run_options.RunOptions,
) -> None:
    """A file of what an engine reaches in a suite, to publish.

    Every case of the suite is run and held against the exact motion; then runs whose release
    differs by 1e-9 or less tell how far each number may move. A run that was stopped goes on.

    For example: rockingcan submit --engine mujoco --name "A. Person" --note "as installed by pip"
    """
    (engine,) = engines = api.stepping_engines([engine])
    chosen = engine_settings(set_ or [], engines)
    study = plan_comparison(suite, engines, chosen)
    path = out or _FOLDER / _file_name(engine, suite)
    check_place(path.parent, _PLACE)
    done = run_with_progress(study, running)
    result = result_of(study, study.evaluations(done), settings_to_dict(chosen))
    result = with_spread(study, result, running, running.store)
    write_result(result.model_copy(update={"name": name, "note": note}), path, _PLACE)
    divisions = sorted({score.division.value for score in result.cases})
    finished = sum(score.finished for score in result.cases)
    if json:
        answer = {
            "file": str(path),
            "suite": suite,
            "engine": engine,
            "version": result.engines[engine].version,
            "divisions": divisions,
            "cases": len(result.cases),
            "finished": finished,
        }
        typer.echo(terminal.to_json(answer))
        return
    terminal.stdout_console().print(
        escape(
            f"{finished} of {len(result.cases)} cases reached their horizon; divisions: "
            f"{', '.join(divisions)}.\nThe result: {path}"
        )
    )


def _file_name(engine: str, suite: str) -> str:
    """Return the name of the file of a result."""
    version = re.sub(r"[^\w.+-]", "-", engine_version(engine))
    # an engine in an environment of its own often has its version in its name
    release = engine if engine.endswith(f"-{version}") else f"{engine}-{version}"
    return f"{release}-{suite}.json"
