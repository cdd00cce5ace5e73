"""What a store writes comes back as it was, types and bits included."""

import json
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from harness.execution.cache_entry import decode, encode

leaves = st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | st.text()
values = st.recursive(
    leaves,
    lambda inner: (
        st.lists(inner, max_size=4)
        | st.lists(inner, max_size=4).map(tuple)
        | st.dictionaries(st.text(min_size=1, max_size=4), inner, max_size=4)
    ),
    max_leaves=12,
)


def shape(value: object) -> object:
    """Return the types of a value, all the way down, and the signs of its zeros."""
    if isinstance(value, dict):
        return {key: shape(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return type(value), [shape(inner) for inner in value]
    return type(value), isinstance(value, float) and math.copysign(1.0, value)


@given(values)
def test_what_is_written_is_read(value: object) -> None:
    back = decode(json.loads(json.dumps(encode(value), allow_nan=False)))
    assert back == value
    assert shape(back) == shape(value)


def test_no_number_comes_back_as_no_number() -> None:
    back = decode(json.loads(json.dumps(encode({"a": (math.nan, -math.inf)}), allow_nan=False)))
    assert math.isnan(back["a"][0])
    assert back["a"][1] == -math.inf


def test_numbers_of_numpy_are_numbers() -> None:
    assert encode(np.float64(0.1)) == 0.1
    assert type(encode(np.int64(3))) is int
    assert encode(np.bool_(True)) is True  # noqa: FBT003 - a value


def test_what_json_cannot_hold_is_refused() -> None:
    with pytest.raises(TypeError, match="keeps no set"):
        encode({"a": {1, 2}})
