"""A sweep without its rows: what consecutive scenes amount to, and how such summaries are merged.

A reduction has a count of each outcome, and of each quantity its moments, extremes and histograms;
and what is drawn: the cells of the map, or the points of the curve. It takes as much memory for a
thousand million scenes as for a million. Counts, extremes and histograms are merged exactly, sums
by `math.fsum`, which rounds once: the order in which partitions were made changes no bit.
"""

import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from harness.core.trajectory import Floats
from harness.execution.cache_entry import Metadata, read_entry, write_entry
from harness.sweep.drawing import Curves, Drawn, Map, drawing_of
from harness.sweep.histogram import Histogram, histogram, merged_histogram
from harness.sweep.partition import OUTCOME, compute
from harness.sweep.plan import SweepPlan

BLOCK_ROWS = 131_072
"""Rows in memory at a time: the few hard ones among them are solved together."""

_KIND = "reduction"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Extent:
    """A quantity over scenes: how many have it, its moments, extremes and distribution.

    Parameters
    ----------
    name : str
    count : int
        Scenes in which the quantity is finite; of none the other numbers mean nothing.
    infinite : int
        Scenes in which it is infinite: no other number has them.
    total : float
        Sum of the values.
    squares : float
        Sum of the squared deviations from the mean.
    low, high : float
    low_row, high_row : int
        The scenes that have them; of several the first.
    even, rising, falling : Histogram
        Of all finite values in even bins; of those above zero, and of the negatives of those below,
        in bins by ratio.
    """

    name: str
    count: int
    infinite: int
    total: float
    squares: float
    low: float
    high: float
    low_row: int
    high_row: int
    even: Histogram
    rising: Histogram
    falling: Histogram

    @property
    def mean(self) -> float:
        """Over the scenes that have it."""
        return self.total / self.count

    @property
    def deviation(self) -> float:
        """Standard deviation over the scenes that have it."""
        return math.sqrt(self.squares / self.count)

    def quantile(self, share: float) -> tuple[float, float]:
        """Return two numbers between which the value lies that this share of scenes does not reach.

        Both histograms say so, and the values are between the extremes.
        """
        count = int(self.even.counts.sum())
        rank = min(int(share * count), count - 1)
        ends = [(self.low, self.high), self.even.between(rank)]
        below, above = int(self.falling.counts.sum()), int(self.rising.counts.sum())
        if rank < below:
            low, high = self.falling.between(below - 1 - rank)
            ends.append((-high, -low))
        elif rank >= count - above:
            ends.append(self.rising.between(rank - (count - above)))
        return max(low for low, _ in ends), min(high for _, high in ends)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Reduction:
    """What the scenes from `start` to before `stop` amount to.

    Parameters
    ----------
    start, stop : int
    outcomes : mapping of str to int
        Scenes by how they ended.
    extents : tuple of Extent
        Of each quantity of the plan.
    drawn : Drawn
        For the figure of the sweep.
    """

    start: int
    stop: int
    outcomes: Mapping[str, int]
    extents: tuple[Extent, ...]
    drawn: Drawn

    def __len__(self) -> int:
        """Return the number of scenes."""
        return self.stop - self.start


def reduced(plan: SweepPlan, rows: range) -> Reduction:
    """Return the reduction of consecutive scenes, computed block by block.

    Parameters
    ----------
    plan : SweepPlan
        Of the exact bounce.
    rows : range
    """
    starts = range(rows.start, rows.stop, BLOCK_ROWS)
    blocks = (range(start, min(start + BLOCK_ROWS, rows.stop)) for start in starts)
    drawing = drawing_of(plan)
    parts = (reduction_of(plan, compute(plan, block), drawing) for block in blocks)
    return merged(plan, parts, drawing)


def reduction_of(plan: SweepPlan, part: pd.DataFrame, drawing: Map | Curves) -> Reduction:
    """Return the reduction of consecutive rows; what is drawn of them, `drawing` says."""
    counts, start = part[OUTCOME].value_counts(), int(part.index[0])
    return Reduction(
        start=start,
        stop=start + len(part),
        outcomes={str(sentence): int(counts[sentence]) for sentence in sorted(counts.index)},
        extents=tuple(
            _extent(name, part[name].to_numpy(dtype=np.float64), start) for name in plan.quantities
        ),
        drawn=drawing.of(part),
    )


def _extent(name: str, values: Floats, start: int) -> Extent:
    """Return the extent of a quantity in consecutive scenes, NaN where a scene has none.

    This is the one place that decides on numbers that are not finite: infinite ones are counted,
    and no moment, extreme or histogram has them.
    """
    rows = np.flatnonzero(np.isfinite(values))
    infinite = int(np.isinf(values).sum())
    known = values[rows]
    if not known.size:
        return _nothing(name, infinite)
    least, most = int(known.argmin()), int(known.argmax())
    with np.errstate(invalid="ignore", over="ignore"):  # of huge values
        total = float(known.sum())
        shift = known - total / known.size
        squares = float((shift * shift).sum())
    return Extent(
        name=name,
        count=known.size,
        infinite=infinite,
        total=total,
        squares=squares,
        low=float(known[least]),
        high=float(known[most]),
        low_row=start + int(rows[least]),
        high_row=start + int(rows[most]),
        **_histograms(known),
    )


