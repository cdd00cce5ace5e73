"""Values, arrays and frames in JSON's own types and back, without loss of a digit.

The annotated types at the end say how pydantic stores the fields of artefacts.
"""

import base64
import math
import numbers
from collections.abc import Mapping
from typing import Annotated, Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from pydantic import PlainSerializer, PlainValidator

from harness.core.verdict import Status, Verdict


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


def _encode_cell(value: object) -> object:
    if is_missing(value):
        return None
    if isinstance(value, Verdict):
        return {"status": value.status.name, "text": value.text}
    if isinstance(value, float) and math.isinf(value):
        return {"inf": 1 if value > 0.0 else -1}
    return to_plain(value)


def _decode_cell(stored: object) -> object:
    if not isinstance(stored, dict):
        return stored
    if "inf" in stored:
        return stored["inf"] * math.inf
    return Verdict(Status[stored["status"]], stored["text"])


def _encode_frame(frame: pd.DataFrame) -> dict[str, Any]:
    """Return each column with its type; infinite and missing cells have encodings of their own."""
    return {
        str(name): {
            "dtype": str(frame[name].dtype),
            "values": [_encode_cell(value) for value in frame[name].tolist()],
        }
        for name in frame.columns
    }


def _decode_frame(stored: Any) -> pd.DataFrame:  # noqa: ANN401 - whatever JSON holds
    return pd.DataFrame(
        {
            name: pd.Series([_decode_cell(v) for v in column["values"]], dtype=column["dtype"])
            for name, column in stored.items()
        }
    )


Floats = Annotated[
    NDArray[np.float64], PlainValidator(_decode_array), PlainSerializer(_encode_array)
]
Frame = Annotated[pd.DataFrame, PlainValidator(_decode_frame), PlainSerializer(_encode_frame)]
Words = Annotated[Mapping[str, str], PlainSerializer(dict)]
Record = Annotated[Mapping[str, Any], PlainSerializer(to_plain)]
