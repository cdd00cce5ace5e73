"""Engines by name: whatever is installed under the entry point group `rockingcan.engines`."""

from collections.abc import Iterator
from functools import cache
from importlib.metadata import EntryPoint, entry_points

from harness.case import Case
from harness.engines.base import Engine
from harness.engines.rehearsal import asked, at_home, fall
from harness.engines.soundness import raised
from harness.errors import (
    BrokenEngineError,
    FaintEffectError,
    FallenEngineError,
    HarnessError,
    MissingPackageError,
    SpeechlessEngineError,
    UnknownEngineError,
    UnsupportedEffectError,
)
from harness.isolation import LostTaskError, is_worker
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
        _ = found.version, found.settings, found.capabilities  # what everybody asks it for
    except ImportError as error:
        if (error.name or "").partition(".")[0] in _OURS:
            raise BrokenEngineError(name, entries[name].value, str(error)) from error
        raise MissingPackageError(name, error.name or name, str(error)) from error
    except Exception as error:
        reason = f"{type(error).__name__}: {error}"
        raise BrokenEngineError(name, entries[name].value, reason) from error
    return found


def timestep_of(case: Case, chosen: Engine | None = None) -> float | None:
    """Return the timestep of a case, s; None for a solver that chooses its own.

    An engine of somebody else's is asked in a process of its own first: it may not survive it.

    Parameters
    ----------
    case : Case
    chosen : Engine, optional
        That of the case, if it is at hand.

    Raises
    ------
    HarnessError
        If the engine refuses the case as wrong use.
    BrokenEngineError
        If it raises anything else, kills its process, or does not answer.
    """
    own = engine(case.engine) if chosen is None else chosen
    entry = None if is_worker() else _foreign(case.engine, type(own))
    try:
        return own.timestep(case) if entry is None else asked(entry, case)
    except HarnessError:
        raise
    except Exception as error:
        told = str(error) if isinstance(error, LostTaskError) else raised(error, "timestep")
        raise SpeechlessEngineError(case.engine, case.label(), told) from error


def is_ours(chosen: Engine) -> bool:
    """Whether an engine is of this project."""
    return _is_ours(type(chosen))


def _is_ours(kind: type[Engine]) -> bool:
    return kind.__module__.partition(".")[0] in _OURS


@cache
def _foreign(name: str, kind: type[Engine]) -> str | None:
    """Return the entry point of an engine that is not of this project; None if it is."""
    entry = None if _is_ours(kind) else _entries().get(name)
    return None if entry is None or at_home(entry) else entry.value


def check_effects(name: str, scene: Scene) -> None:
    """Refuse a scene with an effect which an engine neither honours nor imposes, or not so weak.

    Raises
    ------
    UnsupportedEffectError, FaintEffectError
        Names the engines that can.
    """
    for effect in missing_effects(name, scene):
        able = [other for other in names() if _honours(other, effect, scene)]
        for key, value, least in _faint(name, scene):
            if key.startswith(f"{effect}."):
                raise FaintEffectError(name, key, value, least, able)
        raise UnsupportedEffectError(name, effect, able)


def missing_effects(name: str, scene: Scene) -> tuple[str, ...]:
    """Return the effects that a scene declares and an engine does not represent.

    It neither honours nor imposes them, or makes more of them than the scene declares.
    """
    declared = scene.effects.declared()
    if not declared:
        return ()
    own = engine(name).capabilities
    faint = {key.partition(".")[0] for key, _, _ in _faint(name, scene)}
    known = (own.honours | set(own.imposes)) - faint
    return tuple(effect for effect in declared if effect not in known)


def _faint(name: str, scene: Scene) -> Iterator[tuple[str, float, float]]:
    """Yield the constants that a scene declares weaker than an engine takes them: key and both."""
    for key, least in engine(name).capabilities.least.items():
        effect, _, constant = key.partition(".")
        if effect in scene.effects.declared():
            value = getattr(getattr(scene.effects, effect), constant)
            if 0.0 < value < least:
                yield key, value, least


def _honours(name: str, effect: str, scene: Scene) -> bool:
    """Whether an engine is there and simulates an effect as a scene declares it."""
    try:
        honours = effect in engine(name).capabilities.honours
        return honours and effect not in missing_effects(name, scene)
    except MissingPackageError:
        return False


def _entries() -> dict[str, EntryPoint]:
    """Return the entry points of the group by name."""
    return {entry.name: entry for entry in entry_points(group=GROUP)}
