"""Engines by name: whatever is installed under the entry point group `rockingcan.engines`."""

from functools import cache
from importlib.metadata import EntryPoint, entry_points

from harness.engines.base import Engine
from harness.engines.rehearsal import fall
from harness.errors import (
    BrokenEngineError,
    FallenEngineError,
    MissingPackageError,
    UnknownEngineError,
    UnsupportedEffectError,
)
from models.scene import Scene

GROUP = "rockingcan.engines"

_OURS = frozenset({"harness", "models", "reference"})
"""Packages that are not to be installed when they are missing: something is wrong with them."""


def names() -> tuple[str, ...]:
    """Return the names of the engines that are registered, sorted, importable or not."""
    return tuple(sorted(_entries()))


@cache
def engine(name: str) -> Engine:
    """Return an engine.

    Raises
    ------
    UnknownEngineError
        If no engine of that name is registered.
    MissingPackageError
        If the package behind it cannot be imported.
    BrokenEngineError
        If the package is there, but the engine cannot be made, or falls over while it is.
    """
    entries = _entries()
    if name not in entries:
        raise UnknownEngineError(name, entries)
    if reason := fall(entries[name]):
        raise FallenEngineError(name, entries[name].value, reason)
    try:
        found: Engine = entries[name].load()()
    except ImportError as error:
        if (error.name or "").partition(".")[0] in _OURS:
            raise BrokenEngineError(name, entries[name].value, str(error)) from error
        raise MissingPackageError(name, error.name or name, str(error)) from error
    except Exception as error:
        reason = f"{type(error).__name__}: {error}"
        raise BrokenEngineError(name, entries[name].value, reason) from error
    return found


def check_effects(name: str, scene: Scene) -> None:
    """Refuse a scene that declares an effect which an engine neither honours nor imposes.

    Raises
    ------
    UnsupportedEffectError
        Names the engines that can.
    """
    for effect in missing_effects(name, scene):
        able = [other for other in names() if _honours(other, effect)]
        raise UnsupportedEffectError(name, effect, able)


def missing_effects(name: str, scene: Scene) -> tuple[str, ...]:
    """Return the effects that a scene declares and an engine neither honours nor imposes."""
    declared = scene.effects.declared()
    if not declared:
        return ()
    own = engine(name).capabilities
    return tuple(e for e in declared if e not in own.honours and e not in own.imposes)


def _honours(name: str, effect: str) -> bool:
    """Whether an engine is there and simulates an effect."""
    try:
        return effect in engine(name).capabilities.honours
    except MissingPackageError:
        return False


def _entries() -> dict[str, EntryPoint]:
    """Return the entry points of the group by name."""
    return {entry.name: entry for entry in entry_points(group=GROUP)}
