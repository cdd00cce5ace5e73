"""Values as strict JSON holds them, and back without loss.

JSON has no tuples and no infinite numbers. Both are wrapped in an object of one key that no record
of ours uses, so that what is read equals what was written, its types included. Floats are written
with as many digits as they need to come back bit for bit.
"""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

_TUPLE, _FLOAT = "(tuple)", "(float)"


def plain(value: object) -> Any:  # noqa: ANN401 - JSON is of any type
    """Return a value in JSON's own types.

    Raises
    ------
    TypeError
        If it is, or holds, something else than mappings, lists, tuples, text, numbers, truth values
        and None.
    """
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, Mapping):
        return {str(key): plain(inner) for key, inner in value.items()}
    if isinstance(value, tuple):
        return {_TUPLE: [plain(inner) for inner in value]}
    if isinstance(value, list):
        return [plain(inner) for inner in value]
    if isinstance(value, float) and not math.isfinite(value):
        return {_FLOAT: repr(value)}
    if value is None or isinstance(value, str | bool | int | float):
        return value
    raise TypeError(f"a store keeps no {type(value).__name__}")


def restored(value: Any) -> Any:  # noqa: ANN401 - JSON is of any type
    """Return what `plain` was given."""
    if isinstance(value, list):
        return [restored(inner) for inner in value]
    if not isinstance(value, dict):
        return value
    if set(value) == {_TUPLE}:
        return tuple(restored(inner) for inner in value[_TUPLE])
    if set(value) == {_FLOAT}:
        return float(value[_FLOAT])
    return {key: restored(inner) for key, inner in value.items()}
