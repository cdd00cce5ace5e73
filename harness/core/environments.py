"""Interpreters in which engines live that cannot, or shall not, live in this one.

An environment is described by a small file, `NAME.json`, in a folder of the user. It is written
last, so that a half-made environment is never listed. What is installed in an environment is read
where it is, whenever it is asked for: somebody may have changed it since.

A worker is started in the interpreter of an environment, and knows whose it is.
"""

import hashlib
import json
import os
import re
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import asdict, dataclass
from importlib.metadata import Distribution
from pathlib import Path
from types import MappingProxyType
from typing import Any

from harness.core.engine_packages import all_needed
from harness.core.errors import BrokenEngineError

VARIABLE = "ROCKINGCAN_ENGINES"
"""Environment variable that names the folder of environments."""

DESCRIBED = ".json"

_ALWAYS = ("numpy", "scipy")
"""Packages, besides those of an engine, whose version may change a number."""

_NAME = re.compile(r"[A-Za-z0-9](?:[A-Za-z0-9._-]{0,98}[A-Za-z0-9])?")
"""At most 100 characters: files are named by it and more, and have names of 255 at most."""

SUBCOMMANDS = frozenset({"add", "list", "remove"})
"""Commands below `engines`."""

EVERY_ENGINE = "all"
"""Stands for every engine that is installed, where engines are named."""

RESERVED = SUBCOMMANDS | {EVERY_ENGINE}
"""Words of the command line, which no engine can have as its name."""

NAMES = "at most 100 letters, digits, and between them dots, dashes and underscores"
"""What the name of an environment consists of."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Environment:
    """An interpreter, and the engine that lives there.

    Parameters
    ----------
    name : str
        Of the engine, as it is known here.
    engine : str
        Name under which its adapter is registered.
    entry : str
        Entry point of the adapter, ``module:Class``.
    suffix : str
        What its label has after that of the engine: a version, or the chosen name in brackets.
    interpreter : str
        Path of the program.
    python : str
        Its version.
    paths : tuple of str
        Folders in which it finds packages.
    packages : tuple of str
        Packages of the engine.
    folder : str
        What was made for it, and is removed with it; empty for an interpreter that was there.
    command : str
        The command that adds it.
    """

    name: str
    engine: str
    entry: str
    suffix: str
    interpreter: str
    python: str
    paths: tuple[str, ...]
    packages: tuple[str, ...]
    folder: str
    command: str

    def to_json(self) -> str:
        """Return the environment as a file and a worker have it."""
        return json.dumps(asdict(self), indent=1, sort_keys=True) + "\n"

    @classmethod
    def from_json(cls, text: str) -> "Environment":
        """Return the environment of a text.

        Raises
        ------
        ValueError
            If it is none.
        """
        said: Any = json.loads(text)
        if not isinstance(said, dict) or set(said) != set(cls.__dataclass_fields__):
            raise ValueError("it is no description of an environment")
        words: dict[str, Any] = {k: tuple(v) if isinstance(v, list) else v for k, v in said.items()}
        return cls(**words)

    def versions(self) -> Mapping[str, str]:
        """Return the versions of Python, of the engine's packages and of numerical ones there."""
        found = {"python": self.python}
        for name in (*self.packages, *_ALWAYS):
            for installed in self._installed(name):
                found[name] = installed.version
        return MappingProxyType(found)

    def fingerprint(self) -> str:
        """Return 16 hexadecimal digits that name what computes there: versions, and builds.

        The packages of the engine count, and those that they need, by the digests of their files: a
        build of one's own often has the version of a release.
        """
        digest = hashlib.sha256(repr(sorted(self.versions().items())).encode())
        for name, installed in sorted(self._needed().items()):
            digest.update(f"{name} {installed.version}\n".encode())
            digest.update("\n".join(_files(installed)).encode())
        return digest.hexdigest()[:16]

    def _needed(self) -> dict[str, Distribution]:
        """Return the packages of the engine and all that they need, by their names."""
        return all_needed(self.packages, self._installed)

    def __str__(self) -> str:
        """Return the versions in a line."""
        return ", ".join(f"{name} {version}" for name, version in self.versions().items())

    def _installed(self, package: str) -> Iterator[Distribution]:
        """Yield the package as it is installed there, if it is."""
        yield from list(Distribution.discover(name=package, path=list(self.paths)))[:1]


