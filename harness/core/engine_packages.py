"""Packages that engines need: which, whether they are installed, and the command that adds them.

An engine is an entry point of the group `rockingcan.engines`. If the package that registers it has
an extra of the engine's name, that extra lists what the engine needs. What the package does not
depend on anyway, in this Python, is optional: without it the engine is listed and takes no part.
"""

import re
import shlex
import shutil
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from importlib.metadata import (
    Distribution,
    EntryPoint,
    PackageNotFoundError,
    distribution,
    entry_points,
)
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from packaging.requirements import Requirement

ENGINE_ENTRY_POINTS = "rockingcan.engines"
"""Group of entry points under which packages register engines."""

PROGRAM = "rockingcan"
"""The package of this program."""


@dataclass(frozen=True, slots=True, kw_only=True)
class EnginePackages:
    """Packages that an engine needs beyond the one that registers it.

    Parameters
    ----------
    extra : str
        What pip installs them by, such as "package[engine]"; empty if there is no such extra.
    needed : tuple of str
    optional : tuple of str
        Those of `needed` that are not installed without the extra.
    elsewhere : str
        A version of Python in which they are installed without the extra, since this one has no
        wheel of them; empty if there is none.
    """

    extra: str = ""
    needed: tuple[str, ...] = ()
    optional: tuple[str, ...] = ()
    elsewhere: str = ""

    @property
    def missing(self) -> tuple[str, ...]:
        """The optional packages that are not installed."""
        return tuple(name for name in self.optional if not _is_installed(name))

    @property
    def absent(self) -> tuple[str, ...]:
        """The packages that are not installed, optional or not."""
        return tuple(name for name in self.needed if not _is_installed(name))


@cache
def packages_of(entry: EntryPoint) -> EnginePackages:
    """Return the packages of an engine, from the metadata of the package that registers it."""
    from packaging.requirements import Requirement  # noqa: PLC0415 - one engine by name needs none
    from packaging.utils import canonicalize_name  # noqa: PLC0415

    owner = entry.dist
    if owner is None or entry.name not in (owner.metadata.get_all("Provides-Extra") or ()):
        return EnginePackages()
    declared = [Requirement(line) for line in owner.requires or ()]
    always = {canonicalize_name(one.name) for one in declared if _applies(one, "")}
    needed = tuple(
        canonicalize_name(one.name)
        for one in declared
        if _applies(one, entry.name) and not _applies(one, "")
    )
    return EnginePackages(
        extra=f"{owner.name}[{entry.name}]",
        needed=needed,
        optional=tuple(name for name in needed if name not in always),
        elsewhere=_elsewhere([one for one in declared if canonicalize_name(one.name) in needed]),
    )


_PYTHONS = ("3.13", "3.12", "3.11")
"""Versions of Python for which packages have wheels."""


def _elsewhere(declared: "Iterable[Requirement]") -> str:
    """Return a version of Python in which any of these is required without an extra, not here."""
    for one in declared:
        if one.marker is not None and "extra" not in str(one.marker) and not _applies(one, ""):
            for version in _PYTHONS:
                if _applies(one, "", {"python_version": version}):
                    return version
    return ""


def requirements_of(
    entry: EntryPoint, python: Mapping[str, str] | None = None
) -> "tuple[Requirement, ...]":
    """Return what an engine needs beside this program, first the package that has its version.

    The last is the package of an adapter that is not of this program.

    Parameters
    ----------
    entry : EntryPoint
    python : mapping of str to str, optional
        Markers of another Python, such as "python_version"; those of this one if left out.
    """
    from packaging.requirements import Requirement  # noqa: PLC0415 - one engine by name needs none
    from packaging.utils import canonicalize_name  # noqa: PLC0415

    owner = entry.dist
    if owner is None:
        return ()
    declared = [Requirement(line) for line in owner.requires or ()]
    needed = [
        one
        for one in declared
        if one.marker is not None
        and "extra" in str(one.marker)
        and _applies(one, entry.name, python)
        and not _applies(one, "", python)
    ]
    # metadata have them in the order of the alphabet: the engine's own ends in its name
    needed.sort(key=lambda one: not canonicalize_name(one.name).endswith(entry.name))
    return (*needed, *(Requirement(f"{name}=={owner.version}") for name in _owner(entry)))


def _applies(
    requirement: "Requirement", extra: str, python: Mapping[str, str] | None = None
) -> bool:
    """Whether a requirement is installed with an extra, "" for none, in this Python or another."""
    marker = requirement.marker
    return marker is None or marker.evaluate({**(python or {}), "extra": extra})


def _is_installed(package: str) -> bool:
    try:
        distribution(package)
    except PackageNotFoundError:
        return False
    return True


def all_needed(
    names: Iterable[str], find: Callable[[str], Iterable[Distribution]]
) -> dict[str, Distribution]:
    """Return packages and all that they need in turn, as far as they are installed, by their names.

    Parameters
    ----------
    names : iterable of str
    find : callable
        Yields the distribution of a name, or nothing.
    """
    needed: dict[str, Distribution] = {}
    waiting = list(names)
    while waiting:
        name = waiting.pop()
        for installed in find(name):
            needed[name] = installed
            words = (word for word in installed.requires or () if "extra ==" not in word)
            required = (re.split(r"[^\w.-]", word, maxsplit=1)[0] for word in words)
            waiting += [word for each in required if (word := each.lower()) not in needed]
    return needed


@cache
def versions_behind(entry: EntryPoint) -> str:
    """Return the versions of all packages that an engine computes with, in a line."""
    found = all_needed(packages_of(entry).needed, _found)
    return ", ".join(f"{name} {installed.version}" for name, installed in sorted(found.items()))


def _found(name: str) -> Iterator[Distribution]:
    with suppress(PackageNotFoundError):
        yield distribution(name)


@cache
def engine_packages() -> tuple[str, ...]:
    """Return the packages of engines, installed or not, in the order of the engines.

    They are those that an engine needs, and the one that registers it if it is not this program.
    """
    entries = sorted(entry_points(group=ENGINE_ENTRY_POINTS), key=lambda entry: entry.name)
    return tuple(
        dict.fromkeys(
            name for entry in entries for name in (*_owner(entry), *packages_of(entry).needed)
        )
    )


def _owner(entry: EntryPoint) -> tuple[str, ...]:
    """Return the package that registers an engine; nothing if it is this program."""
    from packaging.utils import canonicalize_name  # noqa: PLC0415 - one engine by name needs none

    owner = "" if entry.dist is None else canonicalize_name(entry.dist.name)
    return () if owner in {"", PROGRAM} else (owner,)


def install_command(packages: Iterable[str]) -> str:
    """Return the command that installs packages into the environment of this program."""
    return f"{_pip()} install {shlex.join(packages)}"


def _pip() -> str:
    """Return the words that start the pip of this environment: "pip" where that is the one."""
    python, pip = Path(sys.executable), shutil.which("pip")
    if pip is not None and Path(pip).parent == python.parent:
        return "pip"
    here = Path.cwd()
    python = python.relative_to(here) if python.is_relative_to(here) else python
    return f"{shlex.quote(str(python))} -m pip"
