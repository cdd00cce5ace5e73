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


def is_missing(value: object) -> bool:
    """Return whether a cell is empty: None, NaN, NaT or NA."""
    if value is None or type(value).__name__ in {"NAType", "NaTType"}:
        return True
    return isinstance(value, numbers.Real) and math.isnan(value)


def to_plain(value: object) -> object:
    """Return a value in JSON's own types; a value that JSON does not have, or infinity, as text."""
    if isinstance(value, Mapping):
        return {str(key): to_plain(inner) for key, inner in value.items()}
    if isinstance(value, (list, tuple)):
        return [to_plain(inner) for inner in value]
    if value is None or isinstance(value, (str, bool)):
        return value
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
