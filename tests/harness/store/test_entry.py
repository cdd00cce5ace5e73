"""What is no record is said to be none, however it came about."""

import pytest

from harness.core.errors import StoreError
from harness.execution.cache_entry import read_entry

_DEEP = 200_000
"""Levels: more than the interpreter follows."""


@pytest.mark.parametrize("content", [b"[" * _DEEP, b'{"a":' * _DEEP, b"[" * 900 + b"]" * 900])
def test_nesting_without_end_is_no_record(content: bytes) -> None:
    with pytest.raises(StoreError, match="it is no whole record"):
        read_entry(content, "toys", "abcd")
