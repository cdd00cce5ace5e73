"""Adding an environment for an engine to those that are listed, and removing it."""

import json
import os
import platform
import re
import shlex
import shutil
import sys
import time
import uuid
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import replace
from importlib.metadata import EntryPoint
from pathlib import Path

import psutil
from packaging.utils import InvalidWheelFilename, parse_wheel_filename
from packaging.version import InvalidVersion, Version

from harness.core.environments import (
    NAMES,
    RESERVED,
    VARIABLE,
    Environment,
    environment,
    environment_names,
    environments_folder,
    is_name,
    path_of,
)
from harness.core.errors import (
    BrokenEngineError,
    HarnessError,
    InvalidSettingError,
    UnknownEngineError,
)
from harness.core.writing import writing
from harness.engines.make_environment import (
    Interpreter,
    NewEnvironment,
    UnmadeEnvironmentError,
    core_requirements,
    find_interpreter,
    make_environment,
    packages_for,
    version_to_install,
)
from harness.engines.registry import (
    adapter_names,
    engine,
    entry_of,
    forget_engines,
    names,
)
from harness.engines.remote import RemoteEngine
from harness.execution.atomic_write import write_atomically
from harness.execution.source_fingerprint import sources_fingerprint
from models.errors import did_you_mean

_PATIENCE = 900.0
"""s that an engine may need to be made for the first time, such as to compile its kernels."""

_FOLDER = re.compile(r".+-(?P<process>\d+)-[0-9a-f]{8}")
"""Names of the folders that are made here: engine, process, and what makes it unlike any other."""

_MAKER = "rockingcan.json"
"""File in such a folder, of whoever makes it; a folder without it is not ours."""

_DAY = 86400.0
"""s: longer than an environment is ever made for."""


class UnknownEnvironmentError(HarnessError, LookupError):
    """No environment has this name."""

    def __init__(self, name: str, available: Sequence[str]) -> None:
        super().__init__(name, available)
        self.name, self.available = name, tuple(available)

    def __str__(self) -> str:
        """List what there is."""
        hint = did_you_mean(self.name, self.available)
        there = ", ".join(self.available) or "none"
        return f"no engine '{self.name}' lives in an environment{hint} there are: {there}"


def add_environment(new: NewEnvironment, say: Callable[[str], None]) -> Environment:
    """Make an environment for an engine, and have it listed once its engine answers.

    One that the same command has made of the same version is returned as it is.

    Parameters
    ----------
    new : NewEnvironment
    say : callable
        Is told what is being done, where that takes long.

    Raises
    ------
    UnknownEngineError
        If no adapter of that name is registered.
    InvalidSettingError
        If an option cannot be what it is.
    UnmadeEnvironmentError
        If the interpreter or pip fails, or the engine does not answer.
    WriteError
        If nothing can be written in the folder of environments.
    """
    _check(new)
    sources_fingerprint()  # of the sources that run: pip takes its time, and they may be edited
    entry = entry_of(new.engine)
    option, named = "--python", new.python or sys.executable
    if new.interpreter is not None:
        option, named = "--interpreter", new.interpreter
    base = find_interpreter(option, named)
    if new.name is None and (version := _version(new, entry, base)):
        name = f"{new.engine}-{_short(version)}"
        if there := _made_before(new, name):
            return there
        _check_name(new.engine, name)
    with _new_folder(new.engine) as folder:
        if new.interpreter is not None:
            return _listed(new, _described(new, entry, base, ""), folder)
        python = make_environment(new, entry, base, folder, say)
        return _listed(new, _described(new, entry, python, str(folder)), folder)


