"""Released versions of an engine, each installed in an environment of its own."""

from collections.abc import Iterable
from dataclasses import dataclass

from packaging.version import InvalidVersion, Version

from harness.core.environments import environments
from harness.core.errors import BrokenEngineError, HarnessError, InvalidSettingError
from harness.engines.make_environment import (
    NewEnvironment,
    UnmadeEnvironmentError,
    packages_for,
)
from harness.engines.new_environment import add_environment
from harness.engines.registry import engine, entry_of
from harness.execution.worker import LostTaskError
from harness.studies.study import Work

ALL = "all"
"""Stands for every release that the package index has a wheel of."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PackageRelease:
    """A version of an engine's package, which may have no wheel for the Python here.

    Parameters
    ----------
    engine : str
        Name of the adapter.
    version : str
    released : tuple of str
        Versions of which the package index has a wheel for the Python here; empty if unknown.
    """

    engine: str
    version: str
    released: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Installation:
    """What became of installing a release.

    Parameters
    ----------
    name : str
        Of the engine in its environment; empty if it could not be installed.
    reason : str
        Why it could not be.
    made : bool
        Whether the environment was made for it, and was not there before.
    """

    name: str = ""
    reason: str = ""
    made: bool = False


def install(release: PackageRelease) -> Installation:
    """Install a release in an environment of its own, unless there is one with it.

    A release of which there is no wheel is not built from its sources, which may take hours.
    """
    try:
        if name := _environment_of(release):
            _ = engine(name)
            return Installation(name=name)
        if release.released and release.version not in release.released:
            return Installation(reason="the package index has no wheel of it for this Python")
        new = NewEnvironment(engine=release.engine, version=release.version)
        return Installation(name=add_environment(new, lambda _: None).name, made=True)
    except (UnmadeEnvironmentError, BrokenEngineError) as error:
        return Installation(reason=error.reason)
    except HarnessError as error:
        return Installation(reason=str(error))


def _environment_of(release: PackageRelease) -> str:
    """Return the name of the environment that has a release from the index; empty if none has."""
    packages = packages_for(entry_of(release.engine))
    for name, place in environments().items():
        of_index = not any(f"--{word} " in place.command for word in ("wheel", "interpreter"))
        if place.engine == release.engine and packages and of_index:
            installed = place.versions().get(packages[0], "")
            if installed and Version(installed) == Version(release.version):
                return name
    return ""


def _lost(_: PackageRelease, error: LostTaskError) -> Installation:
    """Return the installation whose process was lost."""
    return Installation(reason=error.reason)


INSTALLING: Work[PackageRelease, Installation] = Work(
    name="installing",
    call=install,
    lost=_lost,
    label=lambda release: f"{release.engine} {release.version}",
    effort=lambda _: 30.0,
)
"""Install a release; nothing is cached, since an environment may be removed at any time."""


def parse_versions(text: str, released: Iterable[str]) -> tuple[str, ...]:
    """Return the versions of a list with commas, each once, the oldest first.

    Parameters
    ----------
    text : str
        Such as "3.2.0,3.3.0"; `ALL` for all that are released.
    released : iterable of str
        What `ALL` stands for. A version that is equal to one of them is spelt as it is there.

    Raises
    ------
    InvalidSettingError
        If there are not two versions at least, or one is no version.
    """
    known = {Version(version): version for version in released}
    allowed = f"two released versions or more, with commas between them, or '{ALL}'"
    if text.strip() == ALL:
        chosen = known
    else:
        try:
            named = [word.strip() for word in text.split(",") if word.strip()]
            chosen = {Version(word): known.get(Version(word), word) for word in named}
        except InvalidVersion:
            raise InvalidSettingError("--versions", text, allowed) from None
    if len(chosen) < 2:  # noqa: PLR2004 - a change is between two
        raise InvalidSettingError("--versions", text, allowed)
    return tuple(chosen[version] for version in sorted(chosen))