def _files(installed: Distribution) -> list[str]:
    """Return the lines of files in the list of a package, but those that go with its place.

    Of a file without a digest, size and time of change are added.
    """
    found = []
    for line in (installed.read_text("RECORD") or "").splitlines():
        if line.startswith("..") or ".dist-info/" in line:
            continue
        found.append(line)
        if line.endswith(",,") and "__pycache__/" not in line:
            name = line.removesuffix(",,").strip('"')
            with suppress(FileNotFoundError):  # of no file nothing is computed
                seen = Path(str(installed.locate_file(name))).stat()
                found.append(f"{seen.st_size} {seen.st_mtime_ns}")
    return found


class EnvironmentFileError(BrokenEngineError):
    """A file among the descriptions of environments is none.

    Parameters
    ----------
    file : Path
    reason : str
    """

    def __init__(self, file: Path, reason: str) -> None:
        super().__init__(file.stem, "", reason)
        self.args = file, reason
        self.file, self.reason = file, reason

    def __str__(self) -> str:
        """Say what to do."""
        return (
            f"'{self.file}' describes no environment of an engine ({self.reason}); run: rockingcan "
            f"engines remove {self.file.stem}, and add it again"
        )


def environments_folder() -> Path:
    """Return the folder of environments: that of the variable, or of the user's data."""
    if chosen := os.environ.get(VARIABLE):
        return Path(chosen).absolute()
    data = os.environ.get("XDG_DATA_HOME", "")
    # a relative path is to be ignored, by the specification
    base = Path(data) if Path(data).is_absolute() else Path.home() / ".local" / "share"
    return base / "rockingcan" / "engines"


def is_name(name: str) -> bool:
    """Whether an environment can have a name."""
    return _NAME.fullmatch(name) is not None


def path_of(name: str) -> Path:
    """Return the path of the file that describes an environment."""
    return environments_folder() / f"{name}{DESCRIBED}"


def environment_names() -> tuple[str, ...]:
    """Return the names of all environments, sorted, broken or not."""
    try:
        listed = list(environments_folder().iterdir())
    except (FileNotFoundError, NotADirectoryError):
        return ()
    stems = (file.stem for file in listed if file.suffix == DESCRIBED)
    return tuple(sorted(stem for stem in stems if is_name(stem)))


def environment(name: str) -> Environment | None:
    """Return the environment of an engine; None if it has none, or this process is in it.

    Raises
    ------
    EnvironmentFileError
        If its description cannot be read.
    """
    own = this_environment()
    if (own is not None and own.name == name) or not is_name(name):
        return None
    path = path_of(name)
    try:
        found = Environment.from_json(path.read_text(encoding="utf-8"))
    except (FileNotFoundError, NotADirectoryError):
        return None
    except (OSError, ValueError, TypeError) as error:
        raise EnvironmentFileError(path, str(error)) from error
    if found.name != name:
        raise EnvironmentFileError(path, f"it is of '{found.name}'")
    return found


def environments() -> dict[str, Environment]:
    """Return the environments by the names of their engines, but those that cannot be read."""
    found = {}
    for name in environment_names():
        with suppress(EnvironmentFileError):  # which is told where the engine is asked for
            place = environment(name)
            if place is not None:
                found[name] = place
    return found


_own: Environment | None = None


def this_environment() -> Environment | None:
    """Return the environment that this process works for; None if it is no worker of one."""
    return _own


def work_for(chosen: Environment) -> None:
    """Have this process be a worker of an environment from now on."""
    global _own  # noqa: PLW0603 - what this process is, from its first moment to its last
    _own = chosen
