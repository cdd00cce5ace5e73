"""What a figure's legend says: one entry for each label, whatever panels it appears in."""

from dataclasses import dataclass

from harness.artefact import Figure, Series

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
    found: dict[str, Entry] = {}
    for series in _all(figure):
        if series.label in found:
            continue
        kin = [entry for entry in found.values() if entry.kind == series.kind]
        styles = _DASHED if series.dashed else _SOLID
        alike = sum(entry.dashed == series.dashed for entry in kin)
        found[series.label] = Entry(
            label=series.label,
            kind=series.kind,
            line=series.mark in {"line", "both"},
            points=series.mark in {"points", "both"},
            bars=series.mark == "bars",
            dashed=series.dashed,
            dashes=styles[alike % len(styles)],
            rank=len(kin),
        )
    return tuple(found.values())


def _all(figure: Figure) -> list[Series]:
    return [series for panel in figure.panels for series in panel.series]
