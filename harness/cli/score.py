"""The command that holds records of other programs against the exact motion."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.markup import escape

from harness.cli import options, terminal
from harness.cli.motions import motion_tables, run_json
from harness.cli.settings import parse_settings
from harness.core.case import Value
from harness.core.errors import InvalidSettingError
from harness.core.provenance import provenance
from harness.progress import report_progress
from harness.records import score as records
from harness.records.columns import mapping
from harness.records.convention import CHOICES, chosen_parts
from harness.records.score import UNKNOWN, Labels, Scored, understood_table
from harness.report.atomic_folder import check_writable
from harness.report.write import write_report
from harness.studies.comparison.study import comparison_report
from harness.studies.study import case_record
from models.catalogue import load

_PARTS = "; ".join(f"{part}={'|'.join(words)}" for part, words in CHOICES.items())


def score(  # noqa: PLR0917 - a parameter an option
    scene: options.SceneName,
    file: Annotated[
        list[Path], typer.Argument(metavar="FILE...", help="Records in CSV or Parquet.")
    ],
    name: Annotated[
        list[str] | None,
        typer.Option(help="Name of the program; the file's if left out. One for each file."),
    ] = None,
    version: Annotated[
        list[str] | None, typer.Option(help="Version of the program, one for all or each.")
    ] = None,
    timestep: Annotated[
        list[float] | None, typer.Option(help="In seconds, one for all or each.")
    ] = None,
    settings: Annotated[
        list[str] | None,
        typer.Option(metavar="KEY=VALUE", help="A setting of the program's; repeat it."),
    ] = None,
    column: Annotated[
        list[str] | None,
        typer.Option(
            metavar="OURS=THEIRS", help="A column of another name, such as x_mm=pos_x; repeat it."
        ),
    ] = None,
    convention: Annotated[
        list[str] | None,
        typer.Option(metavar="PART=WORD", help=f"What is known: {_PARTS}; repeat it."),
    ] = None,
    out: options.ReportFolder = None,
    figures: options.Figures = False,  # noqa: FBT002 - a switch of the command line
    json: options.Json = False,  # noqa: FBT002 - a switch of the command line
) -> None:
    """A motion that any program wrote, held against the exact one.

    Says what it understood of the file, which must start as the scene's release does.

    For example: rockingcan score gentle-rock motion.csv --name chrono --out reports/chrono
    """
    if out is not None:
        check_writable(out)
    chosen = load(scene)
    columns, parts = mapping(column or []), chosen_parts(convention or [])
    own = dict(parse_settings(settings or []))
    labels = _labels(file, name or [], version or [], timestep or [], own)
    scored = [
        records.score(chosen, path, each, columns=columns, convention=parts)
        for path, each in zip(file, labels, strict=True)
    ]
    evaluations = [each.evaluation for each in scored]
    page = None
    if out is not None:
        with report_progress() as progress:
            page = write_report(
                [*comparison_report(evaluations), *understood_table(scored)],
                out,
                title=f"rockingcan, {chosen.name}",
                cases=[case_record(each.simulation) for each in evaluations],
                provenance=provenance(),
                figures=figures,
                on_progress=progress,
            )
    if json:
        answers = [_answer(each) for each in scored]
        typer.echo(terminal.to_json(answers[0] if len(answers) == 1 else {"records": answers}))
        return
    for each in scored:
        _show(each)
    if page is not None:
        terminal.stdout_console().print(escape(f"\nThe report: {page}"))


def _labels(
    files: Sequence[Path],
    names: Sequence[str],
    versions: Sequence[str],
    timesteps: Sequence[float],
    settings: Mapping[str, Value],
) -> list[Labels]:
    """Return what is said of each file: one word for all, or one for each."""
    words: dict[str, list[Any]] = {}
    usual: dict[str, list[Any]] = {
        "--name": [path.stem for path in files],
        "--version": [UNKNOWN] * len(files),
        "--timestep": [None] * len(files),
    }
    for option, given in (("--name", names), ("--version", versions), ("--timestep", timesteps)):
        many = list(given) * (len(files) if len(given) == 1 else 1) or usual[option]
        if len(many) != len(files):
            allowed = f"one, or one for each of the {len(files)} files"
            raise InvalidSettingError(option, ", ".join(map(str, given)), allowed)
        words[option] = many
    labels = [
        Labels(name=name, version=version, timestep=step, settings=settings)
        for name, version, step in zip(*words.values(), strict=True)
    ]
    _check_different(labels)
    return labels


def _check_different(labels: Sequence[Labels]) -> None:
    """Refuse files that a report could not tell apart."""
    seen = set()
    for each in labels:
        if (each.name, each.timestep) in seen:
            step = "no timestep" if each.timestep is None else f"the timestep {each.timestep:g}"
            raise InvalidSettingError(
                "--name",
                each.name,
                f"a name of its own for each file, or a --timestep of its own for each file of one "
                f"name: two files have this name and {step}",
            )
        seen.add((each.name, each.timestep))


def _answer(scored: Scored) -> dict[str, Any]:
    """Return what `--json` prints of a record: the keys of `run`, and what was understood."""
    return run_json(scored.evaluation) | {
        "understood": list(scored.understood.said),
        "unknown": list(scored.unknown),
        "convention": scored.understood.convention.sentence(),
    }


def _show(scored: Scored) -> None:
    """Print a record for people."""
    console = terminal.stdout_console()
    simulation = scored.evaluation.simulation
    console.print(f"\n[bold]{escape(simulation.model)}[/], {escape(str(scored.path))}")
    for sentence in scored.understood.said:
        console.print(escape(f"  {sentence}"))
    console.print(terminal.parity(simulation.parity))
    console.print(*motion_tables(run_json(scored.evaluation)), sep="\n")
    for sentence in scored.unknown:
        console.print(escape(f"Not told: {sentence}."))
