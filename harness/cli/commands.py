"""The tree of commands, each imported when it is called.

Help, `--version` and a misspelt command need the names and the first line of each command alone:
engines, scipy and pandas take seconds to import, and are imported by the commands that use them.
"""

from importlib import import_module
from importlib.metadata import version as version_of
from typing import Annotated, Any

import typer
from typer.core import TyperCommand, TyperGroup
from typer.main import get_command_from_info, get_group
from typer.models import CommandInfo

from harness.core.environments import SUBCOMMANDS

_PASSED_ON = {"ignore_unknown_options": True, "allow_extra_args": True, "help_option_names": []}
"""Settings of a command whose options, --help too, are those of the program that it starts."""


OF_A_SCENE = frozenset(
    {
        *("run", "reference", "sweep", "attribute", "errors", "cost", "effects", "gradients"),
        *("export", "score"),
    }
)
"""Commands of which the first argument is a scene."""


class DeferredCommand(TyperCommand):
    """A command of which the module is imported when it is called.

    Parameters
    ----------
    name : str
    module : str
        Below `harness.cli`; it has a function, or a tree of commands, of this name.
    panel : str
        Part of the help in which the command stands.
    summary : str
        First line of its help.
    """

    def __init__(self, name: str, module: str, panel: str, summary: str) -> None:
        super().__init__(name, help=summary, rich_help_panel=panel)
        self._module = module

    def make_context(
        self,
        info_name: str | None,
        args: list[str],
        parent: Any = None,  # noqa: ANN401 - a context of the library that typer is made of
        **extra: object,
    ) -> Any:  # noqa: ANN401
        """Return the context of the command itself, whose arguments are parsed here."""
        if self.name in OF_A_SCENE and args and not args[0].startswith("-"):
            from models.catalogue import load  # noqa: PLC0415 - help does without pydantic

            load(args[0])  # a wrong scene is refused before engines are imported
        if self.name == "engines" and args and args[0] in SUBCOMMANDS:
            tree = get_group(import_module("harness.cli.environments").environments)
            return tree.make_context(info_name, args, parent, **extra)
        return self.imported().make_context(info_name, args, parent, **extra)

    def imported(self) -> Any:  # noqa: ANN401 - a command or group of that library
        """Return the command itself."""
        name = str(self.name)
        found = getattr(import_module(f"harness.cli.{self._module}"), name)
        if isinstance(found, typer.Typer):
            group = get_group(found)
            group.name = name
            return group
        settings = _PASSED_ON if self._module == "checkout" else None
        info = CommandInfo(name=name, callback=found, context_settings=settings)
        return get_command_from_info(info, pretty_exceptions_short=True, rich_markup_mode="rich")


RUN, UNDERSTAND, GUARD, EXTEND = "Run", "Understand", "Guard", "Extend"

COMMANDS = tuple(
    DeferredCommand(name, module, panel, summary)
    for panel, module, name, summary in (
        (RUN, "validate", "validate", "A report on every engine and scene: the main job."),
        (RUN, "motions", "run", "One scene in one engine, held against the exact motion."),
        (RUN, "motions", "reference", "The exact motion in numbers, and the friction it needs."),
        (RUN, "score", "score", "A motion that any program wrote, held against the exact one."),
        (RUN, "sweep", "sweep", "A table, and maps, of a scene over its parameters."),
        (RUN, "scenes", "scenes", "The catalogue: what each scene is, and its source."),
        (UNDERSTAND, "studies", "attribute", "Which setting causes which part of an error."),
        (
            UNDERSTAND,
            "studies",
            "errors",
            "Model form, discretisation, solver: the error in parts.",
        ),
        (UNDERSTAND, "studies", "cost", "What accuracy costs in time, and settings to paste."),
        (
            UNDERSTAND,
            "studies",
            "stability",
            "How engines fail on hard cases, and at which timestep.",
        ),
        (
            UNDERSTAND,
            "accuracy",
            "tolerance",
            "Whether the error asked for is the error delivered.",
        ),
        (
            UNDERSTAND,
            "accuracy",
            "gradients",
            "What an engine says a small change does, against the exact derivative.",
        ),
        (UNDERSTAND, "studies", "effects", "Which effects a scene needs, lacks and gets unasked."),
        (UNDERSTAND, "studies", "probe", "Where an engine's colliders see a can on its rim."),
        (UNDERSTAND, "paper", "audit", "Every equation and number of the paper, checked."),
        (UNDERSTAND, "paper", "gallery", "Every figure of the paper, from our own solutions."),
        (UNDERSTAND, "reports", "report", "One page from the reports of several studies."),
        (GUARD, "reports", "diff", "What differs between two reports, case by case."),
        (GUARD, "results", "submit", "A file of what an engine reaches in a suite, to publish."),
        (GUARD, "results", "results", "Files of results: verify them, compare two."),
        (GUARD, "history", "history", "At which release of an engine its contact changed."),
        (GUARD, "checkout", "benchmark", "What the project claims about speed, measured."),
        (GUARD, "checkout", "faults", "What is lost when runs are killed, hang or fill the disk."),
        (GUARD, "catalogue", "store", "What is kept of runs: list it, verify it, prune it."),
        (EXTEND, "catalogue", "engines", "The engines, or the settings of one in each profile."),
        (EXTEND, "catalogue", "check", "Whether an adapter keeps its contract, clause by clause."),
        (
            EXTEND,
            "scenes",
            "export",
            "A scene as a model that an engine opens, or its exact motion.",
        ),
    )
)
"""In the order of the help."""


class Commands(TyperGroup):
    """The tree of commands."""

    def __init__(self, **settings: object) -> None:
        super().__init__(**settings)  # type: ignore[arg-type]
        self.commands = {str(command.name): command for command in COMMANDS}

    def list_commands(self, ctx: object) -> list[str]:  # noqa: ARG002 - as typer calls it
        """Return the names of the commands, in the order of the help."""
        return list(self.commands)


def _show_version(wanted: bool) -> None:  # noqa: FBT001 - typer calls it
    if wanted:
        typer.echo(f"rockingcan {version_of('rockingcan')}")
        raise typer.Exit


app = typer.Typer(
    name="rockingcan",
    cls=Commands,
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode="rich",
    help=(
        "How faithful is an engine's rolling contact? A drinks can, tipped on its rim, rocks down, "
        "turns by 209 degrees, half of it in 40 microseconds, and rises again. The mathematics is "
        "exact; this runs it in every engine installed and says how far each is from it.\n\n"
        "Start with [bold]rockingcan validate[/], then open reports/latest/index.html."
    ),
)


@app.callback()
def _options(
    version: Annotated[  # noqa: FBT002 - a switch of the command line, read by its callback
        bool,
        typer.Option("--version", callback=_show_version, is_eager=True, help="The version."),
    ] = False,
) -> None:
    pass
