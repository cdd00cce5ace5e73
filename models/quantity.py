"""The numbers a scene is made of: finite doubles inside their physical range.

Each function returns the number as a plain `float` without a signed zero, so that equal scenes are
equal objects with equal hashes and equal digests, whatever kind of number they were built from.
"""

import math
from numbers import Real

from models.errors import InvalidValueError


def finite(key: str, value: object, allowed: str = "a finite number") -> float:
    """Return `value` as a finite float; raise `InvalidValueError` if it is not one."""
    if isinstance(value, bool) or not isinstance(value, Real):
        raise InvalidValueError(key, value, allowed)
    try:
        number = float(value)
    except OverflowError:  # an integer beyond the largest double
        raise InvalidValueError(key, "an integer beyond all doubles", allowed) from None
    if not math.isfinite(number):
        raise InvalidValueError(key, number, allowed)
    return number + 0.0  # -0.0 + 0.0 is 0.0


def positive(key: str, value: object) -> float:
    """Return `value` as a finite float greater than zero, or raise `InvalidValueError`."""
    allowed = "a finite number greater than zero"
    number = finite(key, value, allowed)
    if number <= 0.0:
        raise InvalidValueError(key, number, allowed)
    return number


def not_negative(key: str, value: object) -> float:
    """Return `value` as a finite float, zero or greater, or raise `InvalidValueError`."""
    allowed = "a finite number, zero or greater"
    number = finite(key, value, allowed)
    if number < 0.0:
        raise InvalidValueError(key, number, allowed)
    return number
