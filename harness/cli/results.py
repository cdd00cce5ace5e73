"""Commands on files of results: write one, verify some, compare two."""

import os
import random
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any

import typer
from pydantic import TypeAdapter, ValidationError
from rich.markup import escape

from harness import api
from harness.cli import options, run_options, terminal
from harness.cli.reports import changes_record, show_changes
from harness.cli.settings import engine_settings, settings_to_dict
from harness.cli.study_command import run_with_progress
from harness.core.case import Value
from harness.core.errors import HarnessError, InvalidSettingError
from harness.engines.registry import engine_version
from harness.evaluation.case_cache import evaluation_cache
from harness.evaluation.effort import expected_seconds
from harness.evaluation.evaluation import Evaluation
from harness.execution.cache import CacheFolder
from harness.gate.comparison import differences
from harness.gate.errors import NoCommonCaseError
from harness.gate.report import SIDES, gate_report
from harness.gate.reruns import not_run_again, rerun_objections, sample
from harness.gate.spread import SIZES, measured, planned_members
from harness.progress import ItemBar
from harness.results.errors import MixedSuitesError, ResultsError
from harness.results.files import (
    check_place,
    read_result,
    read_scores,
    result_files,
    result_name,
    write_result,
)
from harness.results.plausibility import Objection, Rule, objections
from harness.results.result import Result, input_digests, make_result
from harness.results.scores import Division, Line, scored
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
    kept = None if store is None else evaluation_cache(store)
    efforts = {
        case.label(): 0.0 if kept and kept.has(case) else expected_seconds(study.cases[number])
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
        str,
        typer.Option(
            help="quick: a minute or so; full: long ladders; field: what users ask; "
            "contact: impacts, and a contact that gives way."
        ),
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
    for option, words in (("--name", name), ("--note", note)):
        _check_line(option, words)
    settings = settings_to_dict(chosen)
    path = out or _FOLDER / result_name(engine, engine_version(engine), suite, settings)
    check_place(path.parent, _PLACE)
    done = run_with_progress(study, running)
    result = result_of(study, study.evaluations(done), settings)
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


def _check_line(option: str, words: str) -> None:
    """Refuse words that a result cannot have before anything runs."""
    try:
        TypeAdapter(Line).validate_python(words)
    except ValidationError as error:
        raise InvalidSettingError(option, words, "words on one line") from error


@results.command()
def verify(  # noqa: PLR0917 - a parameter an option
    place: Annotated[
        list[Path],
        typer.Argument(metavar="FOLDER_OR_FILE...", help="Files of results, or folders of them."),
    ],
    rerun: Annotated[
        str,
        typer.Option(
            metavar="N", help="Cases of each file that are run again, or 'all'; 0 for none."
        ),
    ] = "3",
    seed: Annotated[
        int | None,
        typer.Option(min=0, help="Of the draw of these cases; a new one each time if left out."),
    ] = None,
    jobs: options.Jobs = None,
    time_limit: options.TimeLimit = None,
    memory_limit: options.MemoryLimit = None,
    json: options.Json = False,  # noqa: FBT002 - a switch of the command line
) -> None:
    """Check files of results, and run some cases again. Leaves with 1 if one does not hold.

    Schema, scenes, digests and what no run can have are checked of every file; cases are run again
    where the engine is installed in the version of the file. Which cases, is drawn anew each time.

    For example: rockingcan results verify reports/results --rerun 5
    """
    count = _rerun_count(rerun)
    workers = jobs or len(os.sched_getaffinity(0))
    limits = run_options.limits_of(workers, time_limit, memory_limit)
    running = run_options.RunOptions(jobs=workers, on=None, limits=limits, store=None)
    # of the system: whoever knew the seed could know the cases
    seed = random.SystemRandom().randrange(2**32) if seed is None else seed
    reports = [_verified(path, count, seed, running) for path in result_files(place)]
    failed = sum(bool(report["objections"]) for report in reports)
    if json:
        typer.echo(terminal.to_json({"files": reports, "failed": failed, "seed": seed}))
    else:
        for report in reports:
            terminal.stdout_console().print(escape("\n".join(_verdict_lines(report))))
        if any(report["rerun"] for report in reports):
            terminal.stdout_console().print(f"the same cases again: --rerun {rerun} --seed {seed}")
    if failed:
        raise typer.Exit(1)


def _rerun_count(words: str) -> int | None:
    """Return how many cases are run again; None for all."""
    if words == "all":
        return None
    if not words.isdecimal():
        raise InvalidSettingError("--rerun", words, "a number of cases, or 'all'")
    return int(words)


def _verified(
    path: Path, count: int | None, seed: int, running: run_options.RunOptions
) -> dict[str, Any]:
    """Return what `--json` prints of a file."""
    report: dict[str, Any] = {"file": str(path), "cases": 0, "rerun": [], "not_rerun": {}}
    try:
        result = read_result(path)
    except ResultsError as error:
        objection = Objection(rule=Rule.FILE, text=str(error))
        return report | {"objections": [_objection_record(objection)]}
    on_top, unknown = settings_on_top(result)
    found = list(objections(result, on_top))
    again = sample(result, on_top, count, seed=seed)
    if again:
        efforts = {case.label(): expected_seconds(case) for _, case in again}
        with running.executor() as executor, ItemBar(efforts, "run", executor) as bar:
            bar.label("running again")
            found += rerun_objections(result, again, executor, bar.advance)
    return report | {
        "cases": len(result.cases),
        "rerun": [score.identity.label() for score, _ in again],
        "not_rerun": not_run_again(result, on_top) | unknown,
        "objections": [_objection_record(objection) for objection in found],
    }


def settings_on_top(result: Result) -> tuple[dict[str, dict[str, Value]], dict[str, str]]:
    """Return the settings of a result by engine and name, and why those of others are unknown."""
    settings: dict[str, dict[str, Value]] = {}
    unknown: dict[str, str] = {}
    for name in result.engines:
        pairs = [f"{k}={v}" for k, v in result.settings.items() if k.rpartition(".")[0] == name]
        try:
            settings |= engine_settings(pairs, [name])
        except HarnessError as error:  # what an engine takes, it says itself
            unknown[name] = str(error)
    return settings, unknown


def _objection_record(objection: Objection) -> dict[str, str]:
    return {"rule": objection.rule.value, "case": objection.case, "text": objection.text}


def _verdict_lines(report: Mapping[str, Any]) -> Iterator[str]:
    """Yield the lines on a file: a summary, what was not run again, and what is wrong."""
    again, wrong = len(report["rerun"]), report["objections"]
    head = f"{report['file']}: {report['cases']} cases, {again} of them run again"
    yield f"{head}: {len(wrong)} do not hold" if wrong else f"{head}: nothing found"
    for engine, reason in report["not_rerun"].items():
        yield f"  not run again: {engine}: {reason}"
    for one in wrong:
        yield f"  not {one['rule']}: {one['case'] and one['case'] + ': '}{one['text']}"


@results.command()
def compare(
    a: Annotated[Path, typer.Argument(metavar="A", help="A file of results.")],
    b: Annotated[Path, typer.Argument(metavar="B", help="The same, to hold against it.")],
    json: options.Json = False,  # noqa: FBT002 - a switch of the command line
) -> None:
    """What differs between two results of one suite, division by division.

    The rule is that of `diff`. Cases as shipped, matched and with settings of the submitter's own
    are never held against each other.

    For example: rockingcan results compare before.json after.json
    """
    first, second = read_scores(a), read_scores(b)
    if first.suite != second.suite:
        raise MixedSuitesError(suites=(first.suite, second.suite))
    pairs = {each: (first.of_division(each), second.of_division(each)) for each in Division}
    both = {each: pair for each, pair in pairs.items() if set(pair[0].scores) & set(pair[1].scores)}
    if not both:
        raise NoCommonCaseError(a=a, b=b)
    records = {}
    for division, (one, other) in both.items():
        compared = differences(one, other)
        records[division.value] = changes_record(compared, one, other)
        if not json:
            terminal.stdout_console().print(f"\n[bold]Division: {division.value}[/]")
            show_changes(gate_report(compared, one, other, SIDES))
    if json:
        typer.echo(terminal.to_json({"divisions": records}))
