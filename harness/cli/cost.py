"""What accuracy costs in time, and which settings buy it.

The report of what accuracy costs, with every case that was run for it.
"""

import hashlib
import math
from collections.abc import Callable, Iterator
from concurrent.futures import Executor
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.markup import escape
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from harness import api
from harness.cli import terminal
from harness.cli.json_output import to_json
from harness.cli.run_options import RunOptions, with_run_options
from harness.cli.terminal import write_text
from harness.core.case import Case
from harness.core.errors import InvalidSettingError
from harness.core.provenance import provenance
from harness.engines.base import features_of
from harness.engines.registry import engine as engine_of
from harness.engines.registry import export_settings
from harness.evaluation.case_record import LOST, lost_errors, measured
from harness.evaluation.evaluate import check_case
from harness.evaluation.step_overhead import case as aloft
from harness.evaluation.step_overhead import overhead
from harness.evaluation.timed_tasks import Record, Timed, records, run_timed_tasks
from harness.evaluation.timed_tasks import TaskProgress as Told
from harness.evaluation.timing import single_thread_executor, time_alone, untimed
from harness.execution.tasks import ResultCache
from harness.execution.worker import LostTaskError
from harness.report.atomic_folder import check_writable
from harness.report.write import write_report
from harness.studies.cost.design import (
    SUITES,
    CostPlan,
    error_cases,
    expected,
    plan_cost,
    timing_cases,
)
from harness.studies.cost.hard_tables import hard_command
from harness.studies.cost.points import Point
from harness.studies.cost.prices import TARGETS
from harness.studies.cost.report import cost_report as cost_report_report
from harness.studies.cost.results import CHOICES, FIXED, FOLLOWING, Cost
from harness.studies.cost.results import cost as put_together
from harness.studies.cost.tables import price_rows
from models.catalogue import load
from models.scene_text import write_scene


def cost_report(found: Cost, folder: Path) -> Path:
    """Write the report of a study and return its page."""
    return write_report(
        cost_report_report(found),
        folder,
        title=f"rockingcan, what accuracy costs: {found.plan.scene.name}",
        cases=[
            *(_case(point, point.command) for point in found.points),
            *(
                _case(point, hard_command(point))
                for _, ladders in found.hardness
                for _, ladder in ladders
                for point in ladder
            ),
        ],
        provenance=provenance(),
    )


def _case(point: Point, command: str) -> dict[str, str]:
    """Return a case as the manifest says it."""
    return {
        "digest": point.digest,
        "label": point.case.label(),
        "command": command,
        "engine": point.case.engine,
        "engine_version": point.version,
        "outcome": point.outcome.value,
    }


_TUNING = ("gentle-rock", "paper-release")
"""Where settings are chosen: on the first that is not the scene scored."""

_HARD = "paper-release"
"""Whose spin is turned up: the paper's own bounce is the hardest."""

_COLUMNS = (
    "target_deg",
    "engine",
    "verdict",
    "settings",
    "tied_with",
    "timestep_s",
    "error_deg",
    "cost_s_s",
    "relative_cost",
    "relative_to_engines",
)


@with_run_options
def cost(  # noqa: PLR0917 - a parameter an option
    scene: Annotated[
        str, typer.Argument(metavar="SCENE", help="A scene of the catalogue, or a scene file.")
    ],
    suite: Annotated[
        str, typer.Option(help="quick: two minutes; full: three decades, every hardness.")
    ] = "quick",
    target: Annotated[
        float | None,
        typer.Option(help="Degrees: print what buys this accuracy, ready to paste."),
    ] = None,
    out: Annotated[
        Path,
        typer.Option(help="Folder of the reports, one a scene."),
    ] = Path("reports/cost"),
    engine: Annotated[
        list[str] | None, typer.Option(help="An engine to price; repeat it. All if left out.")
    ] = None,
    tune: Annotated[
        str | None, typer.Option(help="Scene on which settings are chosen; another one.")
    ] = None,
    json: Annotated[  # noqa: FBT002 - a switch of the command line
        bool, typer.Option("--json", help="Print one JSON object and nothing else.")
    ] = False,
    *,
    running: RunOptions,
) -> None:
    """Say what accuracy costs: work-precision of every setting, a price list, settings to paste.

    Interrupted, it goes on where it was when started again.

    For example: rockingcan cost gentle-rock --target 0.1
    """
    if suite not in SUITES:
        raise InvalidSettingError("--suite", suite, " or ".join(SUITES))
    if target is not None and not (math.isfinite(target) and target > 0.0):
        raise InvalidSettingError("--target", target, "a positive number of degrees")
    chosen = load(scene)
    other = load(tune or next(name for name in _TUNING if name != chosen.name))
    engines = ("reference", *(n for n in api.stepping_engines(engine) if n != "reference"))
    made = plan_cost(chosen, other, engines, suite, load(_HARD))
    page_folder = out / made.scene.name
    check_writable(page_folder)
    found = measure(made, out, running)
    page = cost_report(found, page_folder)
    if json:
        typer.echo(to_json(_answer(found, target)))
        return
    _print(found, target)
    terminal.stdout_console().print(f"\nThe report: {page}")


