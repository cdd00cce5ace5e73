"""One scene for each cell of a map: of all that fall into it the one nearest to its middle.

Not a mean: where the sign of the turn changes, the mean of two turns is a turn that no can makes.
"""

import numpy as np

from harness.artefact import Floats
from harness.sweep import Axis

MOST = 400
"""Cells across, and up: a figure has about as many pixels to tell apart."""

_PER_CELL = 2.0
"""Scenes of a sample for each cell, so that few stay blank."""


class Cells:
    """A map that is filled part by part, in memory that does not grow.

    Parameters
    ----------
    across, up : Axis
    rows : int
        Scenes to come.
    quantities : tuple of str
    """

    def __init__(self, across: Axis, up: Axis, rows: int, quantities: tuple[str, ...]) -> None:
        self._axes = (across, up)
        sampled = int(np.sqrt(rows / _PER_CELL))
        self._counts = tuple(
            min(max(1, sampled if axis.count is None else axis.count), MOST) for axis in self._axes
        )
        size = self._counts[0] * self._counts[1]
        self._nearest = np.full(size, np.inf)
        self._found = {name: np.full(size, np.nan) for name in quantities}

    def add(self, places: tuple[Floats, Floats], values: dict[str, Floats]) -> None:
        """Take scenes into account: their parameters, shape (n,), and quantities."""
        cell, away = np.zeros(len(places[0]), dtype=np.int64), np.zeros(len(places[0]))
        for axis, count, place in zip(self._axes, self._counts, places, strict=True):
            share = axis.share(place)
            fine = share * (count - 1) if axis.count is not None else share * count - 0.5
            index = np.clip(np.rint(fine), 0, count - 1).astype(np.int64)
            away += (fine - index) ** 2
            cell = cell * count + index
        order = np.lexsort((away, cell))
        first = order[np.flatnonzero(np.diff(cell[order], prepend=-1))]
        better = first[away[first] < self._nearest[cell[first]]]
        self._nearest[cell[better]] = away[better]
        for name, found in self._found.items():
            found[cell[better]] = values[name][better]

    def image(self, name: str) -> Floats:
        """Return a quantity, shape (up, across)."""
        return self._found[name].reshape(self._counts).T

    def edges(self) -> tuple[Floats, Floats]:
        """Return the edges of the cells across and up."""
        across, up = (self._edges(n) for n in range(2))
        return across, up

    def _edges(self, number: int) -> Floats:
        axis, count = self._axes[number], self._counts[number]
        ends = np.arange(count + 1, dtype=np.float64)
        if axis.low == axis.high or count == 1:
            return np.array((axis.low, axis.high if axis.high > axis.low else axis.low + 1.0))
        shares = (ends - 0.5) / (count - 1) if axis.count is not None else ends / count
        edges = axis.at(shares)
        return edges if edges[-1] > edges[0] else -np.sort(-edges)
