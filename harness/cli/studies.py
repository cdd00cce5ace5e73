"""The commands of the studies: attribute, errors, effects, stability, cost.

Each turns its options into a study, and says which of its tables the terminal shows.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer
from rich.markup import escape

from harness import api
from harness.cli import options, run_options, terminal
from harness.cli.settings import parse_settings
from harness.cli.study_command import run_command, shown
from harness.cli.terminal import write_text
from harness.core.case import Case
from harness.core.errors import InvalidSettingError, MissingPackageError
from harness.core.report_model import Artefact, Table
from harness.engines.can_mesh import read_mesh
from harness.engines.ladder import takes_timestep
from harness.engines.registry import export_settings, timestep_of
from harness.report.atomic_folder import check_writable
from harness.studies.attribution.study import AttributionStudy
from harness.studies.comparison.rim import RimStudy
from harness.studies.cost.design import plan_cost
from harness.studies.cost.prices import CHOICES, FIXED, FOLLOWING, TARGETS, Cost
from harness.studies.cost.study import CostStudy
from harness.studies.cost.tables import prices
from harness.studies.effects.changes import EffectStatus
from harness.studies.effects.plan import plan_effects
from harness.studies.effects.study import EffectsStudy
from harness.studies.errors.plan import plan_errors
from harness.studies.errors.study import ErrorsStudy
from harness.studies.shared.ablation import ablation_path
from harness.studies.stability.study import StabilityStudy
from harness.studies.stability.suite import SUITES
from harness.studies.study import Results
from models.catalogue import load
from models.scene_file import write_scene


@run_options.with_run_options
def attribute(  # noqa: PLR0917 - a parameter an option
    scene: options.SceneName,
    engine: options.EngineName,
    timestep: Annotated[
        float | None, typer.Option(help="Of the matched end, in seconds; its own if left out.")
    ] = None,
    first: Annotated[
        list[str] | None,
        typer.Option(help="A gap to close before the others; repeat it. Such as: timestep."),
    ] = None,
    out: options.ReportFolder = None,
    figures: options.Figures = False,  # noqa: FBT002 - a switch of the command line
    json: options.Json = False,  # noqa: FBT002 - a switch of the command line
    *,
    running: run_options.RunOptions,
) -> None:
    """Which setting causes which part of an error.

    The gaps from default to matched are closed one after another, and each alone.

    For example: rockingcan attribute gentle-rock --engine mujoco
    """
    study = AttributionStudy(path=ablation_path(load(scene), engine, timestep, first or ()))
    left_out = {"share_of_whole", "what_it_does", "settings"}
    show = shown({"-gaps": left_out, "-interactions": (), "-attribution": ()})
    run_command(study, running, out=out, json=json, figures=figures, answer=study.answer, show=show)


@run_options.with_run_options
def errors(  # noqa: PLR0917 - a parameter an option
    scene: options.SceneName,
    engine: options.EngineName,
    profile: Annotated[str, typer.Option(help="default or matched.")] = "matched",
    timestep: Annotated[
        float | None,
        typer.Option(help="The coarsest of the ladder, in seconds; what suits if left out."),
    ] = None,
    set_: options.Settings = None,
    out: options.ReportFolder = None,
    figures: options.Figures = False,  # noqa: FBT002 - a switch of the command line
    json: options.Json = False,  # noqa: FBT002 - a switch of the command line
    *,
    running: run_options.RunOptions,
) -> None:
    """Model form, discretisation, solver: the error in parts.

    And what is not decidable.

    For example: rockingcan errors gentle-rock --engine mujoco --set solref=0.005,1
    """
    options = parse_settings(set_ or [])
    plan = plan_errors(load(scene), engine, profile, timestep=timestep, options=options)
    study = ErrorsStudy(plan=plan)
    of_split = {"timestep_s", "true", "value", "limit", "order_spread", "command"}
    of_spreads = {"timestep_s", "spread_of_error", "members"}
    show = shown({"-split": of_split, "-spreads": of_spreads, "-three-errors": ()})
    run_command(study, running, out=out, json=json, figures=figures, answer=study.answer, show=show)


_EFFECTS = (
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


@run_options.with_run_options
def effects(  # noqa: PLR0917 - a parameter an option
    scene: options.SceneName,
    engine: options.EngineNames = None,
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
    out: options.ReportFolder = None,
    figures: options.Figures = False,  # noqa: FBT002 - a switch of the command line
    json: options.Json = False,  # noqa: FBT002 - a switch of the command line
    *,
    running: run_options.RunOptions,
) -> None:
    """Which effects a scene needs, lacks and gets unasked.

    And what each costs in time, and changes of the turn.

    For example: rockingcan effects gentle-rock --assume slip.mu=0.3
    """
    if not (math.isfinite(tolerance) and tolerance > 0.0):
        raise InvalidSettingError("--tolerance", tolerance, "a positive number of degrees")
    engines = ("reference", *(n for n in api.stepping_engines(engine) if n != "reference"))
    words = tuple(_assumption(word) for word in assume or ())
    plan = plan_effects(load(scene), engines, timestep=timestep, words=words, tolerance=tolerance)
    study = EffectsStudy(plan=plan)
    absent = api.absent_engines(engine)
    run_command(
        study,
        running,
        out=out,
        json=json,
        figures=figures,
        answer=study.answer,
        absent=absent,
        show=_show_effects,
    )


def _show_effects(done: Results, artefacts: Sequence[Artefact]) -> None:
    """Print the effects that engines can represent, and the words."""
    known = [
        replace(
            a, shown=_EFFECTS, frame=a.frame[a.frame["verdict"] != EffectStatus.UNSUPPORTED.value]
        )
        if isinstance(a, Table) and "verdict" in a.columns
        else a
        for a in artefacts
    ]
    shown({"-effects": (), "-effects-words": ()})(done, known)


def _assumption(word: str) -> tuple[str, float]:
    """Return the constant and the value of one assumption."""
    key, _, value = word.partition("=")
    try:
        return key, float(value)
    except ValueError:
        raise InvalidSettingError("--assume", word, "EFFECT.CONSTANT=NUMBER") from None


@run_options.with_run_options
def stability(
    suite: Annotated[
        str, typer.Option(help="quick: about two minutes; full: every hard case.")
    ] = "quick",
    engine: options.EngineNames = None,
    out: options.ReplacedFolder = Path("reports/stability"),
    figures: options.Figures = False,  # noqa: FBT002 - a switch of the command line
    json: options.Json = False,  # noqa: FBT002 - a switch of the command line
    *,
    running: run_options.RunOptions,
) -> None:
    """How engines fail on hard cases, and at which timestep."""
    if suite not in SUITES:
        raise InvalidSettingError("--suite", suite, " or ".join(SUITES))
    engines = api.stepping_engines(engine)
    for name in engines:
        if not _takes_steps(name):
            able = ", ".join(each for each in api.stepping_engines(None) if _takes_steps(each))
            allowed = f"{able}: stability judges engines that move a can by steps"
            raise InvalidSettingError("--engine", name, allowed)
    study = StabilityStudy(suite=SUITES[suite], engines=engines)
    names = {"largest-timesteps": (), "random-scenes": (), "summary": ()}
    show = shown(names | {f"verdict-{name}": () for name in engines})
    absent = api.absent_engines(engine)
    done = run_command(
        study, running, out=out, json=json, figures=figures, absent=absent, show=show
    )
    if any(check.failure for checks in study.checks(done) for check in checks):
        raise typer.Exit(1)


def _takes_steps(name: str) -> bool:
    """Whether an engine takes timesteps or an accuracy; one whose package is missing may."""
    if not takes_timestep(name):
        return True
    try:
        return timestep_of(Case(scene=load("gentle-rock"), engine=name)) is not None
    except MissingPackageError:
        return True


@run_options.with_run_options
def probe(  # noqa: PLR0917 - a parameter an option
    engine: Annotated[
        str, typer.Argument(metavar="ENGINE", help="Any installed engine with contacts.")
    ],
    set_: options.Settings = None,
    mesh: Annotated[
        list[Path] | None,
        typer.Option(
            metavar="FILE",
            help="A closed mesh (OBJ, STL) of your can, its axis along z, in place of the engine's "
            "shapes: its hull is scaled to the can; repeat it.",
        ),
    ] = None,
    out: options.ReportFolder = None,
    figures: options.Figures = False,  # noqa: FBT002 - a switch of the command line
    json: options.Json = False,  # noqa: FBT002 - a switch of the command line
    *,
    running: run_options.RunOptions,
) -> None:
    """Where an engine's colliders see a can on its rim.

    Every detector, primitive and mesh that the engine offers, or the one that --set makes, is asked
    for its contact points: at tilts from 1e-12 to pi/2, turned, upside down, of other sizes and far
    from the origin.

    For example: rockingcan probe pybullet
    """
    paths = mesh or []
    alike = len({path.name for path in paths}) < len(paths)
    study = RimStudy(
        engines=(engine,),
        settings={engine: dict(parse_settings(set_ or []))},
        meshes={str(path) if alike else path.name: read_mesh(path) for path in paths},
    )
    show = shown({"rim-findings": {"engine"}, "rim-told": ()})
    run_command(study, running, out=out, json=json, figures=figures, answer=study.answer, show=show)


_TUNING = ("gentle-rock", "paper-release")
"""Where settings are chosen: on the first that is not the scene scored."""

_HARD = "paper-release"
"""Whose spin is turned up: the paper's own bounce is the hardest."""