def measure(made: CostPlan, out: Path, running: RunOptions) -> Cost:
    """Run what has not been run, keep it, and put it together.

    Parameters
    ----------
    made : Plan
    out : Path
        Holds the scenes of the ladder of hardness in `scenes`.
    running : Running
        Of the error runs; timing runs have one process here, and nothing beside them.
    """
    cases = error_cases(made)
    for case in cases:
        check_case(case)
    for hard in made.hardness:
        (out / "scenes").mkdir(parents=True, exist_ok=True)
        write_text(write_scene(hard.scene), out / "scenes" / f"{hard.scene.name}.toml")
    with _progress("errors") as told, running.executor() as executor:
        errors = run_timed_tasks(
            cases,
            measured,
            _records(running, "errors", measured),
            executor,
            lost=lost_errors,
            expected=expected,
            workers=running.jobs,
            on_done=told,
            on_kept=running.kept,
        )
    wanted = timing_cases(made)
    times = {case: untimed(case) for case in wanted if errors[case]["outcome"] in LOST}
    with _progress("timing alone") as told, single_thread_executor(running.limits) as executor:
        times |= run_timed_tasks(
            [case for case in wanted if case not in times],
            time_alone,
            _records(running, f"times-{_machine()}", time_alone),
            executor,
            lost=untimed,
            expected=expected,
            on_done=told,
            on_kept=running.kept,
        )
        overheads = {
            name: _overhead(aloft(made.scene, name), executor)
            for name in made.engines
            if features_of(engine_of(name)).open is not None
        }
    return put_together(made, errors, times, overheads)


def _overhead(case: Case, executor: Executor) -> Record:
    """Return what a step of an engine costs aloft; nothing of one that does not come back."""
    try:
        return executor.submit(overhead, case).result()
    except LostTaskError:
        return {"ways": {}}


def _records(
    running: RunOptions, kind: str, work: Callable[[Case], Record]
) -> ResultCache[Case, Timed] | None:
    """Return where the records of some work are kept."""
    return None if running.store is None else records(running.store, kind, work.__module__)


def _machine() -> str:
    """Return what tells the times of one processor from those of another."""
    return hashlib.sha256(provenance().processor.encode()).hexdigest()[:8]


@contextmanager
def _progress(words: str) -> Iterator[Callable[[Told], None]]:
    """Give what shows how far a campaign is, with the time that is left by its own account."""
    with Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TextColumn("{task.fields[left]}"),
        console=Console(stderr=True),
        transient=True,
    ) as bar:
        task = bar.add_task(words, total=None, left="")

        def show(progress: Told) -> None:
            bar.update(
                task,
                total=progress.total,
                completed=progress.done,
                left=f"about {_duration(progress.remaining_s)} left",
                description=f"{words}: {progress.case.label()[:60]}",
            )

        yield show


def _duration(seconds: float) -> str:
    """Return a time as one says it."""
    minute, hour = 60.0, 3600.0
    if seconds < minute:
        return f"{seconds:.0f} s"
    return f"{seconds / minute:.0f} min" if seconds < hour else f"{seconds / hour:.1f} h"


def _print(found: Cost, target: float | None) -> None:
    """Print the price list; for a target, what to paste as well."""
    console = terminal.stdout_console()
    for choice in CHOICES:
        rows = [
            row
            for one in ((target,) if target else TARGETS)
            for row in price_rows(found, choice, one)
        ]
        title = f"{found.plan.scene.name}: {choice}"
        if choice in {FIXED, FOLLOWING}:
            title += f" (on {found.plan.tuning_scene.name})"
        lines = [[row.get(name) for name in _COLUMNS] for row in rows]
        console.print(terminal.table(title, _COLUMNS, lines))
    for artefact in cost_report_report(found):
        if artefact.name.endswith("-overhead"):
            console.print(terminal.table_artefact(artefact, ("engine", "loop", "step_us")))  # type: ignore[arg-type]
    if target is None:
        console.print("The rules: the fairness contract in the report. To paste: --target DEGREES.")
        return
    for title, case in _to_paste(found, target).items():
        # not wrapped: it is to be copied
        console.print(f"\n[bold]{title}[/]\n{escape(case.command())}\n", soft_wrap=True)
        console.print(escape(export_settings(case)), soft_wrap=True)


def _to_paste(found: Cost, target: float) -> dict[str, Case]:
    """Return the cheapest tuned case of each engine, at a fixed step and at steps of its own."""
    chosen: dict[str, Case] = {}
    for name in found.plan.engines:
        for choice in (FIXED, FOLLOWING):
            price = found.price(name, choice, target)
            if price.winners:
                case = price.winners[0].point.case
                chosen.setdefault(
                    name if price.winners[0].point.timestep is None else f"{name}, {choice}", case
                )
            elif price.best is not None:
                best = f"{price.best.error:.2g} degrees"
                terminal.stdout_console().print(f"{name}, {choice}: not reached; best is {best}")
    return chosen


def _answer(found: Cost, target: float | None) -> dict[str, Any]:
    """Return the price list as `--json` says it."""
    targets = (target,) if target else TARGETS
    return {
        "scene": found.plan.scene.name,
        "tuned_on": found.plan.tuning_scene.name,
        "tuned": {f"{name}, {choice}": family for (name, choice), family in found.tuned.items()},
        "prices": [
            row | {"paste": _pasted(found, row)}
            for choice in CHOICES
            for one in targets
            for row in price_rows(found, choice, one)
        ],
    }


def _pasted(found: Cost, row: dict[str, Any]) -> str | None:
    """Return the settings of a row of the price list in the engine's own language."""
    price = found.price(row["engine"], row["choice"], row["target_deg"])
    return export_settings(price.winners[0].point.case) if price.winners else None
