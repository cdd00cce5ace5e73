"""Reading `--set ENGINE.KEY=VALUE`: settings on top of a whole suite."""

from collections.abc import Mapping, Sequence

from harness.case import Value
from harness.cli.words import settings
from harness.engines.registry import engine
from harness.errors import InvalidSettingError

Settings = dict[str, dict[str, Value]]


def engine_settings(pairs: Sequence[str], engines: Sequence[str]) -> Settings:
    """Return settings by engine and name.

    Parameters
    ----------
    pairs : sequence of str
        `ENGINE.KEY=VALUE`, or `KEY=VALUE` for every chosen engine that has such a setting.
    engines : sequence of str
        That are run.

    Raises
    ------
    InvalidSettingError
        If a pair names an engine that does not run, a setting that none has, or one twice.
    """
    found: Settings = {}
    for words, value in settings(list(pairs)):
        chosen, dot, name = words.rpartition(".")
        if dot and chosen not in engines:
            allowed = f"a setting of an engine that runs: {', '.join(engines)}"
            raise InvalidSettingError("--set", words, allowed)
        having = [chosen] if dot else [one for one in engines if name in _names(one)]
        if not having:
            known = "; ".join(f"{one}: {', '.join(sorted(_names(one)))}" for one in engines)
            raise InvalidSettingError("--set", words, f"ENGINE.KEY=VALUE with one of {known}")
        for one in having:
            if name in found.setdefault(one, {}):
                raise InvalidSettingError("--set", words, f"each once, but {one} has it twice")
            found[one][name] = value
    return found


def spelled(chosen: Mapping[str, Mapping[str, Value]]) -> dict[str, str]:
    """Return settings as a manifest tells them, by `engine.name`."""
    return {
        f"{one}.{name}": ",".join(f"{part:g}" for part in value)
        if isinstance(value, tuple)
        else str(value)
        for one, own in chosen.items()
        for name, value in own.items()
    }


def _names(name: str) -> set[str]:
    """Return the names of an engine's settings."""
    return {setting.name for setting in engine(name).settings}
