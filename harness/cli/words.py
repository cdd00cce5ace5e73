"""Reading what people type: `--set KEY=VALUE`."""

import math

from harness.case import Value
from harness.errors import InvalidSettingError

_WORDS: dict[str, Value] = {"true": True, "false": False, "none": None}


def settings(pairs: list[str]) -> tuple[tuple[str, Value], ...]:
    """Return the settings that `--set` was given, by name.

    Raises
    ------
    InvalidSettingError
        If one is not of the form KEY=VALUE, is given twice, or is not a number where it seems one.
    """
    found: dict[str, Value] = {}
    for pair in pairs:
        name, equals, text = pair.partition("=")
        if not equals or not name:
            raise InvalidSettingError("--set", pair, "KEY=VALUE, such as impratio=10")
        if name in found:
            raise InvalidSettingError("--set", pair, f"each name once, but '{name}' comes twice")
        found[name] = value(name, text)
    return tuple(found.items())


def value(name: str, text: str) -> Value:
    """Return a value as a number, numbers, a truth value, nothing, or a word."""
    if text.lower() in _WORDS:
        return _WORDS[text.lower()]
    if "," in text:
        numbers = tuple(_number(part) for part in text.split(","))
        if any(number is None for number in numbers):
            raise InvalidSettingError(name, text, "numbers with commas between them")
        return tuple(float(number) for number in numbers if number is not None)
    number = _number(text)
    return text if number is None else number


def _number(text: str) -> int | float | None:
    """Return a finite number, an integer where it is written as one; None if it is none."""
    try:
        return int(text)
    except ValueError:
        pass
    try:
        number = float(text)
    except ValueError:
        return None
    return number if math.isfinite(number) else None
