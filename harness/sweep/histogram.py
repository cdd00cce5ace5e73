"""Histograms whose bins nest: merged exactly, in any order, without a range known beforehand.

A bin is a number of `level` fewer binary digits than the values have. Linear bins are as wide as
2^level; bins by ratio are equal parts of an octave, cut from the bits of a double, which are in the
order of the numbers. The level is the lowest at which all values lie in `MOST_BINS` bins, and so
follows from the least and the largest value alone: two halves merged are the whole, bin for bin.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from harness.core.trajectory import Floats

MOST_BINS = 1024
"""Of a histogram: a bin is a thousandth of the range, or a thirtieth of an octave of 30."""

_DIGITS = 53
"""Binary digits of a double."""

_INFINITE = int(np.array(np.inf).view(np.int64))
"""Bits of the infinite double, which are greater than those of all finite ones."""

_LOWEST = -1074
"""Exponent of the least double."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Histogram:
    """Counts of values in consecutive bins.

    Parameters
    ----------
    by_ratio : bool
        Whether bins are parts of an octave, for values greater than zero; else they are even.
    level : int
        Exponent of the width of an even bin; of bins by ratio, the last bits of a double that do
        not count.
    first : int
        Number of the first bin.
    counts : ndarray of int, shape (bins,)
        Empty if there are no values.
    """

    by_ratio: bool
    level: int
    first: int
    counts: NDArray[np.int64]

    def edges(self) -> Floats:
        """Return the edges of the bins, shape (bins + 1,)."""
        numbers = self.first + np.arange(self.counts.size + 1, dtype=np.int64)
        if self.by_ratio:
            finite = numbers <= _INFINITE >> self.level
            bits = np.where(finite, numbers, 0) << self.level
            return np.where(finite, bits.view(np.float64), np.inf)
        with np.errstate(over="ignore"):  # the last bin may end beyond the largest double
            return np.asarray(np.ldexp(numbers.astype(np.float64), self.level))

    def between(self, rank: int) -> tuple[float, float]:
        """Return the edges of the bin with the value of a rank, from 0 for the least."""
        at = int(np.searchsorted(np.cumsum(self.counts), rank, side="right"))
        low, high = self.edges()[at : at + 2]
        return float(low), float(high)


def histogram(values: Floats, *, by_ratio: bool) -> Histogram:
    """Return the histogram of finite values, greater than zero if `by_ratio`, shape (n,)."""
    if not values.size:
        return Histogram(by_ratio=by_ratio, level=_LOWEST, first=0, counts=np.zeros(0, np.int64))
    low, high = float(values.min()), float(values.max())
    if by_ratio:
        least, largest = (int(end) for end in np.array((low, high)).view(np.int64))
        level = _fitting(0, lambda level: (least >> level, largest >> level))
        bins = np.ascontiguousarray(values).view(np.int64) >> level
    else:
        most = max(abs(low), abs(high))
        finest = max(math.frexp(most)[1] - _DIGITS, _LOWEST) if most else _LOWEST
        level = _fitting(finest, lambda level: (_even(low, level), _even(high, level)))
        bins = np.floor(np.ldexp(values, -level)).astype(np.int64)
        bins[(bins == 0) & (values < 0.0)] = -1  # of what underflows
    first = int(bins.min())
    return Histogram(by_ratio=by_ratio, level=level, first=first, counts=np.bincount(bins - first))


def merged_histogram(parts: Sequence[Histogram]) -> Histogram:
    """Return the histogram of all values of some histograms of one kind, at least one."""
    there = [part for part in parts if part.counts.size]
    if not there:
        return parts[0]
    lowest = max(part.level for part in there)

    def ends(level: int) -> tuple[int, int]:
        return (
            min(part.first >> (level - part.level) for part in there),
            max((part.first + part.counts.size - 1) >> (level - part.level) for part in there),
        )

    level = _fitting(lowest, ends)
    first, last = ends(level)
    counts = np.zeros(last - first + 1, dtype=np.int64)
    for part in there:
        numbers = part.first + np.arange(part.counts.size, dtype=np.int64)
        np.add.at(counts, (numbers >> (level - part.level)) - first, part.counts)
    return Histogram(by_ratio=there[0].by_ratio, level=level, first=first, counts=counts)


def _fitting(level: int, ends: Callable[[int], tuple[int, int]]) -> int:
    """Return the lowest level from this one on at which the ends are `MOST_BINS` apart."""
    first, last = ends(level)
    # halving the distance takes as many levels as it has binary digits too many
    level += max(0, (last - first).bit_length() - MOST_BINS.bit_length())
    first, last = ends(level)
    while last - first >= MOST_BINS:
        level += 1
        first, last = ends(level)
    return level


def _even(value: float, level: int) -> int:
    return min(math.floor(math.ldexp(value, -level)), -1 if value < 0.0 else 1 << _DIGITS)
