"""The commands: each reads its words, asks the library, and prints the answer."""

from pathlib import Path
from typing import Annotated

import typer

from harness.cli import terminal
from harness.cli.cache import app as store
from harness.cli.checkout_programs import PASSED_ON, benchmark, faults
from harness.cli.engines import check, engines_answer, print_engine, print_engines
from harness.cli.gate import diff
from harness.cli.json_output import reference_json, run_json, to_json
from harness.cli.model_answer import model_answer, sentences
from harness.cli.paper import audit, gallery, report
from harness.cli.run_options import parse_settings
from harness.cli.studies import attribute, cost, effects, errors, stability
from harness.cli.sweep import sweep
from harness.cli.terminal import check_motion_file, write_motion, write_text
from harness.cli.validate import validate
from harness.core.case import Case
from harness.core.errors import InvalidSettingError, ParityError
from harness.core.scene_limits import check_scene_limits
from harness.core.simulation import Outcome
from harness.engines.reference.truth import solve_case
from harness.evaluation.evaluate import evaluate, evaluate_without_truth
from models.catalogue import load, names
from models.mjcf import mjcf
from models.urdf import urdf

app = typer.Typer(
    name="rockingcan",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode="rich",
    help=(
        "How faithful is an engine's rolling contact? A drinks can, tipped on its rim, rocks down, "
        "turns by 209 degrees, half of it in 40 microseconds, and rises again. The mathematics is "
        "exact; this runs it in MuJoCo and PyBullet and says how far they are from it.\n\n"
        "Start with [bold]rockingcan validate[/], then open reports/latest/index.html."
    ),
)
for command in (
    validate,
    report,
    attribute,
    errors,
    check,
    audit,
    gallery,
    cost,
    diff,
    effects,
    stability,
    sweep,
):
    app.command()(command)
for command in (benchmark, faults):
    app.command(context_settings=PASSED_ON)(command)

app.add_typer(store, name="store")

SceneName = Annotated[
    str,
    typer.Argument(
        metavar="SCENE",
        help="A scene of the catalogue (see: rockingcan scenes) or the path of a scene file.",
    ),
]
Json = Annotated[
    bool, typer.Option("--json", help="Print one JSON object and nothing else on standard output.")
]


@app.command()
def scenes(json: Json = False) -> None:  # noqa: FBT002 - a switch of the command line
    """List the scenes of the catalogue: what each is, and where it comes from."""
    catalogue = [load(name) for name in names()]
    if json:
        _say(to_json({"scenes": [scene.to_dict() for scene in catalogue]}))
        return
    rows = []
    for scene in catalogue:
        horizon = scene.horizon
        ends = f"{horizon.seconds:g} s" if horizon.seconds else f"bounce {horizon.bounces}"
        release = scene.release
        rows.append(
            (
                scene.name,
                release.phi,
                release.psi_dot,
                release.theta_dot,
                ends,
                ", ".join(scene.effects.declared()) or "none",
                scene.cite,
            )
        )
    columns = ("scene", "phi_rad", "psi_dot_rad_s", "theta_dot_rad_s", "ends", "effects", "source")
    terminal.stdout_console().print(terminal.table("Scenes", columns, rows))


@app.command()
def engines(
    name: Annotated[
        str | None, typer.Argument(metavar="[ENGINE]", help="Show the settings of this engine.")
    ] = None,
    json: Json = False,  # noqa: FBT002 - a switch of the command line
) -> None:
    """List the engines, or the settings of one: what it ships with and what `matched` takes."""
    if json:
        _say(to_json(engines_answer(name)))
    elif name is None:
        print_engines()
    else:
        print_engine(name)


@app.command()
def reference(
    scene: SceneName,
    model: Annotated[
        str, typer.Option(help="Which equations; auto takes the smallest that carries the scene.")
    ] = "auto",
    method: Annotated[str, typer.Option(help="How they are integrated.")] = "auto",
    rtol: Annotated[float, typer.Option(help="Relative tolerance of the integrator.")] = 1e-12,
    json: Json = False,  # noqa: FBT002 - a switch of the command line
) -> None:
    """Solve a scene exactly: period, turn, peak rates, friction that rolling calls for."""
    options = (("model", model), ("method", method), ("rtol", rtol))
    case = Case(scene=load(scene), engine="reference", options=options)
    evaluation = evaluate_without_truth(case)
    simulation = evaluation.simulation
    known = simulation.trajectory is not None or simulation.outcome is Outcome.FINISHED
    found = solve_case(case, again=False) if known else None
    answer = reference_json(evaluation, found.bounces if found else ())
    answer |= model_answer(evaluation, found, model)
    if json:
        _say(to_json(answer))
    else:
        told = (*sentences(answer), *terminal.choices(answer))
        terminal.stdout_console().print(*terminal.motion(answer), *told, sep="\n")


@app.command()
def run(  # noqa: PLR0917 - a parameter an option
    scene: SceneName,
    engine: Annotated[str, typer.Option(help="Which engine (see: rockingcan engines).")],
    profile: Annotated[
        str,
        typer.Option(
            help="default: as it ships; matched: only what the scene declares; adaptive: own steps."
        ),
    ] = "matched",
    timestep: Annotated[
        float | None, typer.Option(help="In seconds; the profile's own if left out.")
    ] = None,
    set_: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="KEY=VALUE",
            help="A setting by the engine's own name (see: rockingcan engines ENGINE); repeat it.",
        ),
    ] = None,
    out: Annotated[
        Path | None, typer.Option(help="Write the motion here, as .csv or .parquet.")
    ] = None,
    json: Json = False,  # noqa: FBT002 - a switch of the command line
) -> None:
    """Run a scene in an engine and hold it against the exact motion.

    For example: rockingcan run gentle-rock --engine mujoco --timestep 1e-4 --set impratio=10
    """
    case = Case(
        scene=load(scene),
        engine=engine,
        profile=profile,
        timestep=timestep,
        options=parse_settings(set_ or []),
    )
    if out is not None:
        check_motion_file(out)
    evaluation = evaluate(case)
    simulation = evaluation.simulation
    if out is not None and evaluation.motion is not None:
        write_motion(evaluation.motion, out)
    if json:
        _say(to_json(run_json(evaluation)))
    else:
        console = terminal.stdout_console()
        if simulation.parity:
            console.print(terminal.parity(simulation.parity))
        if simulation.outcome is not Outcome.MISMATCH:
            answer = run_json(evaluation)
            told = (*terminal.divergence_sentences(answer), *terminal.choices(answer))
            console.print(*terminal.motion(answer), *told, sep="\n")
    if simulation.outcome is Outcome.MISMATCH:
        raise ParityError(case.label(), simulation.note)


@app.command()
def export(
    scene: SceneName,
    format_: Annotated[str, typer.Option("--format", help="mjcf or urdf.")],
    out: Annotated[
        Path | None, typer.Option(help="Write it here; to standard output if left out.")
    ] = None,
) -> None:
    """Write a scene as a model that an engine opens."""
    writers = {"mjcf": mjcf, "urdf": urdf}
    if format_ not in writers:
        raise InvalidSettingError("--format", format_, " or ".join(writers))
    chosen = load(scene)
    check_scene_limits(chosen)  # what overflows is no model
    text = writers[format_](chosen)
    if out is None:
        _say(text.rstrip("\n"))
    else:
        write_text(text, out)


def _say(text: str) -> None:
    """Print an answer as it is."""
    typer.echo(text)
