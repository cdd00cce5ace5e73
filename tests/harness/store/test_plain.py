"""What a store writes comes back as it was, types and bits included."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from harness.core.errors import StoreError
from harness.core.simulation import Outcome
from harness.core.trajectory import Trajectory
from harness.execution.cache_entry import Decoder, Encoder, Metadata, read_entry, write_entry

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


def through(value: object) -> Any:
    """Return what is read of a value that was written."""
    content = write_entry("things", "ab", Metadata(label="a value"), value)
    return read_entry(content, "things", "ab").value()


@given(values)
def test_what_is_written_is_read(value: object) -> None:
    back = through(value)
    assert back == value
    assert shape(back) == shape(value)


def test_no_number_comes_back_as_no_number() -> None:
    back = through({"a": (math.nan, -math.inf)})
    assert math.isnan(back["a"][0])
    assert back["a"][1] == -math.inf


def test_numbers_of_numpy_are_numbers() -> None:
    assert Encoder().encode(np.float64(0.1)) == 0.1
    assert type(Encoder().encode(np.int64(3))) is int
    assert Encoder().encode(np.bool_(True)) is True  # noqa: FBT003 - a value


def test_what_json_cannot_hold_is_refused() -> None:
    with pytest.raises(TypeError, match="keeps no set"):
        Encoder().encode({"a": {1, 2}})


@pytest.mark.parametrize("kind", [np.float64, np.int64, np.bool_, np.float32])
def test_arrays_come_back_bit_for_bit(kind: type) -> None:
    array: np.ndarray = np.arange(12).reshape(4, 3).astype(kind)
    for given_ in (array, array.T, array[:0], array[::2]):
        back = through([given_])[0]
        assert (back.dtype, back.shape) == (given_.dtype, given_.shape)
        assert back.tobytes() == given_.tobytes()


def test_dataclasses_and_enumerations_come_back_and_what_recurs_is_kept_once() -> None:
    n = 5
    points, time = np.ones((n, 3)), np.linspace(0.0, 1.0, n)
    motion = Trajectory(
        time=time,
        position=points,
        quaternion=np.ones((n, 4)),
        velocity=points,
        angular_velocity=points,
        contact_point=np.full((n, 3), np.nan),
        contact_force=points,
        penetration=time,
        contact_count=np.arange(n),
    )
    one, (other, outcome), grid = through([motion, (motion, Outcome.FINISHED), motion.time])
    assert one is other
    assert outcome is Outcome.FINISHED
    assert one.contact_point.tobytes() == motion.contact_point.tobytes()
    assert not one.time.flags.writeable
    assert grid.tobytes() == motion.time.tobytes()


@pytest.mark.parametrize(
    "name", ["os:system", "subprocess:Popen", "harness.core.errors:StoreError", "harness.nothing:A"]
)
def test_a_file_names_no_other_class_than_those_of_results(name: str) -> None:
    with pytest.raises((TypeError, ImportError)):
        Decoder().decode({"(class)": [name, {}]})
    content = write_entry("things", "ab", Metadata(label=""), {"x": 1})
    assert b'"(class)"' not in content
    with pytest.raises(StoreError):
        read_entry(content.replace(b'{"x": 1}', b'{"x": 2}'), "things", "ab")
