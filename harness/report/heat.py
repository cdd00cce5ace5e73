"""Colours of quantities over a plane: the same on paper and on the screen."""

import numpy as np

from harness.artefact import Heat

Scale = tuple[tuple[float, str], ...]

PLAIN: tuple[str, Scale | str] = ("viridis", "Viridis")
"""From dark to light, read the same by all kinds of sight: on paper and on the screen."""

SIGNED: tuple[str, Scale | str] = (
    "PuOr_r",
    ((0.0, "#2d004b"), (0.25, "#8073ac"), (0.5, "#f7f7f7"), (0.75, "#e08214"), (1.0, "#7f3b08")),
)
"""Purple to orange, pale between: apart for the colour-blind too."""


_MOST = 0.99
_FAR = 10.0


def span(heat: Heat) -> tuple[float, float]:
    """Return the ends of the scale: of the numbers there are, alike on both sides of a sign.

    Where a few numbers are ten times as large as all others, the scale is that of the others.
    """
    there = heat.z[np.isfinite(heat.z)]
    if not there.size:
        return -1.0, 1.0
    low, high = float(there.min()), float(there.max())
    most = float(np.quantile(np.abs(there), _MOST))
    if max(abs(low), abs(high)) > _FAR * most > 0.0:
        low, high = max(low, -most), min(high, most)
    if heat.signed:
        reach = max(abs(low), abs(high)) or 1.0
        return -reach, reach
    return (low, high) if high > low else (low - 1.0, high + 1.0)
