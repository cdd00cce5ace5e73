"""How many examples a test draws, and how much of a long table it goes through."""

from collections.abc import Sequence
from typing import TypeVar

from hypothesis import settings

T = TypeVar("T")


def examples(share: float) -> int:
    """Return a share of the examples of the profile in force, for tests of another cost each."""
    return max(1, int(settings().max_examples * share))


def evenly(rows: Sequence[T]) -> Sequence[T]:
    """Return evenly spaced rows of a table: all where the profile has a hundred examples."""
    return rows[:: max(1, 100 // settings().max_examples)]
