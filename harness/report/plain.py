"""Values in JSON's own types."""

import math
import numbers
from collections.abc import Mapping


def plain(value: object) -> object:
    """Return a value in JSON's own types: what JSON cannot say, infinity included, as text."""
    if isinstance(value, Mapping):
        return {str(key): plain(inner) for key, inner in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(inner) for inner in value]
    if value is None or isinstance(value, (str, bool)):
        return value
    if isinstance(value, numbers.Integral):
        return int(value)
    if isinstance(value, numbers.Real) and math.isfinite(value):
        return float(value)
    return str(value)
