"""A sample of a test's parameters in which each value, or each pair of values, still occurs."""

from collections.abc import Hashable, Sequence
from itertools import chain, combinations

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
    """Return the parameters of the tests of one function; those of one mark are one."""
    values = [getattr(getattr(item, "callspec", None), "params", {}) for item in items]
    marked = [_names(mark) for mark in items[0].iter_markers("parametrize")]
    groups = [*marked, *((name,) for name in values[0] if name not in {*chain(*marked)})]
    # of tests that have a value in common it is one object, which need not be hashable
    return [tuple(tuple(id(own[name]) for name in group) for group in groups) for own in values]


def _names(mark: pytest.Mark) -> tuple[str, ...]:
    """Return the parameters that a mark gives values to."""
    names = mark.args[0] if mark.args else mark.kwargs["argnames"]
    return tuple(names.replace(",", " ").split()) if isinstance(names, str) else tuple(names)
