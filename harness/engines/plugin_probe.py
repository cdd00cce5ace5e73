"""Engines of other packages, asked in a process of their own before this one creates them.

A package that crashes or hangs would take the program with it. How long one may take is for its
module to say, in the field `import_s` of a `DESCRIPTION`: that module is to be imported at once, as
are those of this project, and what is slow or compiles comes with the engine.

The packages behind engines of this project can be built for another processor. One that is optional
is tried in the same way, and once: that it was is kept among the caches of the user.
"""

import hashlib
import os
import platform
import re
import sys
from collections.abc import Sequence
from contextlib import suppress
from functools import cache, lru_cache
from importlib import import_module
from importlib.metadata import EntryPoint, PackageNotFoundError, distribution
from pathlib import Path
from typing import Any

from harness.core.case import PROFILES, Case
from harness.core.engine_packages import packages_of
from harness.engines.base import Engine, resolve
from harness.engines.contract import is_timestep
from harness.engines.description import Description
from harness.execution.isolated_pool import IsolatedProcessPool, background_worker
from harness.execution.limits import Limits
from harness.execution.source_fingerprint import OUR_PACKAGES
from harness.execution.worker import LostTaskError
from harness.execution.worker_main import is_worker
from models import load

_PATIENCE = Limits(seconds=Description().import_s)
"""A package that is large takes some seconds to import."""

_SCENE = "gentle-rock"

_MOST_CASES = 2**14
"""Cases whose timesteps are known without asking again: more than any suite has."""


def is_our_module(place: str) -> bool:
    """Whether a module, or the value of an entry point, is of this project.

    Engines of this project need no process of their own to be asked; and its packages are not to be
    installed when they are missing: something is wrong with them.
    """
    return re.split("[.:]", place)[0] in OUR_PACKAGES


def crash_reason(entry: EntryPoint) -> str:
    """Return how an engine kills the process in which it is created; empty if it does not.

    A Python exception is no crash: it is raised again where it can be reported. A worker tries
    nothing, since it is a separate process already.
    """
    if is_worker():
        return ""
    ours = is_our_module(entry.value)
    tried = _mark_of(packages_of(entry).optional) if ours else None
    if ours and (tried is None or tried.exists()):
        return ""
    try:
        longest = _longest(_longest_import(entry.value)) if ours else _patience_with(entry.value)
        with IsolatedProcessPool(1, longest) as alone:
            error = alone.submit(_made_once if ours else _probe_plugin, entry.value).exception()
    except LostTaskError as lost:
        error = lost
    if isinstance(error, LostTaskError):
        return error.reason
    if tried is not None:
        with suppress(OSError):  # then it is tried again
            tried.parent.mkdir(parents=True, exist_ok=True)
            tried.touch()
    return ""


def _mark_of(packages: Sequence[str]) -> Path | None:
    """Return the file that says that packages were tried; None of packages that are not there."""
    digest = hashlib.sha256(f"{sys.executable} {platform.node()} {platform.machine()}".encode())
    for name in packages:
        try:
            installed = distribution(name)
        except PackageNotFoundError:
            return None
        # a build of one's own has other files under the same version
        digest.update(f"{name} {installed.version} {installed.read_text('RECORD')}".encode())
    caches = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    return caches / "rockingcan" / "tried" / digest.hexdigest()[:32] if packages else None


@cache
def _patience_with(value: str) -> Limits:
    """Return how long the engine of an entry point may take to be created.

    Raises
    ------
    LostTaskError
        If its module kills the process that imports it, or does not end.
    """
    with IsolatedProcessPool(1, _PATIENCE) as alone:
        return _longest(alone.submit(_longest_import, value).result())


def _longest(seconds: float) -> Limits:
    return Limits(seconds=max(seconds, _PATIENCE.seconds))


def _longest_import(value: str) -> float:
    """Return the time that the module of an engine asks for, s; zero if it asks for none."""
    try:
        declared = getattr(import_module(value.partition(":")[0]), "DESCRIPTION", None)
    except Exception:  # noqa: BLE001 - whoever creates the engine meets it again, and reports it
        return 0.0
    return float(declared.import_s) if isinstance(declared, Description) else 0.0


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
    return background_worker(_patience_with(value))


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
