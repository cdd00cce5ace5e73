"""What there is to choose from: engines and their settings."""

from typing import Any

from harness.cli import printing
from harness.engines.base import Setting
from harness.engines.registry import engine, names
from harness.errors import MissingPackageError


def engines_answer(name: str | None) -> dict[str, Any]:
    """Return all engines, or one, as `--json` says them."""
    return {"engines": [_told(each) for each in ([name] if name else names())]}


def _told(name: str) -> dict[str, Any]:
    """Return what there is to know of an engine; if it is missing, how to install it."""
    try:
        found = engine(name)
    except MissingPackageError as error:
        return {"name": name, "installed": False, "message": str(error)}
    return {
        "name": name,
        "installed": True,
        "version": found.version,
        "honours": sorted(found.capabilities.honours),
        "imposes": dict(found.capabilities.imposes),
        "settings": [
            {
                "name": setting.name,
                "default": setting.default,
                "matched": _matched(setting),
                "choices": list(setting.choices),
                "meaning": setting.meaning,
            }
            for setting in found.settings
        ],
    }


def print_engines() -> None:
    """Print a row for each engine."""
    rows = []
    for name in names():
        told = _told(name)
        if told["installed"]:
            imposes = "; ".join(f"{k}: {v}" for k, v in told["imposes"].items()) or "nothing"
            honours = ", ".join(told["honours"]) or "the ideal can only"
            rows.append((name, told["version"], honours, imposes))
        else:
            rows.append((name, "not installed", told["message"], ""))
    columns = ("engine", "version", "honours", "imposes on every scene")
    printing.out().print(printing.table("Engines", columns, rows))


def print_engine(name: str) -> None:
    """Print the settings of an engine: what it ships with, and what `matched` takes instead."""
    rows = [
        (name, setting.name, _spell(setting.default), _spell(_matched(setting)), setting.meaning)
        for setting in engine(name).settings
    ]
    columns = ("engine", "setting", "default", "matched", "meaning")
    printing.out().print(printing.table(f"Settings of {name}, for --set", columns, rows))


def _matched(setting: Setting) -> object:
    """Return the matched value; where it goes with the timestep, its value for one second."""
    if not callable(setting.matched):
        return setting.matched
    return f"for a timestep of 1 s: {_spell(setting.matched(1.0))}, in proportion"


def _spell(value: object) -> str:
    """Return a value as `--set` reads it."""
    if value is None:
        return "as shipped"
    if isinstance(value, tuple):
        return ",".join(f"{number:g}" for number in value)
    return f"{value:g}" if isinstance(value, float) else str(value)
