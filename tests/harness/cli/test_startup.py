"""What a command imports: help, the version, scenes and mistakes are answered at once."""

import json
import subprocess
import sys
from importlib.metadata import version

import pytest

from harness.cli.commands import COMMANDS, OF_A_SCENE

HEAVY = frozenset(
    {"matplotlib", "mujoco", "pandas", "plotly", "pyarrow", "pybullet", "reference", "scipy"}
)

HELP_MAY_IMPORT = frozenset(
    {"harness", "models", "typer", "rich", "psutil", "lazy_loader", "pygments", "markdown_it"}
    | {"mdurl", "shellingham", "annotated_doc", "typing_extensions", "attr"}
)
"""Packages beyond Python's own: the command line, processes, and what they are made of."""

PROGRAM = """
import sys
before = set(sys.modules)
from contextlib import suppress
from harness.cli.main import code_of
code = code_of(sys.argv[1:])
import json
names = {name.partition(".")[0] for name in set(sys.modules) - before}
print(json.dumps([code, sorted(names - set(sys.stdlib_module_names))]), file=sys.stderr)
"""


def imported(*words: str) -> tuple[int, frozenset[str]]:
    """Return the exit code of a command, and the packages that it imports."""
    done = subprocess.run(  # noqa: S603 - our own program
        [sys.executable, "-c", PROGRAM, *words], capture_output=True, text=True, check=True
    )
    code, names = json.loads(done.stderr.splitlines()[-1])
    return code, frozenset(name for name in names if not name.startswith("_"))


PYDANTIC = frozenset({"pydantic", "pydantic_core", "annotated_types", "typing_inspection"})
"""What typer takes to say what is wrong."""


@pytest.mark.parametrize(
    ("words", "code", "more"),
    [(("--help",), 0, frozenset()), (("--version",), 0, frozenset()), (("validte",), 2, PYDANTIC)],
)
def test_help_imports_the_command_line_alone(
    words: tuple[str, ...], code: int, more: frozenset[str]
) -> None:
    found, packages = imported(*words)
    assert found == code
    assert packages <= HELP_MAY_IMPORT | more


@pytest.mark.parametrize(
    "words",
    [
        ("scenes",),
        ("run", "no-such-scene", "--engine", "mujoco"),
        ("reference", "no-such-scene"),
        ("cost", "no-such-scene"),
    ],
)
def test_scenes_and_wrong_scenes_need_no_engine(words: tuple[str, ...]) -> None:
    code, packages = imported(*words)
    assert code == (0 if words == ("scenes",) else 2)
    assert not packages & HEAVY


def test_the_exact_motion_needs_neither_tables_nor_engines() -> None:
    code, packages = imported("reference", "gentle-rock")
    assert code == 0
    assert not packages & (HEAVY - {"reference", "scipy"})


def test_the_version_is_that_of_the_package(capfd: pytest.CaptureFixture[str]) -> None:
    subprocess.run([sys.executable, "-m", "harness", "--version"], check=True)
    assert capfd.readouterr().out == f"rockingcan {version('rockingcan')}\n"


@pytest.mark.parametrize("command", COMMANDS, ids=lambda command: str(command.name))
def test_the_first_line_of_help_is_the_line_of_the_list(command: object) -> None:
    whole = command.imported()  # type: ignore[attr-defined]
    assert (whole.help or "").splitlines()[0] == command.help  # type: ignore[attr-defined]


def test_commands_of_a_scene_have_one_as_their_first_argument() -> None:
    first = {
        str(command.name)
        for command in COMMANDS
        for parameter in command.imported().params[:1]
        if parameter.param_type_name == "argument" and parameter.name == "scene"
    }
    assert first == OF_A_SCENE


def test_what_a_worker_unpickles_of_the_quick_suite_does_not_import_pandas() -> None:
    # each worker would take half a second for tables that the first process alone makes
    tasks = "import sys, harness.studies.comparison.rim, harness.evaluation.evaluate"
    program = f"{tasks}; sys.exit('pandas' in sys.modules)"
    subprocess.run([sys.executable, "-c", program], check=True)  # noqa: S603 - our own program
