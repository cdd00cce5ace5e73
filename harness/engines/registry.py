"""Engines by name: whatever is installed under the entry point group `rockingcan.engines`.

An engine of another package is first created in a separate process, and asked there for the
timestep of each case: a package that crashes or hangs would take the program with it.
"""

import re
from collections.abc import Iterator, Sequence
from functools import cache, lru_cache
from importlib.metadata import EntryPoint, entry_points
from typing import Any

from harness.core.case import PROFILES, Case
from harness.core.engine_packages import ENGINE_ENTRY_POINTS, install_command, packages_of
from harness.core.errors import (
    BrokenEngineError,
    EffectBelowMinimumError,
    EngineContractError,
    EngineCrashError,
    HarnessError,
    MissingPackageError,
    UnknownEngineError,
    UnsupportedEffectError,
)
from harness.engines.base import COMMON, Engine, Variant, features_of, resolve
from harness.engines.contract import describe_exception, is_timestep
from harness.execution.isolated_pool import IsolatedProcessPool, background_worker
from harness.execution.limits import Limits
from harness.execution.worker import LostTaskError
from harness.execution.worker_main import is_worker
from models import Scene, load

_OURS = frozenset({"harness", "models", "reference"})
"""Packages of this project. Their engines need no process of their own to be asked; and they are
not to be installed when they are missing: something is wrong with them."""

_PATIENCE = Limits(seconds=60.0)
"""A package that is large takes some seconds to import."""

_SCENE = "gentle-rock"

_MOST_CASES = 2**14
"""Cases whose timesteps are known without asking again: more than any suite has."""


def is_ours(chosen: Engine) -> bool:
    """Whether an engine is of this project."""
    return _is_ours(type(chosen).__module__)


def _is_ours(place: str) -> bool:
    """Whether a module, or the value of an entry point, is of this project."""
    return re.split("[.:]", place)[0] in _OURS


def crash_reason(entry: EntryPoint) -> str:
    """Return how an engine kills the process in which it is created; empty if it does not.

    A Python exception is no crash: it is raised again where it can be reported. A worker tries
    nothing, since it is a separate process already.
    """
    if _is_ours(entry.value) or is_worker():
        return ""
    with IsolatedProcessPool(1, _PATIENCE) as alone:
        error = alone.submit(_probe_plugin, entry.value).exception()
    return error.reason if isinstance(error, LostTaskError) else ""


def _probe_plugin(value: str) -> str:
    """Create an engine and read all that the program will read; return it as text."""
    chosen = _made_once(value)
    description = f"{chosen.name} {chosen.version} {chosen.settings} {chosen.capabilities}"
    cases = (Case(scene=load(_SCENE), engine=chosen.name, profile=name) for name in PROFILES)
    return f"{description} {[chosen.timestep(case) for case in cases]}"


@lru_cache(maxsize=_MOST_CASES)
def timestep_from_worker(value: str, case: Case) -> float | None:
    """Return the timestep of a case, from an engine that is asked in a background process.

    There its settings are resolved, too. The process is one for all cases, and ends with this one.

    Parameters
    ----------
    value : str
        Of the engine's entry point.
    case : Case

    Raises
    ------
    HarnessError
        If the engine refuses the case as wrong use.
    LostTaskError
        If the process dies, or does not answer.
    Exception
        Whatever else the engine raises.
    """
    return _worker_for(value).submit(_timestep, value, case).result()


@cache
def _worker_for(value: str) -> IsolatedProcessPool:
    """Return the background process in which an engine is asked, which ends with this one."""
    del value
    return background_worker(_PATIENCE)


@cache
def _made_once(value: str) -> Engine:
    """Create an engine, once in a process."""
    created: Engine = EntryPoint(name="asked", value=value, group="").load()()
    return created


def _timestep(value: str, case: Case) -> float | None:
    """Ask an engine for the timestep of a case; resolve its settings as the program will."""
    chosen = _made_once(value)
    answer: Any = chosen.timestep(case)
    if not is_timestep(answer):
        raise TypeError(f"it returned {type(answer).__name__}, not a positive number or None")
    timestep = None if answer is None else float(answer)
    resolve(case, chosen.settings, timestep or 0.0)
    return timestep


def names() -> tuple[str, ...]:
    """Return the names of the engines that are registered, sorted, importable or not."""
    return tuple(sorted(_entries()))


