"""Making an environment: an interpreter with the core dependencies of this program, and an engine.

The program itself is not installed there: a worker runs the sources that run here. numpy and scipy
are of the versions here, where the engine allows it, so that bits are equal.
"""

import json
import os
import re
import shlex
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from importlib.metadata import EntryPoint, distribution
from importlib.util import find_spec
from pathlib import Path

from packaging.requirements import Requirement
from packaging.specifiers import SpecifierSet
from packaging.utils import canonicalize_name, parse_wheel_filename
from packaging.version import Version

from harness.core.engine_packages import PROGRAM, engine_packages, requirements_of
from harness.core.errors import HarnessError, InvalidSettingError

_SHOW = "import json, sys; print(json.dumps([list(sys.version_info[:3]), sys.path]))"

_ALIKE = ("numpy", "scipy")
"""Packages that are to be of the versions here, since they compute."""


class UnmadeEnvironmentError(HarnessError, OSError):
    """An environment cannot be made.

    Parameters
    ----------
    engine : str
    reason : str
    """

    def __init__(self, engine: str, reason: str) -> None:
        super().__init__(engine, reason)
        self.engine, self.reason = engine, " ".join(reason.split())

    def __str__(self) -> str:
        """Return the reason."""
        return f"no environment is made for engine '{self.engine}': {self.reason}"


@dataclass(frozen=True, slots=True, kw_only=True)
class NewEnvironment:
    """What to make.

    Parameters
    ----------
    engine : str
        Name of an adapter that is registered here.
    name : str or None
        For the engine in its environment; its own and its version if left out.
    python : str or None
        Program to make the environment with; this one if left out.
    version : str or None
        Of the engine's package; the newest that the adapter supports if left out.
    wheels : tuple of Path
        A build of the engine's package, and of packages that it needs.
    interpreter : str or None
        An environment that exists, which has the engine and is left as it is.
    """

    engine: str
    name: str | None = None
    python: str | None = None
    version: str | None = None
    wheels: tuple[Path, ...] = ()
    interpreter: str | None = None

    def command(self) -> str:
        """Return the command line that makes it."""
        words = [self.engine]
        for option in ("name", "python", "version", "interpreter"):
            if (value := getattr(self, option)) is not None:
                words += [f"--{option}", value]
        for wheel in self.wheels:
            words += ["--wheel", str(wheel.absolute())]
        return f"rockingcan engines add {shlex.join(words)}"


@dataclass(frozen=True, slots=True)
class Interpreter:
    """An interpreter: its program, its version, and where it finds packages."""

    program: str
    version: str
    paths: tuple[str, ...]


def find_interpreter(option: str, named: str) -> Interpreter:
    """Return an interpreter that is named or lies somewhere; refuse one that cannot be used."""
    # not resolved: an environment is a link to the program of another
    found = shutil.which(os.path.expanduser(named))  # noqa: PTH111 - a name, if it has no slash
    if found is None:
        allowed = "a Python on the path, such as python3.12, or the path of one"
        raise InvalidSettingError(option, named, allowed)
    return _asked(option, str(Path(found).absolute()))


def _asked(option: str, program: str) -> Interpreter:
    """Return what an interpreter says of itself."""
    needed = SpecifierSet(distribution(PROGRAM).metadata["Requires-Python"] or "")
    try:
        done = _run([program, "-I", "-c", _SHOW])
        numbers, paths = json.loads(done.stdout) if done.returncode == 0 else ([], [])
    except (OSError, ValueError):
        numbers, paths = [], []
    version = ".".join(map(str, numbers))
    if not version or version not in needed:
        what = f"Python {needed}" + (f", and this is {version}" if version else "")
        raise InvalidSettingError(option, program, what)
    return Interpreter(program, version, tuple(path for path in paths if path))


def _run(words: Sequence[str]) -> "subprocess.CompletedProcess[str]":
    """Run a program to its end; what it says is text. Whatever it started ends with this one."""
    with subprocess.Popen(  # noqa: S603 - an interpreter that was named, and pip
        words,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        encoding="utf-8",
        errors="replace",
        process_group=0,
    ) as program:
        try:
            out, err = program.communicate()
        except BaseException:  # Ctrl-C too: pip works in a process that it starts
            os.killpg(program.pid, signal.SIGKILL)
            raise
    return subprocess.CompletedProcess(words, program.returncode, out, err)


def make_environment(
    new: NewEnvironment,
    entry: EntryPoint,
    base: Interpreter,
    folder: Path,
    say: Callable[[str], None],
) -> Interpreter:
    """Make an environment in a folder; return its interpreter."""
    refuse = partial(UnmadeEnvironmentError, new.engine)
    made = _run([base.program, "-I", "-m", "venv", "--without-pip", str(folder)])
    if made.returncode != 0:
        raise refuse(f"'{base.program}' cannot make one ({_last_line(made)})")
    python = _asked("--python", str(folder / "bin" / "python"))
    _pretend_to_be_installed(python)
    pip = _pip(base)
    if pip is None:
        raise refuse(
            f"neither this Python nor '{base.program}' has pip; run: {base.program} -m ensurepip"
        )
    wanted = _wanted(new, entry, python.version)
    say(f"{', '.join(wanted)} for Python {python.version}, into '{folder}'")
    install = [*pip, "--python", python.program, "install", "--quiet", "--no-input"]
    install += ["--disable-pip-version-check", *core_requirements(), *wanted]
    alike = folder / "constraints.txt"
    alike.write_text("".join(f"{name}=={distribution(name).version}\n" for name in _ALIKE))
    done = _run([*install, "--constraint", str(alike)])
    if done.returncode != 0:  # the engine may not go with these, or cannot be had at all
        done = _run(install)
        if done.returncode != 0:
            raise refuse(f"pip cannot install {', '.join(wanted)}: {_last_line(done)}")
        say(f"not with the versions of {' and '.join(_ALIKE)} here: bits may differ from others'")
    return python


