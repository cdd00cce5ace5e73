"""Checks of the numbers of a problem, which name the field, its allowed values, and its value.

Each function raises the error it is given where a value is not allowed, and returns nothing: a
value is taken as it is or refused.
"""

import math
from collections.abc import Mapping
from numbers import Integral, Real

FINITE = "a finite number"
POSITIVE = "a finite number greater than zero"
NOT_NEGATIVE = "a finite number, zero or greater"


class RefusedError(ValueError):
    """The root of everything that `reference` refuses.

    Parameters
    ----------
    key : str
        What is refused, as its owner names it: ``phi``, ``effects.rim``, ``model``.
    value : object
        The value.
    allowed : str
        What is allowed.
    sentence : str
        The message; left out, it says that the key must be what is allowed, and the value.
    """

    def __init__(self, key: str, value: object, allowed: str, sentence: str = "") -> None:
        super().__init__(key, value, allowed, sentence)
        self.key = key
        self.value = value
        self.allowed = allowed
        self._sentence = sentence

    def __str__(self) -> str:
        """Return the message."""
        return self._sentence or f"`{self.key}` must be {self.allowed}, got {self.value!r}"


def is_finite(value: object) -> bool:
    """Return whether a value is a real number (no bool) that a double can hold."""
    if type(value) is float:  # the look at an abstract class takes ten times as long
        return math.isfinite(value)
    if isinstance(value, bool) or not isinstance(value, Real):
        return False
    try:
        return math.isfinite(value)
    except OverflowError:  # an integer beyond all doubles
        return False


def require(
    error: type[RefusedError], name: str, value: object, allowed: str, *, when: bool
) -> None:
    """Raise `error` with one sentence unless the value is allowed."""
    if not when:
        raise error(name, value, allowed)


def require_numbers(error: type[RefusedError], values: Mapping[str, object], allowed: str) -> None:
    """Raise `error` unless each value is `FINITE`, `POSITIVE` or `NOT_NEGATIVE`, as said.

    Parameters
    ----------
    error : type
    values : mapping
        By the names of the fields.
    allowed : str
        One of the three.
    """
    for name, value in values.items():
        fits = is_finite(value)
        if fits and allowed != FINITE:
            assert isinstance(value, Real)  # noqa: S101 - `is_finite` has seen to it
            fits = float(value) > 0 or (value == 0 and allowed == NOT_NEGATIVE)
        require(error, name, value, allowed, when=fits)


def require_vector(error: type[RefusedError], name: str, value: object, length: int) -> None:
    """Raise `error` unless the value is a tuple of so many finite numbers."""
    fits = isinstance(value, tuple) and len(value) == length and all(map(is_finite, value))
    require(error, name, value, f"a tuple of {length} finite numbers", when=fits)


def is_whole(value: object) -> bool:
    """Return whether a value is an integer, of Python or NumPy, and no bool."""
    return isinstance(value, Integral) and not isinstance(value, bool)