def left_out() -> tuple[str, ...]:
    """Return the engines that are not there unless they are named, sorted.

    Their packages are optional and not installed. An engine of which a package is missing that
    every installation has is not among them: something is wrong with it, and it is not passed over.
    """
    return tuple(name for name, entry in sorted(_entries().items()) if packages_of(entry).missing)


def how_to_add(engines: Sequence[str]) -> str:
    """Return one sentence on engines that are left out; empty without any."""
    if not engines:
        return ""
    install = install_command([packages_of(_entries()[name]).extra for name in engines])
    return f"not installed, and so left out: {', '.join(engines)}; to have it, run: {install}"


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
    if reason := crash_reason(entries[name]):
        raise EngineCrashError(name, entries[name].value, reason)
    try:
        created: Engine = entries[name].load()()
        _ = created.version, created.settings, created.capabilities  # what everybody asks it for
    except ImportError as error:
        if _is_ours(error.name or ""):
            raise BrokenEngineError(name, entries[name].value, str(error)) from error
        missing = error.name or name
        install = install_command([packages_of(entries[name]).extra or missing])
        raise MissingPackageError(f"engine '{name}'", missing, str(error), install) from error
    except Exception as error:
        reason = f"{type(error).__name__}: {error}"
        raise BrokenEngineError(name, entries[name].value, reason) from error
    return created


def engine_version(name: str) -> str:
    """Return the version of an engine, or "unknown" if its adapter cannot tell."""
    try:
        version: object = engine(name).version
        return version if isinstance(version, str) else "unknown"
    except Exception:  # noqa: BLE001 - an adapter is somebody's program
        return "unknown"


def variants(name: str) -> tuple[Variant, ...]:
    """Return the variants of an engine: its own, or the profiles and each word that it allows."""
    chosen = engine(name)
    declared = features_of(chosen).variants
    if declared is not None:
        return declared
    return COMMON + tuple(
        Variant.of(setting.name, word)
        for setting in chosen.settings
        for word in setting.choices
        if word != setting.matched
    )


def export_settings(case: Case) -> str:
    """Return a case in the engine's own language, or the command that runs it."""
    export = features_of(engine(case.engine)).export_settings
    return case.command() if export is None else export(case)


def timestep_of(case: Case, chosen: Engine | None = None) -> float | None:
    """Return the timestep of a case, s; None for a solver that chooses its own.

    An engine of another package is asked in a separate process: it may crash.

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
    asked = engine(case.engine) if chosen is None else chosen
    entry = None if is_worker() else _foreign(case.engine, type(asked))
    try:
        return asked.timestep(case) if entry is None else timestep_from_worker(entry, case)
    except HarnessError:
        raise
    except Exception as error:
        lost = isinstance(error, LostTaskError)
        reason = str(error) if lost else describe_exception(error, "timestep")
        raise EngineContractError(case.engine, case.label(), reason) from error


@cache
def _foreign(name: str, kind: type[Engine]) -> str | None:
    """Return the entry point of an engine that is not of this project; None if it is."""
    entry = None if _is_ours(kind.__module__) else _entries().get(name)
    return None if entry is None or _is_ours(entry.value) else entry.value


def check_effects(name: str, scene: Scene) -> None:
    """Refuse a scene with an effect which an engine neither honours nor imposes, or not so weak.

    Raises
    ------
    UnsupportedEffectError, EffectBelowMinimumError
        Names the engines that can.
    """
    for effect in missing_effects(name, scene):
        able = [other for other in names() if _honours(other, effect, scene)]
        for key, value, least in _faint(name, scene):
            if key.startswith(f"{effect}."):
                raise EffectBelowMinimumError(name, key, value, least, able)
        raise UnsupportedEffectError(name, effect, able)


def missing_effects(name: str, scene: Scene) -> tuple[str, ...]:
    """Return the effects that a scene declares and an engine does not represent.

    It neither honours nor imposes them, or makes more of them than the scene declares.
    """
    declared = scene.effects.declared()
    if not declared:
        return ()
    capabilities = engine(name).capabilities
    faint = {key.partition(".")[0] for key, _, _ in _faint(name, scene)}
    known = (capabilities.honours | set(capabilities.imposes)) - faint
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
    return {entry.name: entry for entry in entry_points(group=ENGINE_ENTRY_POINTS)}
