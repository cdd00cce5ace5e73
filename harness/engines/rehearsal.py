"""An engine that somebody else wrote is made in a process of its own first: it may not survive it.

What makes an engine is imported into the program itself, which asks it for its settings, its
version and its timesteps; a package that falls over, or hangs, when it is imported or asked would
take everything with it.
"""

from importlib.metadata import EntryPoint

from harness.case import PROFILES, Case
from harness.isolation import Isolated, Limits, LostTaskError, is_worker
from models.catalogue import load

_OURS = frozenset({"harness"})
_PATIENCE = Limits(seconds=60.0)
"""A package that is large takes some seconds to import."""

_SCENE = "gentle-rock"


def fall(entry: EntryPoint) -> str:
    """Return in what way an engine falls while it is made; empty if it does not.

    An error in Python is no fall: it is met again where it can be told. In a worker nothing is
    tried: it is the process of its own.
    """
    if entry.value.partition(".")[0].partition(":")[0] in _OURS or is_worker():
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
