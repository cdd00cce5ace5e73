"""Values and arrays in JSON's own types and back, without loss of a digit.

The annotated types at the end say how pydantic stores the fields of artefacts.
"""

import base64
import math
import numbers
from collections.abc import Mapping
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import PlainSerializer, PlainValidator

_PLAIN = frozenset({str, int, bool})
"""Types of values that are never missing."""


def is_missing(value: object) -> bool:
    """Return whether a cell is empty: None, NaN, NaT or NA."""
    # most cells of a report are of these types, for which the checks below take ten times as long
    kind = type(value)
    if kind is float:
        return value != value  # noqa: PLR0124 - NaN alone differs from itself
    if kind in _PLAIN:
        return False
    if value is None or type(value).__name__ in {"NAType", "NaTType"}:
        return True
    return isinstance(value, numbers.Real) and math.isnan(value)


def to_plain(value: object) -> object:
    """Return a value in JSON's own types; a value that JSON does not have, or infinity, as text."""
    if value is None or isinstance(value, (str, bool)):  # most are, and a look at them is quick
        return value
    if isinstance(value, Mapping):
        return {str(key): to_plain(inner) for key, inner in value.items()}
    if isinstance(value, (list, tuple)):
        return [to_plain(inner) for inner in value]
    if isinstance(value, numbers.Integral):
        return int(value)
    if isinstance(value, numbers.Real) and math.isfinite(value):
        return float(value)
    return str(value)


def _encode_array(values: NDArray[np.float64]) -> dict[str, Any]:
    data = base64.b64encode(values.astype("<f8").tobytes()).decode("ascii")
    return {"shape": list(values.shape), "f8": data}


def _decode_array(stored: Any) -> NDArray[np.float64]:  # noqa: ANN401 - whatever JSON holds
    values = np.frombuffer(base64.b64decode(stored["f8"]), dtype="<f8").astype(np.float64)
    return values.reshape(stored["shape"])


Floats = Annotated[
    NDArray[np.float64], PlainValidator(_decode_array), PlainSerializer(_encode_array)
]
Words = Annotated[Mapping[str, str], PlainSerializer(dict)]
Record = Annotated[Mapping[str, Any], PlainSerializer(to_plain)]
