"""A fingerprint of the program that makes a result: another program, another result.

Versions do not change when a checkout is edited; sources do. So the sources that decide a result go
into the fingerprint as text, and the numerical packages with their versions. An adapter that is
edited makes the results of the other engines no older.
"""

import hashlib
import sys
from functools import cache
from importlib.metadata import entry_points, version
from importlib.util import find_spec
from pathlib import Path

from harness.core.engine_packages import ENGINE_ENTRY_POINTS

_PACKAGES = ("numpy", "scipy")
"""Besides the engine's own, whose version is part of a case's digest."""

ROOT = Path(__file__).parents[2]
"""Where the packages of this program are."""

OUR_PACKAGES = ("harness", "models", "reference")

_DECIDING = (
    "models",
    "reference",
    "harness/engines",
    "harness/metrics",
    "harness/core/bounce.py",
    "harness/core/case.py",
    "harness/core/simulation.py",
    "harness/core/trajectory.py",
    "harness/evaluation/case_cache.py",
    "harness/evaluation/evaluate.py",
    "harness/evaluation/evaluation.py",
)
"""What an evaluation is made with, scene to numbers; reports and command line decide nothing."""

_ENGINES = ROOT / "harness/engines"

_OF_ALL = frozenset({"reference"})
"""Engines that take part in every evaluation: they are the truth."""


@cache
def sources_fingerprint() -> str:
    """Return 16 hexadecimal digits that name the sources of this program, as first read."""
    digest = hashlib.sha256()
    for name in OUR_PACKAGES:
        _add(digest, ROOT / name)
    return digest.hexdigest()[:16]


@cache
def fingerprint(*modules: str) -> str:
    """Return 16 hexadecimal digits that name the program behind a result.

    Parameters
    ----------
    modules : str
        Names of modules that decide as well; each stands for all sources of its folder if it is
        part of a package.
    """
    digest = hashlib.sha256()
    for name in _PACKAGES:
        digest.update(f"{name} {version(name)}\n".encode())
    adapters = _adapters()
    for place in _DECIDING:
        _add(digest, ROOT / place, without=adapters)
    for name in sorted(set(modules)):
        file = _source(name)
        if file is None:
            digest.update(f"{name} has no source\n".encode())
            continue
        sources = file.parent if "." in name or file.stem == "__init__" else file
        if (own := _adapter_of(sources)) in adapters:
            _add(digest, own)
        elif not any(sources.is_relative_to(ROOT / place) for place in _DECIDING):
            _add(digest, sources)
    return digest.hexdigest()[:16]


@cache
def _adapters() -> frozenset[Path]:
    """Return the folders of this project's engines, of which one decides a result."""
    modules = (entry.value.partition(":")[0] for entry in entry_points(group=ENGINE_ENTRY_POINTS))
    folders = {_ENGINES.parents[1].joinpath(*module.split(".")) for module in modules}
    return frozenset(map(_adapter_of, folders)) - {_ENGINES / name for name in _OF_ALL}


def _adapter_of(folder: Path) -> Path:
    """Return the folder right below those of the engines that a folder is in, or itself."""
    if _ENGINES not in folder.parents:
        return folder
    return _ENGINES / folder.relative_to(_ENGINES).parts[0]


def _source(module: str) -> Path | None:
    """Return the source of a module, imported or not; None if it has none that can be found."""
    file = getattr(sys.modules.get(module), "__file__", None)
    if file is None:
        try:
            spec = find_spec(module)
        except (ImportError, ValueError):
            spec = None
        file = None if spec is None else spec.origin
    return Path(file) if file is not None and Path(file).suffix == ".py" else None


def _add(digest: "hashlib._Hash", place: Path, without: frozenset[Path] = frozenset()) -> None:
    """Add a source file, or those of a folder in the order of their names, but for some folders."""
    for file in [place] if place.is_file() else sorted(place.rglob("*.py")):
        if not without.isdisjoint(file.parents):
            continue
        name = file.relative_to(place.parent).as_posix()
        content = file.read_bytes()
        digest.update(f"{name} {len(content)}\n".encode())
        digest.update(content)
