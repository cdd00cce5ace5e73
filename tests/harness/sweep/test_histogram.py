"""Histograms whose bins nest: a histogram of parts is that of the whole, bin for bin."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from harness.sweep.histogram import MOST_BINS, Histogram, histogram, merged_histogram
from tests.support.examples import examples


def same(one: Histogram, other: Histogram) -> bool:
    """Whether two histograms are the same."""
    return (one.level, one.first, one.counts.tolist()) == (
        other.level,
        other.first,
        other.counts.tolist(),
    )


FINITE = {
    False: st.floats(allow_nan=False, allow_infinity=False),
    True: st.floats(min_value=5e-324, allow_nan=False, allow_infinity=False),
}


@pytest.mark.parametrize("by_ratio", [False, True])
@settings(max_examples=examples(3))
@given(data=st.data())
def test_parts_merged_in_any_order_are_the_whole(data: st.DataObject, *, by_ratio: bool) -> None:
    values = np.array(data.draw(st.lists(FINITE[by_ratio], min_size=1, max_size=60)))
    cuts = sorted(data.draw(st.lists(st.integers(0, values.size), max_size=4)))
    whole = histogram(values, by_ratio=by_ratio)
    parts = [histogram(part, by_ratio=by_ratio) for part in np.split(values, cuts)]
    assert same(merged_histogram(data.draw(st.permutations(parts))), whole)
    if len(parts) > 2:
        assert same(
            merged_histogram([merged_histogram(parts[:2]), merged_histogram(parts[2:])]), whole
        )
    assert whole.counts.sum() == values.size
    assert whole.counts.size <= MOST_BINS
    order = np.sort(values)
    for rank in {0, values.size // 2, values.size - 1}:
        low, high = whole.between(rank)
        assert low <= order[rank] <= high


def test_bins_are_as_narrow_as_their_number_allows() -> None:
    values = np.random.default_rng(1).random(10_000)
    assert histogram(values, by_ratio=False).level == -10
    assert histogram(np.full(3, 0.75), by_ratio=False).counts.tolist() == [3]
    octaves = histogram(2.0 ** (10.0 * values), by_ratio=True)
    # of ten octaves each is cut in sixty-four
    assert octaves.counts.size == pytest.approx(640, abs=2)
