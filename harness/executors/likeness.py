"""What a machine computes with: machines that say the same of themselves make the same bits.

A version does not change while somebody edits a checkout, so sources are compared as text. A
processor of the same kind is taken to compute alike.
"""

import platform
import sys
from collections.abc import Callable, Iterator, Mapping
from functools import cache
from importlib.metadata import EntryPoint, PackageNotFoundError, entry_points, version
from typing import ParamSpec, TypeVar

from harness.engines.registry import GROUP
from harness.errors import ClusterError
from harness.store.code import fingerprint

P = ParamSpec("P")
T = TypeVar("T")

_SOURCES = "sources of rockingcan"
_PACKAGES = ("numpy", "scipy", "mujoco", "pybullet")
_IN_SOURCES = frozenset({"numpy", "scipy"})
"""What a fingerprint of sources holds besides them: while these differ, it says nothing more."""

_OURS = "harness"
_NONE = "none"

REMEDY = "have the same there as here, and start the workers again"


def likeness() -> dict[str, str]:
    """Return what this process computes with, by what it is."""
    return dict(_likeness())


@cache
def _likeness() -> tuple[tuple[str, str], ...]:
    return (
        ("rockingcan", _version("rockingcan")),
        (_SOURCES, fingerprint(_OURS)),
        ("Python", f"{sys.version_info.major}.{sys.version_info.minor}"),
        ("platform", f"{platform.system()} {platform.machine()}"),
        *((name, _version(name)) for name in _PACKAGES),
        *_engines(),
    )


def _engines() -> Iterator[tuple[str, str]]:
    """Yield engines of others, without making them: their package's version and sources."""
    for entry in sorted(entry_points(group=GROUP), key=lambda entry: entry.name):
        package = entry.value.partition(":")[0].partition(".")[0]
        if package != _OURS:
            yield f"engine {entry.name}", f"{_origin(entry)} {fingerprint(package)}"


def _origin(entry: EntryPoint) -> str:
    return "unknown" if entry.dist is None else f"{entry.dist.name} {entry.dist.version}"


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return _NONE


def differences(there: Mapping[str, str], here: Mapping[str, str]) -> list[str]:
    """Return in words what differs; engines that only one of both has cannot give other results."""
    both = [key for key in here if key in there and here[key] != there[key]]
    if _IN_SOURCES & set(both):
        both = [key for key in both if key != _SOURCES and not key.startswith("engine ")]
    return [f"{key} {there[key]} (here {here[key]})" for key in both]


def alike(here: Mapping[str, str], fn: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> T:
    """Return what a function returns, if this process is like the one that asks for it.

    Raises
    ------
    ClusterError
        If it is not: it came after the others were asked, or was started before an edit.
    """
    if other := differences(likeness(), here):
        raise ClusterError(
            f"a worker on '{platform.node()}' would not compute as it is done here: it has "
            f"{', '.join(other)}; {REMEDY}"
        )
    return fn(*args, **kwargs)
