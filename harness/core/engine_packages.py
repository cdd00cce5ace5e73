"""Packages that engines need: which, whether they are installed, and the command that adds them.

An engine is an entry point of the group `rockingcan.engines`. If the package that registers it has
an extra of the engine's name, that extra lists what the engine needs. What the package does not
depend on anyway, in this Python, is optional: without it the engine is listed and takes no part.
"""

import shlex
import shutil
import sys
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from importlib.metadata import EntryPoint, PackageNotFoundError, distribution, entry_points
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from packaging.requirements import Requirement

ENGINE_ENTRY_POINTS = "rockingcan.engines"
"""Group of entry points under which packages register engines."""


@dataclass(frozen=True, slots=True, kw_only=True)
class EnginePackages:
    """Packages that an engine needs beyond the one that registers it.

    Parameters
    ----------
    extra : str
        What pip installs them by, such as "rockingcan[mujoco]"; empty if there is no such extra.
    needed : tuple of str
    optional : tuple of str
        Those of `needed` that are not installed without the extra.
    """

    extra: str = ""
    needed: tuple[str, ...] = ()
    optional: tuple[str, ...] = ()

    @property
    def missing(self) -> tuple[str, ...]:
        """The optional packages that are not installed."""
        return tuple(name for name in self.optional if not _is_installed(name))


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
    )


def _applies(requirement: "Requirement", extra: str) -> bool:
    """Whether a requirement is installed in this Python with an extra; "" for none."""
    return requirement.marker is None or requirement.marker.evaluate({"extra": extra})


def _is_installed(package: str) -> bool:
    try:
        distribution(package)
    except PackageNotFoundError:
        return False
    return True


@cache
def engine_packages() -> tuple[str, ...]:
    """Return the packages that engines need, installed or not, in the order of the engines."""
    entries = sorted(entry_points(group=ENGINE_ENTRY_POINTS), key=lambda entry: entry.name)
    return tuple(dict.fromkeys(name for entry in entries for name in packages_of(entry).needed))


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
