"""Which effects a scene calls for, what each costs, and what an engine adds of its own accord."""

import math
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.markup import escape

from harness import api
from harness.cli import terminal
from harness.cli.attribution import evaluations, report
from harness.cli.json_output import to_json
from harness.cli.run_options import RunOptions, with_run_options
from harness.core.case import Case
from harness.core.errors import InvalidSettingError
from harness.core.report_model import Table
from harness.evaluation.case_record import LOST
from harness.evaluation.timing import single_thread_executor, time_alone, untimed
from harness.execution.limits import Limits
from harness.execution.worker import LostTaskError
from harness.report.atomic_folder import check_writable
from harness.studies.effects.friction import friction, ladder
from harness.studies.effects.plan import EffectsPlan, effects_cases, plan_effects
from harness.studies.effects.report import EffectsResults, effects_report, effects_results
from harness.studies.effects.verdict import EffectStatus
from models.catalogue import load

_SHOWN = (
    "engine",
    "effect",
    "declared",
    "verdict",
    "steps_ratio",
    "constraint_rows_ratio",
    "cpu_ratio",
    "change_turn_deg",
    "strength",
    "why",
)


@with_run_options
def effects(  # noqa: PLR0917 - a parameter an option
    scene: Annotated[
        str, typer.Argument(metavar="SCENE", help="A scene of the catalogue, or a scene file.")
    ],
    engine: Annotated[
        list[str] | None, typer.Option(help="An engine to look at; repeat it. All if left out.")
    ] = None,
    timestep: Annotated[
        float | None, typer.Option(help="Of the engines, in seconds; their own if left out.")
    ] = None,
    assume: Annotated[
        list[str] | None,
        typer.Option(
            metavar="EFFECT.CONSTANT=VALUE",
            help="How strong an effect is that the scene does not declare, such as slip.mu=0.3.",
        ),
    ] = None,
    tolerance: Annotated[
        float, typer.Option(help="Degrees of turn below which a change does not count.")
    ] = 0.1,
    out: Annotated[Path | None, typer.Option(help="Write a report into this folder.")] = None,
    json: Annotated[  # noqa: FBT002 - a switch of the command line
        bool, typer.Option("--json", help="Print one JSON object and nothing else.")
    ] = False,
    *,
    running: RunOptions,
) -> None:
    """Say which effects a scene needs, which it lacks, what each costs, what engines impose.

    For example: rockingcan effects gentle-rock --assume slip.mu=0.3
    """
    if not (math.isfinite(tolerance) and tolerance > 0.0):
        raise InvalidSettingError("--tolerance", tolerance, "a positive number of degrees")
    movers = ("reference", *(n for n in api.stepping_engines(engine) if n != "reference"))
    words = tuple(_assumption(word) for word in assume or ())
    made = plan_effects(load(scene), movers, timestep=timestep, words=words, tolerance=tolerance)
    if out is not None:
        check_writable(out)
    cases, slippery = effects_cases(made), ladder(made.scene, movers, timestep)
    runs_done = evaluations(tuple(dict.fromkeys((*cases, *slippery.design))), running)
    came = {e.simulation.case for e in runs_done if e.simulation.outcome.name not in LOST}
    times = {case: untimed(case) for case in cases if case not in came}
    times |= _timed(tuple(case for case in cases if case in came), running.limits)
    found = effects_results(made, runs_done, times)
    artefacts = (*effects_report(found), *friction(slippery, found.evaluations))
    page = None if out is None else report(artefacts, runs_done, out, "effects")
    if json:
        typer.echo(to_json(_answer(made, found)))
        return
    console = terminal.stdout_console()
    for artefact in artefacts:
        if isinstance(artefact, Table) and artefact.name.endswith("-effects"):
            known = artefact.frame["verdict"] != EffectStatus.UNSUPPORTED.value
            shown = replace(artefact, frame=artefact.frame[known])
            console.print(terminal.table_artefact(shown, _SHOWN))
    for sentence in found.sentences:
        console.print(escape(sentence))
    if page is not None:
        console.print(f"\nThe report: {page}")


def _timed(cases: tuple[Case, ...], limits: Limits) -> dict[Case, dict[str, Any]]:
    """Return what each case takes, one after the other and nothing beside it."""
    with terminal.progress_bar() as bar, single_thread_executor(limits) as executor:
        task = bar.add_task("timing alone", total=len(cases))
        times = {}
        for case in cases:
            bar.update(task, description=f"timing alone: {case.label()[:60]}")
            try:
                times[case] = executor.submit(time_alone, case).result()
            except LostTaskError as error:
                times[case] = untimed(case, error)
            bar.advance(task)
        return times


def _assumption(word: str) -> tuple[str, float]:
    """Return the constant and the value of one assumption."""
    key, _, value = word.partition("=")
    try:
        return key, float(value)
    except ValueError:
        raise InvalidSettingError("--assume", word, "EFFECT.CONSTANT=NUMBER") from None


def _answer(made: EffectsPlan, found: EffectsResults) -> dict[str, Any]:
    """Return a study as `--json` says it."""
    return {
        "scene": made.scene.name,
        "declared": sorted(made.declared),
        "tolerance_deg": made.tolerance,
        "engines": {
            mover: {
                one.name: {
                    "declared": one.declared,
                    "verdict": one.verdict.value,
                    "why": one.why,
                    "changes": dict(one.changes),
                    "steps_ratio": found.prices[mover, one.name].steps,
                    "constraint_rows_ratio": found.prices[mover, one.name].constraint_rows,
                    "cpu_ratio": found.prices[mover, one.name].cpu,
                }
                for one in found.effects
                if one.mover == mover
            }
            for mover in made.engines
        },
        "sentences": list(found.sentences),
    }
