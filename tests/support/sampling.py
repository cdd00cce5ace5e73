"""A sample of a test's parameters in which each value, or each pair of values, still occurs."""

from collections.abc import Hashable, Sequence
from itertools import combinations

import pytest

Tuples = frozenset[tuple[tuple[int, Hashable], ...]]
"""Values, each with the number of its parameter, that occur together."""


def covering(rows: Sequence[tuple[Hashable, ...]]) -> list[int]:
    """Return which rows to keep, in order: a few that hold what all of them hold.

    Of two parameters each value occurs; of three and more, each pair of values. With one, all rows
    stay. The next row is always the first of those that add most, so the choice is the same
    wherever it is made.

    Parameters
    ----------
    rows : sequence of tuple
        The value, or its number, of each parameter; all rows have as many.
    """
    strength = min(len(rows[0]) - 1, 2) if rows else 0
    if strength < 1:
        return list(range(len(rows)))
    held = [frozenset(combinations(enumerate(row), strength)) for row in rows]
    missing: Tuples = frozenset().union(*held)
    kept: list[int] = []
    while missing:
        best = max(range(len(rows)), key=lambda n: len(held[n] & missing))
        kept.append(best)
        missing -= held[best]
    return sorted(kept)


def sampled(items: Sequence[pytest.Item]) -> list[pytest.Item]:
    """Return tests in their order, of those with several parameters a covering sample."""
    functions: dict[str, list[pytest.Item]] = {}
    for item in items:
        functions.setdefault(item.nodeid.partition("[")[0], []).append(item)
    kept = {own[n] for own in functions.values() for n in covering(_rows(own))}
    return [item for item in items if item in kept]


def _rows(items: Sequence[pytest.Item]) -> list[tuple[Hashable, ...]]:
    """Return the parameters of the tests of one function; those that go together are one."""
    indices = [getattr(getattr(item, "callspec", None), "indices", {}) for item in items]
    columns = {tuple(own.get(name) for own in indices) for name in indices[0]}
    ordered = sorted(columns, key=lambda column: [str(one) for one in column])
    return list(zip(*ordered, strict=True)) if ordered else [()] * len(items)
