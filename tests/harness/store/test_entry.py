"""What is no record is said to be none, however it came about."""

import pytest

from harness.execution.cache_entry import BrokenEntryError, Defect, read_entry

_DEEP = 200_000
"""Levels: more than the interpreter follows."""


@pytest.mark.parametrize("content", [b"[" * _DEEP, b'{"a":' * _DEEP, b"[" * 900 + b"]" * 900])
def test_nesting_without_end_is_no_record(content: bytes) -> None:
    with pytest.raises(BrokenEntryError) as caught:
        read_entry(content, "toys", "abcd")
    assert caught.value.defect is Defect.NO_RECORD
