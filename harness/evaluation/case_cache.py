"""The cache of results of cases: its keys, and whether an entry is still current.

The key of a result is a digest of scene, engine and its version, settings, and the sources of the
program: all on which the result depends.
"""

from harness.core.case import Case
from harness.engines.registry import engine, engine_version, names
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
        modules=(_module_of(case.engine), *modules),
    )


def is_current(metadata: Metadata) -> bool:
    """Return whether program and engine are those that made a stored result."""
    if metadata.engine and metadata.engine not in names():
        return False
    same = not metadata.engine or engine_version(metadata.engine) == metadata.engine_version
    return same and fingerprint(*metadata.modules) == metadata.code


def code_fingerprint(name: str, *modules: str) -> str:
    """Return the fingerprint of the program behind results of an engine."""
    return fingerprint(_module_of(name), *modules)


def _module_of(name: str) -> str:
    """Return the module that an engine comes from."""
    return type(engine(name)).__module__


def evaluation_cache(store: CacheFolder) -> ResultCache[Case, Evaluation]:
    """Return the cache of evaluations."""
    return ResultCache(store=store, kind="evaluations", key=case_key, metadata=case_metadata)
