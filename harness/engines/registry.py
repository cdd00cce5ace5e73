"""Engines by name: whatever is installed under the entry point group `rockingcan.engines`.

An engine of another package is first created in a separate process, and asked there for the
timestep of each case: see `plugin_probe`. One that lives in an interpreter of its own is an engine
like the others.
"""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import cache
from importlib import import_module
from importlib.metadata import EntryPoint, entry_points

from harness.core.case import Case
from harness.core.engine_packages import (
    ENGINE_ENTRY_POINTS,
    EnginePackages,
    install_command,
    packages_of,
    requirements_of,
)
from harness.core.environments import (
    RESERVED,
    EnvironmentFileError,
    environment,
    environment_names,
    environments,
    this_environment,
)
from harness.core.errors import (
    BrokenEngineError,
    BrokenPackageError,
    EffectBelowMinimumError,
    EngineContractError,
    EngineCrashError,
    HarnessError,
    MissingLibraryError,
    MissingPackageError,
    ReservedNameError,
    UnknownEngineError,
    UnsupportedEffectError,
)
from harness.core.provenance import version_of
from harness.engines.base import COMMON, Engine, Variant, features_of
from harness.engines.contract import describe_exception
from harness.engines.description import FLIGHT, Description, Method
from harness.engines.plugin_probe import crash_reason, is_our_module, timestep_from_worker
from harness.engines.remote import RemoteEngine
from harness.execution.worker import LostTaskError
from harness.execution.worker_main import is_worker
from models import Scene


def is_ours(chosen: Engine) -> bool:
    """Whether the adapter of an engine is of this project."""
    return is_our_module(module_of(chosen))


def module_of(chosen: Engine) -> str:
    """Return the module that the adapter of an engine comes from, here or in its environment."""
    if isinstance(chosen, RemoteEngine):
        return chosen.environment.entry.partition(":")[0]
    return type(chosen).__module__


def names() -> tuple[str, ...]:
    """Return the names of the engines that are registered, sorted, importable or not."""
    return tuple(sorted({*_entries(), *environment_names()}))


def entry_of(name: str) -> EntryPoint:
    """Return the entry point of an adapter.

    Raises
    ------
    UnknownEngineError
        If none is registered under that name.
    """
    try:
        return _entries()[name]
    except KeyError:
        raise UnknownEngineError(name, _entries()) from None


def adapter_names() -> tuple[str, ...]:
    """Return the names under which adapters are registered, sorted."""
    return tuple(sorted(_entries()))


def our_names() -> tuple[str, ...]:
    """Return the names of the engines of this project, sorted, importable or not."""
    return tuple(name for name, entry in sorted(_entries().items()) if is_our_module(entry.value))


def not_installed() -> tuple[str, ...]:
    """Return the engines whose packages are optional and not installed, sorted.

    An engine of which a package is missing that every installation has is not among them: something
    is wrong with it, and it is not passed over, unless it lives in an environment.
    """
    elsewhere = {place.engine for place in environments().values()}
    return tuple(
        name
        for name, entry in sorted(_entries().items())
        if packages_of(entry).missing or (name in elsewhere and packages_of(entry).absent)
    )


def installed() -> tuple[str, ...]:
    """Return the engines that are installed, sorted; the reference is none to compare."""
    absent = {"reference", *not_installed()}
    return tuple(name for name in names() if name not in absent)


def left_out(*, every: bool = False) -> tuple[str, ...]:
    """Return the engines that would take part if they were installed, where none is named or all.

    Parameters
    ----------
    every : bool
        Whether all were asked for, and not those alone that take part by default.
    """
    there = stand_ins()
    return tuple(
        name
        for name in not_installed()
        if name not in there and (every or description_of(name).by_default)
    )


def stand_ins() -> Mapping[str, str]:
    """Return the engines that are not installed here and have an environment, with its name."""
    absent = not_installed()
    return {place.engine: name for name, place in environments().items() if place.engine in absent}


@cache
def description_of(name: str) -> Description:
    """Return the description of an engine; the defaults where it declares none, or is not there.

    That of an adapter of this project is read without the engine's own package. An engine in an
    environment takes part by default if its adapter does, and has no engine here.
    """
    with suppress(EnvironmentFileError):  # which is told where the engine is asked for
        chosen = None if name in _entries() else environment(name)
        if chosen is not None:
            said = description_of(chosen.engine) if chosen.engine in _entries() else Description()
            absent = chosen.engine in not_installed()
            label = f"{said.label or chosen.engine} {chosen.suffix}"
            by_default = said.by_default and absent
            return replace(said, label=label, light="", dark="", by_default=by_default)
    entry, declared = _entries().get(name), None
    if entry is not None and is_our_module(entry.value):
        with suppress(ImportError):  # which is told where the engine is asked for
            declared = getattr(import_module(entry.value.partition(":")[0]), "DESCRIPTION", None)
    if entry is not None and declared is None:
        with suppress(HarnessError):
            declared = features_of(engine(name)).description
    return declared if isinstance(declared, Description) else Description()


def is_constraint(name: str) -> bool:
    """Whether an engine imposes rolling, so that it is ranked with no engine that has contacts."""
    return description_of(name).method is Method.CONSTRAINT


