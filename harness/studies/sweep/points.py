"""Points of a curve: every so-manieth scene of a sweep, so that memory does not grow with it."""

import numpy as np

from harness.artefact import Floats

MOST = 20_000
"""Points of a curve; what lies closer no screen shows."""


class Points:
    """A curve that is filled part by part.

    Parameters
    ----------
    rows : int
        Scenes to come.
    quantities : tuple of str
    """

    def __init__(self, rows: int, quantities: tuple[str, ...]) -> None:
        self._stride = max(1, -(-rows // MOST))
        self._x: list[Floats] = []
        self._y: dict[str, list[Floats]] = {name: [] for name in quantities}

    def add(self, rows: range, x: Floats, values: dict[str, Floats]) -> None:
        """Take consecutive scenes into account."""
        there = np.arange(rows.start, rows.stop) % self._stride == 0
        self._x.append(x[there])
        for name, parts in self._y.items():
            parts.append(values[name][there])

    def curve(self, name: str) -> tuple[Floats, Floats]:
        """Return a quantity along the horizontal axis, without what has no place there."""
        x, y = np.concatenate(self._x), np.concatenate(self._y[name])
        x, y = x[~np.isnan(x)], y[~np.isnan(x)]
        order = np.argsort(x, kind="stable")
        return x[order], y[order]