@contextmanager
def _new_folder(engine: str) -> Iterator[Path]:
    """Make a folder in that of environments, which goes unless an environment is made there.

    Raises
    ------
    WriteError
        If it cannot be made, or nothing written or linked there.
    """
    folder = environments_folder() / f"{engine}-{os.getpid()}-{uuid.uuid4().hex[:8]}"
    fix = f"name a folder in which files can be made and linked with {VARIABLE}"
    with writing(folder.parent, "an environment to", fix):
        try:
            folder.mkdir(parents=True)
            maker = {"host": platform.node(), "process": os.getpid()}
            (folder / _MAKER).write_text(json.dumps(maker), encoding="utf-8")
            (folder / "link").hardlink_to(folder / _MAKER)  # to know it before the work is done
            (folder / "link").unlink()
            _remove_leftovers()
            yield folder
        except BaseException:
            shutil.rmtree(folder, ignore_errors=True)
            raise
        if not (folder / "pyvenv.cfg").is_file():  # of an interpreter that was there
            shutil.rmtree(folder)


def _version(new: NewEnvironment, entry: EntryPoint, base: Interpreter) -> str:
    """Return the version that an engine will have; empty if it is not known before it is there."""
    if new.interpreter is None:
        return version_to_install(new, entry, base)
    return _described(new, entry, base, "").versions().get(packages_for(entry)[0], "")


def _made_before(new: NewEnvironment, name: str) -> Environment | None:
    """Return the environment of a name if the same command has made it, and its engine answers.

    A wheel may have been built anew meanwhile.
    """
    there = environment(name) if name in environment_names() else None
    if there is None or new.wheels or there.command != new.command():
        return None
    _ = engine(name).version
    return there


def remove_environment(name: str) -> None:
    """Remove an environment, broken or not; an interpreter that was not made for it stays.

    Raises
    ------
    UnknownEnvironmentError
        If there is none of that name.
    """
    if not is_name(name) or name not in environment_names():
        raise UnknownEnvironmentError(name, environment_names())
    with suppress(BrokenEngineError):  # the folder that it does not name is left over, and removed
        place = environment(name)
        if place is not None and Path(place.folder).parent == environments_folder():
            path_of(name).unlink(missing_ok=True)
            shutil.rmtree(place.folder, ignore_errors=True)
    path_of(name).unlink(missing_ok=True)
    _remove_leftovers()
    forget_engines()


def _check(new: NewEnvironment) -> None:
    """Refuse what cannot be made, before anything is."""
    if new.engine not in adapter_names():
        raise UnknownEngineError(new.engine, adapter_names())
    if not packages_for(entry_of(new.engine)):
        allowed = "an engine with packages of its own: " + ", ".join(
            name for name in adapter_names() if packages_for(entry_of(name))
        )
        raise InvalidSettingError("ENGINE", new.engine, allowed)
    given = {"python": new.python, "version": new.version, "wheel": (*new.wheels, None)[0]}
    for option, value in given.items():
        if new.interpreter is not None and value is not None:
            allowed = "nothing beside --interpreter, whose environment is left as it is"
            raise InvalidSettingError(f"--{option}", str(value), allowed)
    if new.wheels and new.version is not None:
        allowed = "nothing beside --wheel, which has a version"
        raise InvalidSettingError("--version", new.version, allowed)
    if new.version is not None:
        try:
            Version(new.version)
        except InvalidVersion:
            allowed = "a version of the engine's package, such as 1.58"
            raise InvalidSettingError("--version", new.version, allowed) from None
    _check_wheels(new.wheels, packages_for(entry_of(new.engine)))
    if new.name is not None:
        _check_name(new.engine, new.name)


def _check_wheels(wheels: Sequence[Path], packages: Sequence[str]) -> None:
    """Refuse what is no wheel, and wheels of which none is of an engine."""
    of_engine = False
    for wheel in wheels:
        try:
            of_engine |= parse_wheel_filename(wheel.name)[0] in packages
        except InvalidWheelFilename:
            raise InvalidSettingError("--wheel", str(wheel), "a file NAME-VERSION-...whl") from None
        if not wheel.is_file():
            raise InvalidSettingError("--wheel", str(wheel), "a file that exists")
    if wheels and not of_engine:
        allowed = f"a wheel of {' or '.join(packages)}, and beside it those of what it needs"
        raise InvalidSettingError("--wheel", str(wheels[0]), allowed)