def _nothing(name: str, infinite: int) -> Extent:
    """Return the extent of a quantity that is finite in no scene."""
    none = np.empty(0)
    return Extent(
        name=name,
        count=0,
        infinite=infinite,
        total=0.0,
        squares=0.0,
        low=math.inf,
        high=-math.inf,
        low_row=-1,
        high_row=-1,
        **_histograms(none),
    )


def _histograms(finite: Floats) -> dict[str, Histogram]:
    """Return the three histograms of values."""
    return {
        "even": histogram(finite, by_ratio=False),
        "rising": histogram(finite[finite > 0.0], by_ratio=True),
        "falling": histogram(-finite[finite < 0.0], by_ratio=True),
    }


_TOGETHER = 64
"""Histograms in memory before they are merged."""


class _Merger:
    """Extents of one quantity, merged."""

    def __init__(self, name: str) -> None:
        self._name = name
        self._infinite = 0
        self._moments: list[tuple[int, float, float]] = []
        self._low, self._high = (math.inf, 0), (-math.inf, 0)
        self._histograms: dict[str, list[Histogram]] = {"even": [], "rising": [], "falling": []}

    def add(self, part: Extent) -> None:
        """Take an extent into account; of one without finite values, how many are infinite."""
        self._infinite += part.infinite
        if not part.count:
            return
        self._moments.append((part.count, part.total, part.squares))
        self._low = min(self._low, (part.low, part.low_row))
        self._high = max(self._high, (part.high, -part.high_row))
        for kind, known in self._histograms.items():
            known.append({"even": part.even, "rising": part.rising, "falling": part.falling}[kind])
            if len(known) == _TOGETHER:
                known[:] = [merged_histogram(known)]

    def extent(self) -> Extent:
        """Return the extent of all scenes."""
        if not self._moments:
            return _nothing(self._name, self._infinite)
        count = sum(part for part, _, _ in self._moments)
        total = _sum([part for _, part, _ in self._moments])
        squares = [part for _, _, part in self._moments]
        # each part's mean is away from that of all
        mean = total / count
        squares += [(part - n * mean) * (part / n - mean) for n, part, _ in self._moments]
        return Extent(
            name=self._name,
            count=count,
            infinite=self._infinite,
            total=total,
            squares=_sum(squares),
            low=self._low[0],
            high=self._high[0],
            low_row=self._low[1],
            high_row=-self._high[1],
            **{kind: merged_histogram(known) for kind, known in self._histograms.items()},
        )


def _sum(numbers: Sequence[float]) -> float:
    """Return a sum, rounded once; sums of huge numbers that overflowed as addition has them."""
    return math.fsum(numbers) if all(map(math.isfinite, numbers)) else sum(numbers)


def merged(plan: SweepPlan, parts: Iterable[Reduction], drawing: Map | Curves) -> Reduction:
    """Return the reduction of all scenes of some reductions, at least one.

    Parameters
    ----------
    plan : SweepPlan
    parts : iterable of Reduction
        Of scenes that follow one another, in any order. Few of them are in memory at a time.
    drawing : Map or Curves
        Empty; is filled.
    """
    outcomes: Counter[str] = Counter()
    extents = {name: _Merger(name) for name in plan.quantities}
    starts, stops = [], []
    for part in parts:
        starts.append(part.start)
        stops.append(part.stop)
        outcomes.update(part.outcomes)
        drawing.merge(part.drawn)
        for extent in part.extents:
            extents[extent.name].add(extent)
    return Reduction(
        start=min(starts),
        stop=max(stops),
        outcomes=dict(sorted(outcomes.items())),
        extents=tuple(merger.extent() for merger in extents.values()),
        drawn=drawing.drawn(),
    )


def encode_reduction(reduction: Reduction, digest: str) -> bytes:
    """Return a reduction as a file.

    Parameters
    ----------
    reduction : Reduction
    digest : str
        Of the plan; the file carries it.
    """
    label = f"scenes {reduction.start} to {reduction.stop - 1} of a sweep"
    return write_entry(_KIND, digest, Metadata(label=label), reduction)


def decode_reduction(content: bytes, digest: str) -> Reduction:
    """Return the reduction that a file was written from.

    Raises
    ------
    BrokenEntryError
        If it is of another plan or program.
    """
    reduction: Reduction = read_entry(content, _KIND, digest).value()
    return reduction
