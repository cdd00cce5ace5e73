"""The cache of results of cases: its keys, and whether an entry is still current.

The key of a result is a digest of scene, engine and its version, settings, the sources of the
program, and the versions of all that the engine computes with: all on which the result depends.
"""

from collections.abc import Sequence

from harness.core.case import Case
from harness.core.engine_packages import versions_behind
from harness.core.environments import environment
from harness.engines.registry import (
    adapter_names,
    engine,
    engine_version,
    entry_of,
    module_of,
    names,
)
from harness.evaluation.evaluation import Evaluation
from harness.execution.cache import CacheFolder
from harness.execution.cache_entry import Metadata, checksum
from harness.execution.source_fingerprint import fingerprint
from harness.execution.tasks import ResultCache


def case_key(case: Case, *modules: str) -> str:
    """Return the cache key of a case: digest of case, version of its engine, and program.

    Parameters
    ----------
    case : Case
    modules : str
        Names of modules on which the result depends, other than those that make an evaluation.
    """
    digest = case.digest(engine_version(case.engine))
    return checksum(f"{digest} {code_fingerprint(case.engine, *modules)}".encode())[:32]


def case_metadata(case: Case, *modules: str) -> Metadata:
    """Return the metadata of a case's result: engine, version, sources and command."""
    return Metadata(
        label=case.label(),
        command=case.command(),
        engine=case.engine,
        engine_version=engine_version(case.engine),
        code=code_fingerprint(case.engine, *modules),
        modules=(module_of(engine(case.engine)), *modules),
    )


def is_current(metadata: Metadata) -> bool:
    """Return whether program and engine are those that made a stored result."""
    if metadata.engine and metadata.engine not in names():
        return False
    same = not metadata.engine or engine_version(metadata.engine) == metadata.engine_version
    return same and _fingerprint(metadata.engine, metadata.modules) == metadata.code


def code_fingerprint(name: str, *modules: str) -> str:
    """Return the fingerprint of the program behind results of an engine, and of what it runs in."""
    return _fingerprint(name, (module_of(engine(name)), *modules))


def _fingerprint(name: str, modules: Sequence[str]) -> str:
    """Return the fingerprint of modules, and of the packages that an engine computes with.

    They are those of this interpreter, or of the environment of an engine that has one.
    """
    place = environment(name)
    program = fingerprint(*modules)
    if place is not None:
        behind = place.fingerprint()
    else:
        behind = versions_behind(entry_of(name)) if name in adapter_names() else ""
    return checksum(f"{program} {behind}".encode())[: len(program)] if behind else program


def evaluation_cache(store: CacheFolder) -> ResultCache[Case, Evaluation]:
    """Return the cache of evaluations."""
    return ResultCache(store=store, kind="evaluations", key=case_key, metadata=case_metadata)
