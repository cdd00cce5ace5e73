"""Environments for tests: interpreters that see the packages of the tests, made in no time."""

import sys
from collections.abc import Sequence
from pathlib import Path
from venv import EnvBuilder

from harness.core.environments import Environment, path_of


def bare_environment(folder: Path, paths: Sequence[str]) -> str:
    """Make an environment without pip that finds packages in these folders; return its Python."""
    EnvBuilder(symlinks=True).create(folder)
    (site,) = folder.glob("lib/python*/site-packages")
    (site / "of_the_tests.pth").write_text("".join(f"{path}\n" for path in paths), "utf-8")
    return str(folder / "bin" / "python")


def packages_here() -> list[str]:
    """Return the folders in which this interpreter finds installed packages."""
    return [path for path in sys.path if path.endswith("site-packages")]


def planted(folder: Path, source: str) -> Environment:
    """Plant an engine `Toy` of another package where its interpreter alone finds it."""
    (folder / "toys").mkdir()
    (folder / "toys" / "toy_engine.py").write_text(source, encoding="utf-8")
    python = bare_environment(folder / "there", [*packages_here(), str(folder / "toys")])
    return described("toy-there", "toy_engine:Toy", python)


def described(name: str, entry: str, interpreter: str, **other: str) -> Environment:
    """Write the description of an environment, as `engines add` does, and return it."""
    words = {"engine": "mujoco", "suffix": "(toy)", "folder": "", "command": f"add {name}"} | other
    place = Environment(
        name=name,
        entry=entry,
        interpreter=interpreter,
        python=".".join(map(str, sys.version_info[:3])),
        paths=tuple(packages_here()),
        packages=("mujoco",),
        **words,
    )
    path_of(name).parent.mkdir(parents=True, exist_ok=True)
    path_of(name).write_text(place.to_json(), "utf-8")
    return place