@run_options.with_run_options
def cost(  # noqa: PLR0917 - a parameter an option
    scene: options.SceneName,
    suite: Annotated[
        str, typer.Option(help="quick: two minutes; full: three decades, every hardness.")
    ] = "quick",
    target: Annotated[
        float | None,
        typer.Option(help="Degrees: print what buys this accuracy, ready to paste."),
    ] = None,
    out: Annotated[Path, typer.Option(help="Folder of the reports, one a scene.")] = Path(
        "reports/cost"
    ),
    engine: options.EngineNames = None,
    tune: Annotated[
        str | None, typer.Option(help="Scene on which settings are chosen; another one.")
    ] = None,
    figures: options.Figures = False,  # noqa: FBT002 - a switch of the command line
    json: options.Json = False,  # noqa: FBT002 - a switch of the command line
    *,
    running: run_options.RunOptions,
) -> None:
    """What accuracy costs in time, and settings to paste.

    Work-precision of every setting, and a price list.

    Interrupted, it goes on where it was when started again.

    For example: rockingcan cost gentle-rock --target 0.1
    """
    if target is not None and not (math.isfinite(target) and target > 0.0):
        raise InvalidSettingError("--target", target, "a positive number of degrees")
    chosen = load(scene)
    other = load(tune or next(name for name in _TUNING if name != chosen.name))
    engines = ("reference", *(n for n in api.stepping_engines(engine) if n != "reference"))
    plan = plan_cost(chosen, other, engines, suite, load(_HARD))
    check_writable(out / chosen.name)
    for hard in plan.hardness:
        (out / "scenes").mkdir(parents=True, exist_ok=True)
        write_text(write_scene(hard.scene), out / "scenes" / f"{hard.scene.name}.toml")
    study = CostStudy(plan=plan, targets=(target,) if target else TARGETS)

    def show(done: Results, artefacts: Sequence[Artefact]) -> None:
        costs, console = study.findings(done), terminal.stdout_console()
        listed = prices(costs, study.targets)
        for choice in CHOICES:
            title = f"{chosen.name}: {choice}"
            if choice in {FIXED, FOLLOWING}:
                title += f" (on {other.name})"
            own = listed.frame[listed.frame["choice"] == choice]
            part = replace(listed, title=title, frame=own)
            console.print(terminal.table_artefact(part, {"choice", "case"}))
        shown({"-overhead": {"step_median_us"}})(done, artefacts)
        if target is None:
            console.print("The rules: the fairness contract in the report. To paste: --target DEG.")
        else:
            _print_settings(costs, target)

    folder, absent = out / chosen.name, api.absent_engines(engine)
    run_command(
        study,
        running,
        out=folder,
        json=json,
        figures=figures,
        answer=study.answer,
        absent=absent,
        show=show,
    )


def _print_settings(costs: Cost, target: float) -> None:
    """Print the cheapest tuned case of each engine, at a fixed step and at steps of its own."""
    console, seen = terminal.stdout_console(), set()
    for name in costs.plan.engines:
        for choice in (FIXED, FOLLOWING):
            price = costs.price(name, choice, target)
            if price.winners:
                point = price.winners[0].point
                title = name if point.timestep is None else f"{name}, {choice}"
                if title not in seen:  # not wrapped: it is to be copied
                    seen.add(title)
                    command, settings = point.case.command(), export_settings(point.case)
                    console.print(f"\n[bold]{title}[/]\n{escape(command)}\n", soft_wrap=True)
                    console.print(escape(settings), soft_wrap=True)
            elif price.best is not None:
                best = f"{price.best.error:.2g} degrees"
                console.print(f"{name}, {choice}: not reached; best is {best}")
