"""Thin curves by error: leave out the points whose absence nobody can see.

A curve of an engine has a point for each step, up to millions; a screen has a thousand pixels. The
points that stay are those of Ramer, Douglas and Peucker: every point left out is within a tolerance
of the line that replaces it, in shares of the panel on its own (linear or logarithmic) axes.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import groupby

import numpy as np
from numpy.typing import NDArray

from harness.core.report_model import Figure, Panel, Series
from harness.core.trajectory import Floats
from harness.report.style import limited


@dataclass(frozen=True, slots=True, kw_only=True)
class Detail:
    """How much of a curve can be seen.

    Parameters
    ----------
    tolerance : float
        By how much a line may be off, in shares of the panel.
    columns : int
        A line that still has more than four points for each of so many columns is noise to the eye:
        it keeps its envelope in each column.
    """

    tolerance: float
    columns: int


# a panel a thousand pixels wide, zoomed in 20 times: one pixel; noise: half a pixel
SCREEN = Detail(tolerance=1.0 / 20_000.0, columns=2_000)
# two panels in a row 1200 pixels wide: a seventh of a pixel; noise: a pixel
PAPER = Detail(tolerance=1.0 / 4_000.0, columns=600)
# a picture in the page, 600 pixels wide at most: a third of a pixel; noise: a pixel
STILL = Detail(tolerance=1.0 / 1_800.0, columns=600)


def simplify(figure: Figure, detail: Detail) -> Figure:
    """Return the figure with each line thinned; a point that has a mark of its own stays."""
    return replace(figure, panels=tuple(_panel(panel, detail) for panel in figure.panels))


def plottable(series: Series, panel: Panel) -> tuple[Floats, Floats]:
    """Return x and y with NaN where the panel's axes have no place for the point.

    Numbers are limited to those that can be drawn.

    Returns
    -------
    x, y : ndarray, shape (n,)
    """
    x = limited(np.asarray(series.x, dtype=np.float64))
    y = limited(np.asarray(series.y, dtype=np.float64))
    bad = ~(np.isfinite(x) & np.isfinite(y))
    if panel.log_x:
        bad |= x <= 0.0
    if panel.log_y:
        bad |= y <= 0.0
    x[bad] = np.nan
    y[bad] = np.nan
    return x, y


def bar_base(series: Series) -> Floats:
    """Return where the bars of a series begin, limited as their ends are, shape (n,)."""
    return np.zeros(len(series.y)) if series.base is None else limited(series.base)


Indices = NDArray[np.intp]
_AT_ONCE = 100_000
"""Points, and the line that goes beyond: thinned together they take some tens of megabytes."""


def kept_points(
    points: Floats, firsts: Indices, lasts: Indices, tolerance: float
) -> NDArray[np.bool_]:
    """Return which points stay so that the lines through them are off by the tolerance at most.

    All segments of one generation are split at once, those of all lines: a million points take a
    second, and a hundred short lines little longer than one of them.

    Parameters
    ----------
    points : ndarray, shape (n, 2)
        Finite from the first point of a line to its last.
    firsts, lasts : ndarray of int, shape (m,)
        Where each line begins and ends; these points stay.
    tolerance : float
        Largest distance of a point left out from the segment that replaces it.

    Returns
    -------
    ndarray of bool, shape (n,)
    """
    columns = np.ascontiguousarray(points.T)
    stays = np.zeros(len(points), dtype=bool)
    stays[firsts] = stays[lasts] = True
    starts, ends = firsts, lasts
    while True:
        wide = ends - starts > 1  # only these have points between
        starts, ends = starts[wide], ends[wide]
        if not starts.size:
            return stays
        inner = ends - starts - 1
        first = np.cumsum(inner) - inner
        owner = np.repeat(np.arange(starts.size), inner)
        index = np.arange(owner.size) + (starts + 1 - first)[owner]
        off = _distance(columns, index, starts, ends, owner)
        worst = np.maximum.reduceat(off, first)
        candidates = np.flatnonzero(off == worst[owner])
        one_each = candidates[np.searchsorted(owner[candidates], np.arange(starts.size))]
        far = worst > tolerance
        split = index[one_each][far]
        stays[split] = True
        starts, ends = np.concatenate((starts[far], split)), np.concatenate((split, ends[far]))


def _distance(
    columns: Floats, index: Indices, starts: Indices, ends: Indices, owner: Indices
) -> Floats:
    """Return the distance of points from their segments, both by number, shape (n,)."""
    x, y = columns  # each on its own: sums over rows of two are slow
    from_x, from_y = x[starts], y[starts]
    along_x, along_y = x[ends] - from_x, y[ends] - from_y
    squared = along_x**2 + along_y**2
    squared[squared == 0.0] = 1.0
    from_x, from_y, along_x, along_y = (own[owner] for own in (from_x, from_y, along_x, along_y))
    off_x, off_y = x[index], y[index]
    share = ((off_x - from_x) * along_x + (off_y - from_y) * along_y) / squared[owner]
    np.clip(share, 0.0, 1.0, out=share)
    off_x -= from_x + share * along_x
    off_y -= from_y + share * along_y
    distance: Floats = np.sqrt(off_x**2 + off_y**2)
    return distance


def _panel(panel: Panel, detail: Detail) -> Panel:
    data = [plottable(series, panel) for series in panel.series]
    scaled = [
        np.column_stack(
            (np.log10(x) if panel.log_x else x, np.log10(y) if panel.log_y else y),
        )
        for x, y in data
    ]
    everything = np.concatenate([*scaled, np.empty((0, 2))])
    everything = everything[np.isfinite(everything).all(axis=1)]
    if not everything.size:
        return panel
    low, span = everything.min(axis=0), np.ptp(everything, axis=0)
    if panel.equal:
        span = np.full(2, span.max())
    span[span == 0.0] = 1.0
    lines = [i for i, series in enumerate(panel.series) if series.mark == "line" and len(series.x)]
    before = dict(zip(lines, np.cumsum([len(scaled[i]) for i in lines]), strict=True))
    stays: dict[int, NDArray[np.bool_]] = {}
    for _, group in groupby(lines, key=lambda i: before[i] // _AT_ONCE):
        some = list(group)
        of_lines = _of_lines([(scaled[i] - low) / span for i in some], detail)
        stays |= zip(some, of_lines, strict=True)
    return replace(
        panel,
        series=tuple(
            _thinned(series, stays[i]) if i in stays else series
            for i, series in enumerate(panel.series)
        ),
    )


def _of_lines(lines: Sequence[Floats], detail: Detail) -> list[NDArray[np.bool_]]:
    """Return for each line which of its points stay; of each gap one does."""
    points = np.concatenate(lines)
    lengths = np.array([len(line) for line in lines], dtype=np.intp)
    line = np.repeat(np.arange(len(lines)), lengths)
    finite = np.isfinite(points[:, 0]) & np.isfinite(points[:, 1])
    firsts = np.flatnonzero(np.append(True, (line[1:] != line[:-1]) | (finite[1:] != finite[:-1])))
    lasts = np.append(firsts[1:], len(points)) - 1
    drawn = finite[firsts]
    stays = kept_points(points, firsts[drawn], lasts[drawn], detail.tolerance)
    stays[firsts[~drawn]] = True  # one NaN breaks the line as well as many
    many = np.add.reduceat(stays, firsts, dtype=np.intp) > 4 * detail.columns
    for first, last in zip(firsts[many], lasts[many], strict=True):
        chosen = first + np.flatnonzero(stays[first : last + 1])
        if np.all(np.diff(points[chosen, 0]) >= 0.0):
            stays[first : last + 1] = False
            stays[chosen[_envelope(points[chosen], detail.columns)]] = True
    return np.split(stays, np.cumsum(lengths)[:-1])


def _thinned(series: Series, stays: NDArray[np.bool_]) -> Series:
    """Return the series with the points that stay."""
    if stays.all():
        return series
    return replace(
        series,
        x=series.x[stays],
        y=series.y[stays],
        hover=tuple(t for t, s in zip(series.hover, stays, strict=True) if s)
        if series.hover
        else (),
    )


def _envelope(points: Floats, columns: int) -> NDArray[np.intp]:
    """Return the first, lowest, highest and last point of each column, as sorted indices."""
    column = np.minimum((points[:, 0] * columns).astype(np.int64), columns - 1)
    order = np.lexsort((points[:, 1], column))
    starts = np.flatnonzero(np.diff(column, prepend=-1))
    ends = np.append(starts[1:], len(points)) - 1
    return np.unique(np.concatenate((starts, ends, order[starts], order[ends])))