def version_to_install(new: NewEnvironment, entry: EntryPoint, base: Interpreter) -> str:
    """Return the version of an engine that would be installed; empty if pip does not tell.

    Why it does not, it tells when it installs.
    """
    if new.version is not None:
        return new.version
    packages, pip = packages_for(entry), _pip(base)
    for wheel in new.wheels:
        name, version, *_ = parse_wheel_filename(wheel.name)
        if name == packages[0]:
            return str(version)
    if new.wheels or pip is None:
        return ""
    ask = [*pip, "--python", base.program, "install", "--dry-run", "--ignore-installed"]
    ask += ["--no-deps", "--quiet", "--no-input", "--disable-pip-version-check", "--report", "-"]
    done = _run([*ask, _wanted(new, entry, base.version)[0]])
    try:
        return str(json.loads(done.stdout)["install"][0]["metadata"]["version"])
    except (ValueError, LookupError):
        return ""


def released_versions(entry: EntryPoint, base: Interpreter) -> tuple[str, ...]:
    """Return the versions of an engine's package that have a wheel for a Python, the oldest first.

    Versions that are no releases are left out; empty if pip or the package index does not tell.
    """
    packages, pip = packages_for(entry), _pip(base)
    if not packages or pip is None:
        return ()
    ask = [*pip, "--python", base.program, "index", "versions", "--only-binary", ":all:"]
    done = _run([*ask, "--no-input", "--disable-pip-version-check", packages[0]])
    said = re.search(r"^Available versions:(.*)$", done.stdout, flags=re.MULTILINE)
    words = said[1].replace(",", " ").split() if said and done.returncode == 0 else ()
    return tuple(sorted(words, key=Version))


def _pretend_to_be_installed(python: Interpreter) -> None:
    """Leave word that this program is installed, so that no adapter has pip fetch another copy."""
    site = next(Path(path) for path in python.paths if path.endswith("site-packages"))
    version = distribution(PROGRAM).version
    word = site / f"{PROGRAM}-{version}.dist-info"
    word.mkdir()
    text = f"Metadata-Version: 2.1\nName: {PROGRAM}\nVersion: {version}\n"
    (word / "METADATA").write_text(text)
    (word / "RECORD").write_text("")


def _pip(base: Interpreter) -> list[str] | None:
    """Return the words that start a pip: that of this Python, or else of the other."""
    if find_spec("pip") is not None:
        return [sys.executable, "-m", "pip"]
    if _run([base.program, "-I", "-m", "pip", "--version"]).returncode == 0:
        return [base.program, "-I", "-m", "pip"]
    return None


def core_requirements() -> list[str]:
    """Return the requirements of this program that are no engine's."""
    engines = set(engine_packages())
    declared = [Requirement(line) for line in distribution(PROGRAM).requires or ()]
    return [
        str(one)
        for one in declared
        if (canonicalize_name(one.name) not in engines or one.name in _ALIKE)
        and (one.marker is None or "extra" not in str(one.marker))
    ]


def _wanted(new: NewEnvironment, entry: EntryPoint, python: str) -> list[str]:
    """Return what pip is to install of an engine in a Python; the first is what has the version."""
    wanted = []
    builds = {str(parse_wheel_filename(wheel.name)[0]): wheel for wheel in new.wheels}
    there = {"python_version": ".".join(python.split(".")[:2]), "python_full_version": python}
    for number, one in enumerate(requirements_of(entry, there)):
        extras = f"[{','.join(sorted(one.extras))}]" if one.extras else ""
        build = builds.pop(canonicalize_name(one.name), None)
        if build is not None:
            wanted.append(f"{one.name}{extras} @ {build.absolute().as_uri()}")
        elif new.version is not None and number == 0:
            wanted.append(f"{one.name}{extras}=={new.version}")
        else:
            wanted.append(f"{one.name}{extras}{one.specifier}")
    return wanted + [f"{name} @ {build.absolute().as_uri()}" for name, build in builds.items()]


def _last_line(done: "subprocess.CompletedProcess[str]") -> str:
    """Return the last line in which a program says what is wrong."""
    lines = [line.strip() for line in (done.stdout + "\n" + done.stderr).splitlines()]
    said = [line for line in lines if line and not line.startswith(("[notice]", "WARNING:"))]
    errors = [line for line in said if line.upper().startswith("ERROR:")]
    last = (errors or said or [f"code {done.returncode}"])[-1]
    return last.partition(":")[2].strip() if errors else last


def packages_for(entry: EntryPoint) -> tuple[str, ...]:
    """Return the packages of an engine and of its adapter, beside this program."""
    return tuple(dict.fromkeys(canonicalize_name(one.name) for one in requirements_of(entry)))
