"""Help of each command: it begins with what one gets, and its examples are commands that parse."""

import inspect
import re
import shlex
from collections.abc import Iterator
from pathlib import Path

import pytest

from harness.cli.commands import COMMANDS, EXTEND, GUARD, RUN, UNDERSTAND, DeferredCommand
from tests.support.command_line import Command

ROOT = Path(__file__).parents[3]
BY_NAME = {str(command.name): command for command in COMMANDS}
PROGRAMS = {"benchmark", "faults"}
"""Commands whose help is that of a program of the source checkout."""


def sentences(shown: str) -> str:
    """Return what is shown in a terminal without its line breaks."""
    return " ".join(shown.split())


def examples(text: str) -> Iterator[list[str]]:
    """Yield the words of each example in the text of a help."""
    for example in re.findall(r"For example: (rockingcan .+?)(?=\n\s*\n|\Z)", text, re.DOTALL):
        yield shlex.split(example)


def check_parses(words: list[str]) -> None:
    """Raise what the command line would say of a command, the scene and all; nothing is run."""
    program, name, *arguments = words
    assert program == "rockingcan"
    BY_NAME[name].make_context(name, arguments)


@pytest.mark.parametrize(
    "command",
    [
        pytest.param(each, id=name, marks=pytest.mark.slow if name in PROGRAMS else ())
        for name, each in BY_NAME.items()
    ],
)
def test_every_command_teaches(
    rockingcan: Command, rockingcan_process: Command, command: DeferredCommand
) -> None:
    name = str(command.name)
    answer = (rockingcan_process if name in PROGRAMS else rockingcan)(name, "--help")
    assert (answer.code, answer.err) == (0, "")
    ((usage, text),) = re.findall(r"\A\s*Usage: (.+?)\n\s*\n(.+?)\n *╭", answer.out, re.DOTALL)
    assert usage.startswith(f"rockingcan {name} ")
    # the same sentence as in the list of commands
    assert sentences(text).startswith(str(command.help))
    assert str(command.help).endswith(".")
    for word in ("--help", *re.findall(r"(?<=--)\w+", usage)):
        assert word in answer.out


@pytest.mark.parametrize("command", COMMANDS, ids=BY_NAME)
def test_a_command_that_takes_an_argument_has_an_example_that_parses(
    command: DeferredCommand,
) -> None:
    name = str(command.name)
    found = command.imported()
    shown = list(examples(inspect.cleandoc(found.help or "")))
    for words in shown:
        assert words[1] == name
        check_parses(words)
    required = [one for one in found.params if one.required and one.param_type_name == "argument"]
    assert bool(shown) >= bool(required)


def test_an_example_with_a_wrong_option_would_be_noticed() -> None:
    (words,) = examples("For example: rockingcan run gentle-rock\n--engnie mujoco\n\nMore.")
    assert words == ["rockingcan", "run", "gentle-rock", "--engnie", "mujoco"]
    with pytest.raises(Exception, match="engnie"):
        check_parses(words)


def test_the_list_of_commands_has_all_of_them_with_what_one_gets(rockingcan: Command) -> None:
    answer = rockingcan("--help")
    assert (answer.code, answer.err) == (0, "")
    panels = re.findall(r"╭─ (\w+) ─.*?╰", answer.out, re.DOTALL)
    assert panels == ["Options", RUN, UNDERSTAND, GUARD, EXTEND]
    shown = sentences(answer.out.replace("│", " "))
    assert all(f"{command.name} {command.help}" in shown for command in COMMANDS)
    assert sentences(rockingcan().out) == sentences(answer.out)  # without a command: the same help


@pytest.mark.parametrize("folder", ["list", "verify", "prune"])
def test_every_command_of_the_store_teaches(rockingcan: Command, folder: str) -> None:
    answer = rockingcan("store", folder, "--help")
    assert (answer.code, answer.err) == (0, "")
    assert f"Usage: rockingcan store {folder} [OPTIONS]" in sentences(answer.out)


def test_the_commands_of_the_page_on_use_parse() -> None:
    text = (ROOT / "docs" / "how-to" / "use.md").read_text(encoding="utf-8")
    blocks = "\n".join(re.findall(r"```\n(.*?)```", text, flags=re.DOTALL))
    # what a command is for stands two spaces or more behind it
    lines = re.findall(r"^(rockingcan \w+.*?)(?=  |$| >)", blocks, flags=re.MULTILINE)
    assert len(lines) >= 7
    for line in lines:
        check_parses(shlex.split(line))
