"""An engine that somebody else wrote is made in a process of its own first: it may not survive it.

What makes an engine is imported into the program itself, which asks it for its settings, its
version and its timesteps; a package that falls over, or hangs, when it is imported or asked would
take everything with it. So it is made, and then asked for the timestep of each case, over there.
"""

from functools import cache, lru_cache
from importlib.metadata import EntryPoint
from typing import Any

from harness.case import PROFILES, Case
from harness.engines.base import Engine, resolve
from harness.engines.soundness import is_timestep
from harness.isolation import Isolated, Limits, LostTaskError, beside, is_worker
from models.catalogue import load

_OURS = frozenset({"harness"})
_PATIENCE = Limits(seconds=60.0)
"""A package that is large takes some seconds to import."""

_SCENE = "gentle-rock"

_MOST_CASES = 2**14
"""Cases whose timesteps are known without asking again: more than any suite has."""


def at_home(entry: EntryPoint) -> bool:
    """Whether an engine is of this project, and needs no process of its own to be asked."""
    return entry.value.partition(".")[0].partition(":")[0] in _OURS


def fall(entry: EntryPoint) -> str:
    """Return in what way an engine falls while it is made; empty if it does not.

    An error in Python is no fall: it is met again where it can be told. In a worker nothing is
    tried: it is the process of its own.
    """
    if at_home(entry) or is_worker():
        return ""
    with Isolated(1, _PATIENCE) as alone:
        task = alone.submit(_made, entry.value)
        error = task.exception()
    return error.reason if isinstance(error, LostTaskError) else ""


def _made(value: str) -> str:
    """Make an engine and ask it for what the program will ask it for; return its answers."""
    found = EntryPoint(name="tried", value=value, group="").load()()
    told = f"{found.name} {found.version} {found.settings} {found.capabilities}"
    cases = (Case(scene=load(_SCENE), engine=found.name, profile=name) for name in PROFILES)
    return f"{told} {[found.timestep(case) for case in cases]}"


@lru_cache(maxsize=_MOST_CASES)
def asked(value: str, case: Case) -> float | None:
    """Return the timestep of a case, from an engine that is asked in a process beside this one.

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
    return _beside(value).submit(_timestep, value, case).result()


@cache
def _beside(value: str) -> Isolated:
    """Return the process in which an engine is asked; it and what it started end with this one."""
    del value
    return beside(_PATIENCE)


@cache
def _once(value: str) -> Engine:
    """Make an engine, the first time."""
    made: Engine = EntryPoint(name="asked", value=value, group="").load()()
    return made


def _timestep(value: str, case: Case) -> float | None:
    """Ask an engine for the timestep of a case; resolve its settings as the program will."""
    chosen = _once(value)
    found: Any = chosen.timestep(case)
    if not is_timestep(found):
        raise TypeError(f"it returned {type(found).__name__}, not a positive number or None")
    timestep = None if found is None else float(found)
    resolve(case, chosen.settings, timestep or 0.0)
    return timestep
