"""The settings of engines as the command line has them: `--set KEY=VALUE`."""

import math
from collections.abc import Mapping, Sequence
from contextlib import suppress

from harness.core.case import Value
from harness.core.errors import InvalidSettingError
from harness.core.public_paths import RenamedValueWarning, warn_renamed
from harness.engines.reference import RENAMED_METHODS, renamed_method
from harness.engines.registry import engine


def parse_settings(pairs: list[str]) -> tuple[tuple[str, Value], ...]:
    """Return the settings that `--set` was given, by name.

    Raises
    ------
    InvalidSettingError
        If one is not of the form KEY=VALUE, is given twice, or is not a number where it seems one.
    """
    settings: dict[str, Value] = {}
    for pair in pairs:
        name, equals, text = pair.partition("=")
        if not equals or not name:
            raise InvalidSettingError("--set", pair, "KEY=VALUE, such as impratio=10")
        if name in settings:
            raise InvalidSettingError("--set", pair, f"each name once, but '{name}' comes twice")
        if name.rpartition(".")[2] == "method" and text in RENAMED_METHODS:
            warn_renamed(renamed_method(text), RenamedValueWarning)
        settings[name] = _value(name, text)
    return tuple(settings.items())


def _value(name: str, text: str) -> Value:
    """Return a value as a number, numbers, a truth value, nothing, or a word."""
    words: dict[str, Value] = {"true": True, "false": False, "none": None}
    if text.lower() in words:
        return words[text.lower()]
    numbers = [_number(part) for part in text.split(",")]
    known = tuple(float(number) for number in numbers if number is not None)
    if len(numbers) == 1:
        return text if numbers[0] is None else numbers[0]
    if len(known) < len(numbers):
        raise InvalidSettingError(name, text, "numbers with commas between them")
    return known


def _number(text: str) -> int | float | None:
    """Return a finite number, an integer where it is written as one; None if it is none."""
    for kind in (int, float):
        with suppress(ValueError):
            number = kind(text)
            return number if math.isfinite(number) else None
    return None


def engine_settings(pairs: Sequence[str], engines: Sequence[str]) -> dict[str, dict[str, Value]]:
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
    settings: dict[str, dict[str, Value]] = {}
    for words, value in parse_settings(list(pairs)):
        chosen, dot, name = words.rpartition(".")
        if dot and chosen not in engines:
            allowed = f"a setting of an engine that runs: {', '.join(engines)}"
            raise InvalidSettingError("--set", words, allowed)
        having = [chosen] if dot else [each for each in engines if name in _names(each)]
        if not having:
            known = "; ".join(f"{each}: {', '.join(sorted(_names(each)))}" for each in engines)
            raise InvalidSettingError("--set", words, f"ENGINE.KEY=VALUE with one of {known}")
        for each in having:
            if name in settings.setdefault(each, {}):
                raise InvalidSettingError("--set", words, f"each once, but {each} has it twice")
            settings[each][name] = value
    return settings


def settings_to_dict(chosen: Mapping[str, Mapping[str, Value]]) -> dict[str, str]:
    """Return settings as a manifest tells them, by `engine.name`."""
    return {
        f"{one}.{name}": ",".join(map(repr, value)) if isinstance(value, tuple) else str(value)
        for one, own in chosen.items()
        for name, value in own.items()
    }


def _names(name: str) -> set[str]:
    """Return the names of an engine's settings."""
    return {setting.name for setting in engine(name).settings}