def how_to_add(engines: Sequence[str]) -> str:
    """Return one sentence on engines that are left out; empty without any."""
    if not engines:
        return ""
    known = {name: packages_of(_entries()[name]) for name in engines}
    here = [packages.extra for packages in known.values() if not packages.elsewhere]
    ways = [install_command(here)] if here else []
    ways += [_way_elsewhere(name, one) for name, one in known.items() if one.elsewhere]
    run = "; ".join(ways)
    return f"not installed, and so left out: {', '.join(engines)}; to have it, run: {run}"


def _way_elsewhere(name: str, packages: EnginePackages) -> str:
    """Return the commands that add an engine of which this Python has no wheel."""
    compiled = install_command([packages.extra])
    add = f"rockingcan engines add {name} --python python{packages.elsewhere}"
    return f"{add} (or, with a compiler: {compiled})"


@cache
def engine(name: str) -> Engine:
    """Return an engine.

    Raises
    ------
    UnknownEngineError
        If no engine of that name is registered.
    ReservedNameError
        If it has a name that no engine can have.
    MissingPackageError
        If the package behind it cannot be imported.
    BrokenEngineError
        If the package is there, but the engine cannot be made, or falls over while it is; or if
        the environment in which it lives is broken.
    """
    entries = _entries()
    if name not in entries:
        chosen = environment(name)
        if chosen is None:
            raise UnknownEngineError(name, names())
        patience = description_of(chosen.engine).import_s
        return RemoteEngine(chosen, engine, patience)
    if name in RESERVED:
        raise ReservedNameError(name, entries[name].value)
    if reason := crash_reason(entries[name]):
        raise EngineCrashError(name, entries[name].value, reason)
    try:
        created: Engine = entries[name].load()()
        _ = created.version, created.settings, created.capabilities  # what everybody asks it for
        own = this_environment()
        if own is not None and own.name == name:
            created.name = name
    except MissingLibraryError:
        raise
    except ImportError as error:
        raise _not_imported(name, entries[name], error) from error
    except Exception as error:
        reason = f"{type(error).__name__}: {error}"
        raise BrokenEngineError(name, entries[name].value, reason) from error
    return created


def _not_imported(name: str, entry: EntryPoint, error: ImportError) -> MissingPackageError:
    """Return what is said of an engine one of whose modules cannot be imported."""
    if is_our_module(error.name or ""):
        return BrokenEngineError(name, entry.value, str(error))
    missing, packages = error.name or name, packages_of(entry)
    found = not isinstance(error, ModuleNotFoundError)
    if found and packages.needed and not packages.absent:
        return BrokenPackageError(name, entry.value, f"{type(error).__name__}: {error}")
    install = install_command([packages.extra or missing])
    if packages.elsewhere:
        install = _way_elsewhere(name, packages)
    return MissingPackageError(f"engine '{name}'", missing, str(error), install)


def forget_engines() -> None:
    """Ask engines anew from now on: what is installed has changed."""
    engine.cache_clear()
    description_of.cache_clear()


def outside_range(name: str) -> str:
    """Return which packages of an engine are of versions that its adapter does not support.

    Those of an engine elsewhere are looked up there; what an adapter supports that is not
    registered any more is not known.
    """
    from packaging.utils import canonicalize_name  # noqa: PLC0415 - one engine by name needs none

    place = environment(name)
    entry = _entries().get(name if place is None else place.engine)
    if place is None or entry is None:
        wanted = () if entry is None else requirements_of(entry)
        found = {one.name: version_of(one.name, "") for one in wanted}
    else:
        there = {"python_version": ".".join(place.python.split(".")[:2])}
        wanted = requirements_of(entry, there)
        installed = place.versions()
        found = {one.name: installed.get(canonicalize_name(one.name), "") for one in wanted}
    return ", ".join(
        f"{one.name} {found[one.name]}, which is not {one.specifier}"
        for one in wanted
        if found[one.name] and not one.specifier.contains(found[one.name], prereleases=True)
    )


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
    entry = None if is_our_module(kind.__module__) else _entries().get(name)
    return None if entry is None or is_our_module(entry.value) else entry.value


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

    It neither honours nor imposes them, or makes more of them than the scene declares. `FLIGHT` is
    one of them where the can is released above the plane, and the engine holds it there.
    """
    flies = scene.release.height > 0.0 and is_constraint(name)
    unable, declared = (FLIGHT,) if flies else (), scene.effects.demanded()
    if not declared:
        return unable
    capabilities = engine(name).capabilities
    faint = {key.partition(".")[0] for key, _, _ in _faint(name, scene)}
    known = (capabilities.honours | set(capabilities.imposes)) - faint
    return unable + tuple(effect for effect in declared if effect not in known)


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
        honours = effect == FLIGHT or effect in engine(name).capabilities.honours
        return honours and effect not in missing_effects(name, scene)
    except MissingPackageError:
        return False


def _entries() -> dict[str, EntryPoint]:
    """Return the entry points of the group by name, with that of a worker's own environment."""
    taken = environment_names()  # each stays that of its engine, whatever is registered later
    found = {e.name: e for e in entry_points(group=ENGINE_ENTRY_POINTS) if e.name not in taken}
    own = this_environment()
    if own is not None:
        found[own.name] = EntryPoint(name=own.name, value=own.entry, group=ENGINE_ENTRY_POINTS)
    return found
