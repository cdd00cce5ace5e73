"""Which colour and mark a curve has: by whose curve it is, the same in every figure of a report.

The exact motion has a colour of its own, an engine the one that it declares; others take those of
engines that are not there, in order.

Each kind has two colours of one hue, one for a light and one for a dark page. Each stands out from
its page by at least 3:1 (WCAG 2.2, 1.4.11), and any two inks stay apart for the three
kinds of colour blindness; both are tested. Line, dash and mark repeat what the colour says.

What a figure's legend says: one entry for each label, whatever panels it appears in.

Colours of quantities over a plane: the same on paper and on the screen.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import cycle
from types import MappingProxyType

import numpy as np

from harness.core.report_model import Figure, Heatmap
from harness.core.trajectory import Floats
from harness.engines.registry import description_of, our_names

PAPER_LIGHT = "#fcfbf8"
PAPER_DARK = "#14171c"


@dataclass(frozen=True, slots=True, kw_only=True)
class LineStyle:
    """How one kind of curve is drawn.

    Parameters
    ----------
    light, dark : str
        Colour on a light and on a dark page, #rrggbb.
    width : float
        Of the line, in CSS pixels; the truth is wide so that it shows below what lies on it.
    """

    light: str
    dark: str
    width: float = 1.8


REFERENCE = LineStyle(light="#16181d", dark="#f3f0e9", width=3.4)

BACKGROUND = LineStyle(light="#8a8f97", dark="#777d87", width=1.0)
"""Of the curves of a crowd that are not told apart: the kind "background"."""


_OURS = {"reference": REFERENCE, "background": BACKGROUND}


def palette(kinds: Iterable[str]) -> Mapping[str, LineStyle]:
    """Return the line style of each kind; what declares none takes one that is free, in order.

    Parameters
    ----------
    kinds : iterable of str
        Every kind in the report, in any order: the result does not depend on it.
    """
    chosen = {kind: _declared(kind) for kind in sorted(set(kinds))}
    ours = {name: _declared(name) for name in our_names() if name != "reference"}
    free = [style for name, style in ours.items() if style and name not in chosen]
    further = cycle(free or filter(None, ours.values()))
    return MappingProxyType({kind: chosen[kind] or next(further) for kind in chosen})


def _declared(kind: str) -> LineStyle | None:
    """Return the line style of the exact motion, of a crowd, or that an engine declares, if any."""
    if kind in _OURS:
        return _OURS[kind]
    said = description_of(kind)
    if not (said.light and said.dark):
        return None
    return LineStyle(light=said.light, dark=said.dark)


FADED = 0.8  # opacity of the second and later labels of a kind
BAR_WIDTH = 0.7  # of the distance between two places
PALE = 0.45  # the same of bars, which have no dashes or marks to tell them apart

_SOLID: tuple[tuple[int, ...], ...] = ((), (2, 3), (10, 3, 2, 3))
_DASHED: tuple[tuple[int, ...], ...] = ((7, 4), (7, 3, 2, 3), (14, 5))


@dataclass(frozen=True, slots=True, kw_only=True)
class Entry:
    """One label and how its curves look.

    Parameters
    ----------
    label, kind : str
    line, points, bars : bool
        What the curves show.
    dashed : bool
    dashes : tuple of int
        Lengths of strokes and gaps in CSS pixels; empty for an unbroken line.
    rank : int
        How many earlier labels of the figure are of the same kind: decides the mark.
    """

    label: str
    kind: str
    line: bool
    points: bool
    bars: bool
    dashed: bool
    dashes: tuple[int, ...]
    rank: int

    @property
    def opacity(self) -> float:
        """Opacity of the curves: the first label of a kind is the most solid."""
        if self.rank == 0:
            return 1.0
        return PALE if self.bars else FADED


def entries(figure: Figure) -> tuple[Entry, ...]:
    """Return the legend of a figure, in the order of first appearance."""
    legend: dict[str, Entry] = {}
    for series in (series for panel in figure.panels for series in panel.series):
        if series.label in legend:
            continue
        kin = [entry for entry in legend.values() if entry.kind == series.kind]
        unbroken = (description_of(series.kind).dashes, *_SOLID[1:])
        styles = _DASHED if series.dashed else unbroken
        alike = sum(entry.dashed == series.dashed for entry in kin)
        legend[series.label] = Entry(
            label=series.label,
            kind=series.kind,
            line=series.mark in {"line", "both"},
            points=series.mark in {"points", "both"},
            bars=series.mark == "bars",
            dashed=series.dashed,
            dashes=styles[alike % len(styles)],
            rank=len(kin),
        )
    return tuple(legend.values())


Scale = tuple[tuple[float, str], ...]

PLAIN: tuple[str, str] = ("viridis", "Viridis")
"""From dark to light, read the same by all kinds of sight: on paper and on the screen."""

PLAIN_COLOURS: Scale = (
    *((0.0, "#440154"), (0.125, "#472d7b"), (0.25, "#3b528b"), (0.375, "#2c728e")),
    *((0.5, "#21918c"), (0.625, "#28ae80"), (0.75, "#5ec962"), (0.875, "#addc30")),
    (1.0, "#fde725"),
)
"""The same in colours."""

SIGNED: tuple[str, Scale] = (
    "PuOr_r",
    ((0.0, "#2d004b"), (0.25, "#8073ac"), (0.5, "#f7f7f7"), (0.75, "#e08214"), (1.0, "#7f3b08")),
)
"""Purple to orange, pale between: different for the colour-blind too."""


_MOST = 0.99
_FAR = 10.0

LARGEST = 1e250
"""What is drawn of a larger number: doubles have room for sums, ticks, and margins of decades."""

_LEAST = 1e-305  # that a range is wide: its ticks are doubles with all their digits
_ALIKE = 1e-12  # of the larger end: a narrower range is as good as one number


def limited(values: Floats) -> Floats:
    """Return finite numbers no larger than any that can be drawn, and others as they are."""
    return np.where(np.isfinite(values), np.clip(values, -LARGEST, LARGEST), values)


def widened(low: float, high: float) -> tuple[float, float]:
    """Return the ends of a scale, of numbers that can be drawn and that ticks tell apart."""
    low, high = (min(max(end, -LARGEST), LARGEST) for end in (low, high))
    largest = max(abs(low), abs(high))
    if high - low > max(2.0 * _ALIKE * largest, _LEAST):
        return low, high
    half = 0.5 * largest if largest > _LEAST else 0.5
    return low - half, high + half


def span(heat: Heatmap) -> tuple[float, float]:
    """Return the ends of the scale: of the numbers there are, alike on both sides of a sign.

    Where a few numbers are ten times as large as all others, the scale is that of the others; about
    one number it is half as wide to both sides as the number is large.
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
        return widened(-reach, reach)
    return widened(low, high)
