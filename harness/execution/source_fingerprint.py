"""A fingerprint of the program that makes a result: another program, another result.

Versions do not change when a checkout is edited; sources do. So the sources that decide a result go
into the fingerprint as text, and the numerical packages with their versions.
"""

import hashlib
import sys
from functools import cache
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path

_PACKAGES = ("numpy", "scipy")
"""Besides the engine's own, whose version is part of a case's digest."""

_ROOT = Path(__file__).parents[2]

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
    for place in _DECIDING:
        _add(digest, _ROOT / place)
    for name in sorted(set(modules)):
        file = _source(name)
        if file is None:
            digest.update(f"{name} has no source\n".encode())
            continue
        sources = file.parent if "." in name or file.stem == "__init__" else file
        if not any(sources.is_relative_to(_ROOT / place) for place in _DECIDING):
            _add(digest, sources)
    return digest.hexdigest()[:16]


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


def _add(digest: "hashlib._Hash", place: Path) -> None:
    """Add a source file, or those of a folder in the order of their names."""
    for file in [place] if place.is_file() else sorted(place.rglob("*.py")):
        name = file.relative_to(place.parent).as_posix()
        content = file.read_bytes()
        digest.update(f"{name} {len(content)}\n".encode())
        digest.update(content)
