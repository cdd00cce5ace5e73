"""An engine is one folder: nothing else of the harness names it, imports it, or its package."""

import ast
import re
from collections.abc import Iterator
from importlib.metadata import entry_points
from pathlib import Path

import pytest

from harness.core.engine_packages import ENGINE_ENTRY_POINTS, packages_of
from harness.engines.registry import description_of, our_names

HARNESS = Path(__file__).parents[2] / "harness"
NAMES = tuple(name for name in our_names() if name != "reference")
"""Engines; the reference is the truth, which the harness is about."""

EXAMPLE = re.compile(r"^\s*For example: rockingcan .*$", re.MULTILINE)
"""The line of a command's help that shows how it is used."""

LABEL = re.compile(r"\b(eq\d*|text):\w+")
"""Label of an equation or a passage of the paper, some of which hold the name of an engine."""


PHYSICISTS = {"newton"}
"""Engines that are called by a name of mechanics: they are meant where the name alone is quoted."""


def sources(*suffixes: str) -> Iterator[Path]:
    """Yield the files of the harness."""
    for path in sorted(HARNESS.rglob("*")):
        if path.suffix in suffixes:
            yield path


def folder(name: str) -> Path:
    """Return the folder of an engine, which two of one package may have in common."""
    (entry,) = entry_points(group=ENGINE_ENTRY_POINTS, name=name)
    return HARNESS.parent.joinpath(*entry.module.split(".")[:3])


def imports(path: Path) -> set[str]:
    """Return the modules that a file imports, wherever in it."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            found |= {node.module} | {f"{node.module}.{alias.name}" for alias in node.names}
    return found


def test_there_are_engines_to_look_for() -> None:
    assert {"mujoco", "pybullet"} <= set(NAMES)


@pytest.mark.parametrize("name", NAMES)
def test_nothing_beyond_its_folder_names_an_engine(name: str) -> None:
    folders = {folder(each) for each in our_names()}
    words = {name, description_of(name).label}
    named = re.compile(rf"(?<![a-z])({'|'.join(map(re.escape, words))})(?![a-z])", re.IGNORECASE)
    if name in PHYSICISTS:
        named = re.compile(rf"[\"']{name}[\"']")
    for path in sources(".py", ".html", ".jinja", ".css", ".js"):
        if folders.isdisjoint(path.parents):
            text = EXAMPLE.sub("", path.read_text(encoding="utf-8"))
            hit = named.search(LABEL.sub("", text))
            assert hit is None, f"{path.relative_to(HARNESS)}: {hit}"


@pytest.mark.parametrize("name", NAMES)
def test_only_its_folder_imports_an_adapter_and_its_package(name: str) -> None:
    own = folder(name)
    adapter = f"harness.engines.{own.name}"
    (entry,) = entry_points(group=ENGINE_ENTRY_POINTS, name=name)
    packages = {package.replace("-", "_") for package in packages_of(entry).needed}
    for path in sources(".py"):
        if own not in path.parents:
            taken = {m for m in imports(path) if m == adapter or m.startswith(f"{adapter}.")}
            taken |= {m for m in imports(path) if m.partition(".")[0] in packages}
            assert not taken, f"{path.relative_to(HARNESS)} imports {', '.join(sorted(taken))}"


@pytest.mark.parametrize("name", NAMES)
def test_an_adapter_imports_all_that_it_needs_from_one_path(name: str) -> None:
    """But for what is printed while a package is loaded, and what describes it without loading."""
    own = f"harness.engines.{folder(name).name}"
    for path in folder(name).rglob("*.py"):
        beside = {"harness.engines.suppress_output"}
        if path.name == "__init__.py":
            beside |= {"harness.core.public_paths", "harness.engines.description"}
        modules = {
            node.module
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
            if isinstance(node, ast.ImportFrom) and node.module
        }
        taken = {
            m for m in modules if m.startswith("harness.") and not f"{m}.".startswith(f"{own}.")
        }
        assert taken <= {"harness.engines"} | beside, path.relative_to(HARNESS)


@pytest.mark.parametrize("name", NAMES)
def test_no_adapter_knows_the_reference(name: str) -> None:
    for path in folder(name).rglob("*.py"):
        taken = [m for m in imports(path) if re.match(r"(harness\.engines\.)?reference\b", m)]
        assert taken == [], path


@pytest.mark.parametrize("name", NAMES)
def test_an_engine_of_ours_describes_itself_without_its_package(name: str) -> None:
    said = description_of(name)
    assert said.label
    assert said.light.startswith("#")
    assert said.dark.startswith("#")