def _check_name(engine: str, name: str) -> None:
    """Refuse a name that no engine can have, or that one has."""
    if not is_name(name):
        raise InvalidSettingError("--name", name, NAMES)
    if name in RESERVED:
        reason = f"the name '{name}' is a word of the command line; choose another with --name"
        raise UnmadeEnvironmentError(engine, reason)
    if name in names():
        first = f", or run first: rockingcan engines remove {name}"
        more = first if name in environment_names() else ""
        reason = f"the name '{name}' is taken; choose another with --name{more}"
        raise UnmadeEnvironmentError(engine, reason)


def _described(
    new: NewEnvironment, entry: EntryPoint, python: Interpreter, folder: str
) -> Environment:
    """Return an environment in which there is everything; its name may be another in the end."""
    return Environment(
        name=new.name or new.engine,
        engine=new.engine,
        entry=entry.value,
        suffix=f"({new.name})",
        interpreter=python.program,
        python=python.version,
        paths=python.paths,
        packages=packages_for(entry),
        folder=folder,
        command=new.command(),
    )


def _listed(new: NewEnvironment, place: Environment, folder: Path) -> Environment:
    """Ask the engine of an environment, and describe it in the folder of all.

    The description is written in a folder that is made for it.
    """
    provisional = replace(place, name=f"{place.name}-{uuid.uuid4().hex[:8]}")
    try:
        version = str(RemoteEngine(provisional, engine, _PATIENCE).version)
    except BrokenEngineError as error:
        reason = f"the engine does not answer ({getattr(error, 'reason', error)})"
        if not place.folder:  # what is missing may be what the program itself needs
            core = shlex.join([place.interpreter, "-m", "pip", "install", *core_requirements()])
            reason += f"; what it needs there beside its own packages: {core}"
        raise UnmadeEnvironmentError(new.engine, reason) from error
    if new.name is None:
        installed = place.versions().get(place.packages[0], version)
        short = _short(new.version or installed)
        place = replace(place, name=f"{new.engine}-{short}", suffix=short)
        _check_name(new.engine, place.name)
    draft = folder / "description"
    write_atomically(draft, place.to_json().encode())
    try:
        path_of(place.name).hardlink_to(draft)
    except FileExistsError:  # another program was faster
        _check_name(new.engine, place.name)
        raise
    finally:
        draft.unlink()
    forget_engines()
    return place


def _short(version: str) -> str:
    """Return a version as a name has it: two numbers, and more where they are not zero."""
    word = version.split(maxsplit=1)[0]
    parts = "".join(c if c.isalnum() or c in "._" else "-" for c in word).split(".")
    while len(parts) > 2 and parts[-1] == "0":  # noqa: PLR2004 - such as 4.0 of 4.0.0
        parts.pop()
    return ".".join(parts)


def _remove_leftovers() -> None:
    """Remove the folders of environments that programs have left which were killed meanwhile."""
    there = list(environments_folder().iterdir())  # first: others may be listed meanwhile
    try:
        used = _listed_folders()
    except BrokenEngineError:  # whatever its folder is, it may be mended by hand
        return
    for folder in there:
        if folder.name not in used and _is_left_over(folder):
            shutil.rmtree(folder, ignore_errors=True)


def _listed_folders() -> set[str]:
    """Return names of folders, those of all environments among them.

    The folder of all may be known by several paths, and its folders by one name.
    """
    found = (environment(name) for name in environment_names())
    return {part for place in found if place is not None for part in Path(place.interpreter).parts}


def _is_left_over(folder: Path) -> bool:
    """Whether a folder was made here, and whoever made it has gone."""
    name = _FOLDER.fullmatch(folder.name)
    try:
        maker = json.loads((folder / _MAKER).read_text(encoding="utf-8"))
        age = time.time() - (folder / _MAKER).stat().st_mtime
        host, process = str(maker["host"]), int(maker["process"])
    except (OSError, ValueError, TypeError, KeyError):  # it is of somebody else
        return False
    if name is None or int(name["process"]) != process:
        return False
    here = host == platform.node()
    return age > _DAY or (here and not psutil.pid_exists(process))
