"""Commands that give an engine an interpreter of its own, list such engines and remove them."""

from pathlib import Path
from typing import Annotated

import typer
from rich.markup import escape

from harness.cli import terminal
from harness.cli.options import Json
from harness.core.environments import environment, environment_names, environments_folder
from harness.core.errors import BrokenEngineError
from harness.engines.make_environment import NewEnvironment
from harness.engines.new_environment import add_environment, remove_environment
from harness.engines.registry import engine, outside_range

environments = typer.Typer(no_args_is_help=True, help="Engines in interpreters of their own.")


@environments.command()
def add(  # noqa: PLR0917 - a parameter an option
    name: Annotated[
        str, typer.Argument(metavar="ENGINE", help="Any engine of `rockingcan engines`.")
    ],
    python: Annotated[
        str | None,
        typer.Option(help="Program to make it with, such as python3.12; this one if left out."),
    ] = None,
    version: Annotated[
        str | None, typer.Option(help="Of the engine's package; the newest if left out.")
    ] = None,
    called: Annotated[
        str | None,
        typer.Option("--name", help="For the engine in it; ENGINE-VERSION if left out."),
    ] = None,
    wheel: Annotated[
        list[Path] | None,
        typer.Option(
            help="A build of the engine's package; once more for each that it needs besides."
        ),
    ] = None,
    interpreter: Annotated[
        str | None,
        typer.Option(help="The Python of an environment that has the engine; it is left as it is."),
    ] = None,
    json: Json = False,  # noqa: FBT002 - a switch of the command line
) -> None:
    """Give an engine an interpreter of its own: another version, another Python, a build.

    It is an engine like any other from then on, under the name that is printed. One that the same
    command has made is kept, if nothing newer is to be had.

    For example: rockingcan engines add mujoco --version 3.5
    """
    new = NewEnvironment(
        engine=name,
        name=called,
        python=python,
        version=version,
        wheels=tuple(wheel or ()),
        interpreter=interpreter,
    )
    before = environment_names()
    added = add_environment(new, lambda words: typer.echo(words, err=True))
    if json:
        typer.echo(terminal.to_json(_answer(added.name)))
        return
    typer.echo(f"{'kept' if added.name in before else 'added'} '{added.name}': {added}")
    if outside := outside_range(added.name):
        typer.echo(f"not supported by the adapter: {outside}", err=True)


@environments.command("list")
def list_(json: Json = False) -> None:  # noqa: FBT002 - a switch of the command line
    """List the engines in interpreters of their own, and whether each answers."""
    answers = [_answer(name) for name in environment_names()]
    if json:
        folder = str(environments_folder())
        typer.echo(terminal.to_json({"folder": folder, "environments": answers}))
        return
    columns = ("engine", "adapter", "state", "versions", "interpreter")
    rows = [
        (
            *(answer["name"], answer["engine"], escape(answer["state"])),
            *(answer["versions"], answer["interpreter"]),
        )
        for answer in answers
    ]
    terminal.stdout_console().print(
        terminal.table(f"Engines in '{environments_folder()}'", columns, rows)
    )


@environments.command()
def remove(
    name: Annotated[str, typer.Argument(metavar="NAME", help="As `engines list` has it.")],
) -> None:
    """Remove an engine with what was made for it; an interpreter that was there stays."""
    remove_environment(name)
    typer.echo(f"removed '{name}'")


def _answer(name: str) -> dict[str, str]:
    """Return an environment as `--json` says it."""
    words = {"name": name, "engine": "", "state": "ok", "versions": "", "interpreter": ""}
    try:
        place = environment(name)
        if place is not None:
            words |= {"engine": place.engine, "versions": str(place)}
            words |= {"interpreter": place.interpreter, "command": place.command}
        engine(name)
    except BrokenEngineError as error:
        words["state"] = str(error)
    return words
