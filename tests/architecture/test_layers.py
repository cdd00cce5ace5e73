"""The shape of the code: who imports whom, how long a file is, what a file may not be called."""

import re
import shutil
import subprocess
import sys
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PACKAGES = ("harness", "models", "reference")
LONGEST = 400
"""Lines of a file; past it there is more than one idea in it."""

FOLDERS_OF_OTHERS = {".git", "__pycache__", "node_modules", "dist", "build", "_build", "latest"}


def files(*folders: str, suffixes: tuple[str, ...]) -> Iterator[Path]:
    """Yield the files of some folders, or of the whole project."""
    for folder in folders or (".",):
        for path in sorted((ROOT / folder).rglob("*")):
            parts = set(path.relative_to(ROOT).parts)
            hidden = any(part.startswith(".") and part != ".ci" for part in parts)
            known = path.is_file() and path.suffix in suffixes
            if known and not hidden and not parts & FOLDERS_OF_OTHERS:
                yield path


def test_the_import_contracts_are_kept() -> None:
    command = Path(sys.executable).parent / "lint-imports"
    found = str(command) if command.exists() else shutil.which("lint-imports")
    assert found, "import-linter is a dependency of the tests: pip install import-linter"
    done = subprocess.run(  # noqa: S603 - our own tool
        [found, "--no-cache"], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize("folder", [*PACKAGES, "tests"])
def test_no_file_is_longer_than_one_idea(folder: str) -> None:
    long = {
        str(path.relative_to(ROOT)): lines
        for path in files(folder, suffixes=(".py",))
        if (lines := len(path.read_text(encoding="utf-8").splitlines())) > LONGEST
    }
    assert long == {}


def test_no_file_is_called_after_nothing() -> None:
    called = re.compile(r"^(utils?|helpers?|common|misc|managers?)(_|$)|_(utils?|helpers?)$")
    nameless = [p for p in files(*PACKAGES, "tests", suffixes=(".py",)) if called.search(p.stem)]
    assert nameless == []


@pytest.mark.parametrize("folder", PACKAGES)
def test_every_module_says_what_it_is(folder: str) -> None:
    for path in files(folder, suffixes=(".py",)):
        text = path.read_text(encoding="utf-8")
        assert text.startswith(('"""', "# ")), path


def test_no_two_classes_of_the_harness_share_a_name() -> None:
    places = defaultdict[str, list[str]](list)
    for path in files("harness", suffixes=(".py",)):
        for name in re.findall(r"^class (\w+)", path.read_text(encoding="utf-8"), re.MULTILINE):
            places[name].append(str(path.relative_to(ROOT)))
    assert len(places) > 100
    assert {name: own for name, own in places.items() if len(own) > 1} == {}


# spelt in two parts so that this file does not find itself
PLACES = re.compile("/" + r"(home|root|work|tmp|Users)/\w|" + "file" + "://")
HOSTS = re.compile(
    r"(files\.python"
    r"hosted|test\.py"
    r"pi|arti"
    r"factory|/simp"
    r"le/?\b|index"
    r"-url)"
)


def test_the_project_knows_no_machine_and_no_index() -> None:
    suffixes = (".py", ".toml", ".md", ".txt", ".cfg", ".yml", ".yaml", ".xml", ".urdf", ".cff", "")
    for path in files(suffixes=suffixes):
        try:
            text = path.read_text(encoding="utf-8")
        except UnicodeDecodeError:
            continue
        for pattern in (PLACES, HOSTS):
            hit = pattern.search(text)
            assert hit is None, f"{path.relative_to(ROOT)}: {hit}"
