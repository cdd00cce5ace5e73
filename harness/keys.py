"""What names a result of a case in a store: everything that decides it."""

from harness.case import Case
from harness.engines.registry import engine, names
from harness.store import About
from harness.store.code import fingerprint
from harness.store.entry import checksum


def key_of(case: Case, *modules: str) -> str:
    """Return what names a result of a case: the case, its engine's version, and the program.

    Parameters
    ----------
    case : Case
    modules : str
        Names of modules that decide the result besides those that make an evaluation.
    """
    digest = case.digest(version_of(case.engine))
    return checksum(f"{digest} {code_of(case.engine, *modules)}".encode())[:32]


def about(case: Case, *modules: str) -> About:
    """Return where a result of a case comes from."""
    return About(
        label=case.label(),
        command=case.command(),
        engine=case.engine,
        engine_version=version_of(case.engine),
        code=code_of(case.engine, *modules),
        modules=(_module_of(case.engine), *modules),
    )


def is_current(told: About) -> bool:
    """Whether a result that is kept can still be found: program and engine are what they were."""
    if told.engine and told.engine not in names():
        return False
    same = not told.engine or version_of(told.engine) == told.engine_version
    return same and fingerprint(*told.modules) == told.code


def code_of(name: str, *modules: str) -> str:
    """Return the fingerprint of the program behind results of an engine."""
    return fingerprint(_module_of(name), *modules)


def version_of(name: str) -> str:
    """Return the version of an engine, or "unknown" if its adapter cannot tell."""
    try:
        version: object = engine(name).version
        return version if isinstance(version, str) else "unknown"
    except Exception:  # noqa: BLE001 - an adapter is somebody's program
        return "unknown"


def _module_of(name: str) -> str:
    """Return the module that an engine comes from."""
    return type(engine(name)).__module__
