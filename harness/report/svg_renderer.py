"""Still pictures of panels, for readers without scripts and for printers: SVG inside the page.

A picture names the page's own colours, so that it suits its light and its dark face; its texts are
the page's, too. All pictures have one width in units of their own, at which a text of 12 units can
be read on a phone and on a desk.
"""

import base64
import math
import struct
import zlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from markupsafe import escape

from harness.core.report_model import Figure, Heatmap, Panel, Series
from harness.core.trajectory import Floats
from harness.report.number_format import SUPERSCRIPT, readable
from harness.report.simplify_curves import STILL, bar_base, plottable, simplify
from harness.report.style import (
    BAR_WIDTH,
    PLAIN_COLOURS,
    SIGNED,
    Entry,
    LineStyle,
    Scale,
    entries,
    limited,
    span,
    widened,
)

_WIDTH, _HEIGHT, _SQUARE = 400.0, 270.0, 380.0
_TOP, _RIGHT = 8.0, 12.0
_LETTER, _LINE = 7.5, 16.0  # most that a digit is wide and height of a line of text
_SLANT = math.radians(30.0)  # of names below the axis
_ROOM = 0.05  # of the range of the numbers, left free at both ends
_TICKS = 6
_DECADES = (-300, 300)  # ends of a logarithmic axis: doubles have room for ticks beyond them
_ALIKE = 1e-12  # decades; numbers that are closer are as good as one
_FAR = 1e6  # units; a point beyond is as good as there
_PLAIN_FROM, _PLAIN_BELOW = 1e-3, 1e5  # numbers in between are written without a power of ten

MARKS = ("m-3 0a3 3 0 1 0 6 0a3 3 0 1 0-6 0z", "m0-4l4 4l-4 4l-4-4z", "m-3-3h6v6h-6z")
"""Outlines about a point, by the rank of a legend entry: circle, diamond, square."""


def stills(figure: Figure, inks: Mapping[str, LineStyle], colours: Mapping[str, str]) -> list[str]:
    """Return a picture of each panel as the text of an SVG element.

    Parameters
    ----------
    figure : Figure
    inks : mapping of str to LineStyle
        By the kind of a series: gives the width of its line.
    colours : mapping of str to str
        By the kind of a series, the CSS variable that holds its colour.
    """
    legend = {entry.label: entry for entry in entries(figure)}
    pens = {kind: _Pen(colour=colours[kind], width=ink.width) for kind, ink in inks.items()}
    return [_still(panel, legend, pens) for panel in simplify(figure, STILL).panels]


@dataclass(frozen=True, slots=True, kw_only=True)
class _Pen:
    """The colour of a kind of series, as a CSS variable, and the width of its lines."""

    colour: str
    width: float


@dataclass(frozen=True, slots=True, kw_only=True)
class _Axis:
    """One axis: numbers from `low` to `high`, or their logarithms, over `length` units."""

    low: float
    high: float
    log: bool
    length: float

    def place(self, values: Floats) -> Floats:
        """Return where numbers are, in units from the lower end, shape (n,); NaN is nowhere."""
        scaled = np.log10(np.where(values > 0.0, values, np.nan)) if self.log else limited(values)
        with np.errstate(over="ignore"):  # of what is far beyond an axis that is given
            places: Floats = self.length * ((scaled - self.low) / (self.high - self.low))
        return np.clip(places, -_FAR, _FAR)


def _still(panel: Panel, legend: Mapping[str, Entry], pens: Mapping[str, _Pen]) -> str:
    data = [plottable(series, panel) for series in panel.series]
    x_ends = _ends(panel, 0, data)
    y_ends = _ends(panel, 1, data)
    words = f"{panel.title}: {panel.y_label} against {panel.x_label}"
    outer = _SQUARE if panel.equal else _HEIGHT
    if x_ends is None or y_ends is None:
        return _svg(words, outer, [_text(_WIDTH / 2, outer / 2, "nothing to draw", "middle")])
    y_ticks = _named(panel.y_names) or _ticks(*y_ends, log=panel.log_y)
    bar_ticks = () if panel.heat is None else _ticks(*span(panel.heat), log=False)
    left = 1.5 * _LINE + _LETTER * _longest(text for _, text in y_ticks)
    right = _RIGHT + (2.8 * _LINE + _LETTER * _longest(t for _, t in bar_ticks) if bar_ticks else 0)
    longest = _LETTER * _longest(panel.x_names)
    left = max(left, longest * math.cos(_SLANT) - 20.0) if panel.x_names else left
    bottom = 2.4 * _LINE + longest * math.sin(_SLANT)
    width = max(_WIDTH - left - right, 0.3 * _WIDTH)
    height = outer - _TOP - _LINE / 2 - bottom if not panel.x_names else 0.6 * outer
    if panel.equal:
        x_ends, y_ends = _alike(x_ends, y_ends, width / height)
        y_ticks = _ticks(*y_ends, log=panel.log_y)
    x = _Axis(low=x_ends[0], high=x_ends[1], log=panel.log_x, length=width)
    y = _Axis(low=y_ends[0], high=y_ends[1], log=panel.log_y, length=height)
    named = _named(panel.x_names)
    x_ticks = named or _apart(_ticks(*x_ends, log=panel.log_x), x)
    x_places = [(x.place(np.array(at)).item(), text) for at, text in x_ticks]
    y_places = [(height - y.place(np.array(at)).item(), text) for at, text in y_ticks]
    lines = "".join(f"M0 {_n(at)}H{_n(width)}" for at, _ in y_places)
    lines += "" if named else "".join(f"M{_n(at)} 0V{_n(height)}" for at, _ in x_places)
    inside = [] if panel.heat is None else [_cells(panel.heat, x, y)]
    inside += [f'<path class="grid" d="{lines}"/>'] if panel.heat is None else []
    order = sorted(range(len(data)), key=lambda n: panel.series[n].kind != "reference")
    for n in order:  # the truth lies below
        series = panel.series[n]
        inside += _drawn(series, data[n], (x, y), legend[series.label], pens[series.kind])
    parts = [
        f'<g transform="translate({_n(left)} {_n(_TOP)})">',
        f'<svg width="{_n(width)}" height="{_n(height)}">{"".join(inside)}</svg>',
        f'<path class="frame" d="M0 0V{_n(height)}H{_n(width)}"/>',
        *(_text(-5, at + 4, text, "end") for at, text in y_places),
        *(
            _text(at + 4, height + 14, text, "end", turn=-30)
            if named
            else _text(at, height + 15, text, "middle")
            for at, text in x_places
        ),
        _text(width / 2, height + bottom - 6, panel.x_label, "middle", own="label"),
        _text(12 - left, height / 2, panel.y_label, "middle", own="label", turn=-90),
        *(() if panel.heat is None else _colour_bar(panel.heat, bar_ticks, width, height)),
        "</g>",
    ]
    return _svg(words, _TOP + height + bottom, parts)


def _named(names: Sequence[str]) -> list[tuple[float, str]]:
    """Return the ticks of an axis that has names in place of numbers."""
    return [(float(place), name) for place, name in enumerate(names)]


def _svg(words: str, height: float, parts: Sequence[str]) -> str:
    return (
        f'<svg class="still" role="img" aria-label="{escape(words)}" '
        f'viewBox="0 0 {_n(_WIDTH)} {_n(height)}">{"".join(parts)}</svg>'
    )


def _n(number: float) -> str:
    """Return a coordinate with a tenth of a unit."""
    return f"{number:.1f}".removesuffix(".0")


def _longest(texts: Iterable[str]) -> int:
    return max(map(len, texts), default=0)


def _text(x: float, y: float, text: str, anchor: str, *, own: str = "", turn: int = 0) -> str:
    """Return a text; one that is turned turns about its anchor."""
    place = f'x="{_n(x)}" y="{_n(y)}"'
    if turn:
        place = f'transform="translate({_n(x)} {_n(y)}) rotate({turn})"'
    name = f' class="{own}"' if own else ""
    return f'<text{name} {place} text-anchor="{anchor}">{escape(text)}</text>'


def _ends(
    panel: Panel, axis: int, data: Sequence[tuple[Floats, Floats]]
) -> tuple[float, float] | None:
    """Return the ends of an axis, logarithms on a logarithmic one; None with nothing to draw."""
    log = (panel.log_x, panel.log_y)[axis]
    numbers = _numbers(panel, axis, data)
    numbers = np.log10(numbers[numbers > 0.0]) if log else numbers
    if not numbers.size:
        return None
    if axis == 0 and panel.x_names:
        return -BAR_WIDTH, len(panel.x_names) - 1 + BAR_WIDTH
    if (given := (panel.x_range, panel.y_range)[axis]) is not None:
        low, high = map(math.log10, given) if log else given
    else:
        low, high = float(numbers.min()), float(numbers.max())
        room = 0.0 if panel.heat is not None else _ROOM * (high - low)
        low, high = low - room, high + room
    return _decades(low, high) if log else widened(low, high)


def _decades(low: float, high: float) -> tuple[float, float]:
    """Return the ends of a logarithmic axis, whose numbers are doubles that ticks tell apart."""
    low, high = (min(max(end, _DECADES[0]), _DECADES[1]) for end in (low, high))
    return (low, high) if high - low > _ALIKE else (low - 0.5, high + 0.5)


def _numbers(panel: Panel, axis: int, data: Sequence[tuple[Floats, Floats]]) -> Floats:
    """Return the numbers that an axis has to hold, shape (n,)."""
    drawn = [np.isfinite(x) & np.isfinite(y) for x, y in data]
    if panel.heat is not None:
        there = np.isfinite(panel.heat.z).any() or any(map(np.any, drawn))
        numbers = [(panel.heat.x, panel.heat.y)[axis]] if there else []
    else:
        numbers = [pair[axis][there] for pair, there in zip(data, drawn, strict=True)]
    if axis == 1 and panel.heat is None:  # bars reach from their base
        numbers += [
            bar_base(series)[there]
            for series, there in zip(panel.series, drawn, strict=True)
            if series.mark == "bars"
        ]
    together = limited(np.concatenate([*numbers, np.empty(0)]))
    return together[np.isfinite(together)]


Ends = tuple[float, float]


def _alike(x: Ends, y: Ends, shape: float) -> tuple[Ends, Ends]:
    """Return ends that give both axes the same scale, in an area of a given width over height."""
    wide, high = x[1] - x[0], y[1] - y[0]
    more_x, more_y = max(high * shape - wide, 0.0) / 2.0, max(wide / shape - high, 0.0) / 2.0
    return (x[0] - more_x, x[1] + more_x), (y[0] - more_y, y[1] + more_y)


Ticks = Sequence[tuple[float, str]]


def _ticks(low: float, high: float, *, log: bool) -> Ticks:
    """Return numbers to be marked between two ends, and their texts."""
    if log:
        first = max(math.ceil(low - 1e-9), _DECADES[0])
        last = min(math.floor(high + 1e-9), _DECADES[1])
        stride = max(1, math.ceil((last - first + 1) / _TICKS))
        if last - first >= 1:
            plain = 10.0**first >= _PLAIN_FROM and 10.0**last < _PLAIN_BELOW
            shown = range(first, last + 1, stride)
            return [(10.0**n, readable(10.0**n) if plain else _power_of_ten(n)) for n in shown]
        digits = [m * 10.0**n for n in range(first - 1, last + 2) for m in (1, 2, 5)]
        within = [value for value in digits if low <= math.log10(value) <= high]
        if len(within) > 1:
            return [(value, readable(value)) for value in within]
        low, high = 10.0**low, 10.0**high
    power = 10.0 ** math.floor(math.log10((high - low) / _TICKS))
    step = next((m * power for m in (1, 2, 5) if m * power * _TICKS >= high - low), 10 * power)
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    values = [n * step for n in range(first, last + 1)]
    return list(zip(values, _written(values, step), strict=True))


def _written(values: Sequence[float], step: float) -> list[str]:
    """Return ticks a step apart, with as many digits as tell them from each other."""
    largest = max(map(abs, values), default=0.0)
    power = math.floor(math.log10(largest)) if largest > 0.0 else 0
    power = 0 if _PLAIN_FROM <= largest < _PLAIN_BELOW else power
    decimals = max(0, power - math.floor(math.log10(step) + 1e-9))
    texts = (f"{value / 10.0**power:.{decimals}f}" for value in values)
    times = f"\N{MULTIPLICATION SIGN}{_power_of_ten(power)}" if power else ""
    return [
        "0" if float(text) == 0.0 else f"{text}{times}".replace("-", "\N{MINUS SIGN}")
        for text in texts
    ]


def _power_of_ten(exponent: int) -> str:
    return f"10{str(exponent).translate(SUPERSCRIPT)}"


def _apart(ticks: Ticks, axis: _Axis) -> Ticks:
    """Return every n-th of the ticks, so that their texts do not touch."""
    needed = _LETTER * (_longest(text for _, text in ticks) + 1) * len(ticks)
    return ticks[:: max(1, math.ceil(needed / axis.length))]


def _drawn(
    series: Series, data: tuple[Floats, Floats], axes: tuple[_Axis, _Axis], entry: Entry, pen: _Pen
) -> list[str]:
    """Return a series as paths."""
    x, y = axes[0].place(data[0]), axes[1].length - axes[1].place(data[1])
    look = f'style="color:var({pen.colour})"'
    if entry.opacity < 1.0:
        look += f' opacity="{entry.opacity:g}"'
    there = np.isfinite(x) & np.isfinite(y)
    if series.mark == "bars":
        base = bar_base(series)
        there &= np.isfinite(base)
        # nothing is below a logarithmic axis: a bar from zero stands on its lower end
        foot = axes[1].length - np.fmax(axes[1].place(base), 0.0 if axes[1].log else -_FAR)
        half = min(axes[0].length * BAR_WIDTH / (axes[0].high - axes[0].low), _FAR) / 2.0
        bars = zip(x[there] - half, y[there], (foot - y)[there], strict=True)
        path = "".join(
            f"M{_n(a)} {_n(b)}h{_n(2 * half)}v{_n(c)}h{_n(-2 * half)}z" for a, b, c in bars
        )
        return [f'<path class="dot" {look} d="{path}"/>']
    paths = []
    if series.mark != "points":
        runs = np.split(np.arange(len(x)), np.flatnonzero(np.diff(there)) + 1)
        path = "".join(_polyline(x[run], y[run]) for run in runs if run.size and there[run[0]])
        dashes = f' stroke-dasharray="{" ".join(map(str, entry.dashes))}"' if entry.dashes else ""
        paths.append(f'<path {look} stroke-width="{pen.width:g}"{dashes} d="{path}"/>')
    if series.mark != "line":
        mark = MARKS[entry.rank % len(MARKS)]
        path = "".join(f"M{_n(a)} {_n(b)}{mark}" for a, b in zip(x[there], y[there], strict=True))
        paths.append(f'<path class="dot" {look} d="{path}"/>')
    return paths


def _polyline(x: Floats, y: Floats) -> str:
    """Return a line through points, each given by its distance from the one before, in tenths."""
    tenths = np.rint(10.0 * np.column_stack((x, y))).astype(np.int64)
    moves = np.diff(tenths, axis=0, prepend=np.zeros((1, 2), dtype=np.int64))
    texts = [_tenths(n) for n in moves.ravel().tolist()]
    pairs = [
        a + b if b[0] == "-" else f"{a} {b}" for a, b in zip(texts[::2], texts[1::2], strict=True)
    ]
    return f"M{pairs[0]}l" + " ".join(pairs[1:]) if len(pairs) > 1 else ""


def _tenths(number: int) -> str:
    """Return a tenth of a whole number."""
    whole, tenth = divmod(abs(number), 10)
    sign = "-" if number < 0 else ""
    return f"{sign}{whole or ''}.{tenth}" if tenth else f"{sign}{whole}"


def _cells(heat: Heatmap, x: _Axis, y: _Axis) -> str:
    """Return the cells as an image, a pixel for each unit of the panel."""
    columns, rows = int(2 * x.length), int(2 * y.length)
    at_x = (np.arange(columns) + 0.5) / columns * x.length
    at_y = (np.arange(rows) + 0.5) / rows * y.length
    column = np.clip(np.searchsorted(x.place(heat.x), at_x) - 1, 0, heat.z.shape[1] - 1)
    row = np.clip(np.searchsorted(y.place(heat.y), at_y) - 1, 0, heat.z.shape[0] - 1)
    return _image(heat, heat.z[np.ix_(row[::-1], column)], x.length, y.length)


def _colour_bar(heat: Heatmap, ticks: Ticks, width: float, height: float) -> Iterator[str]:
    """Yield the scale of the colours, to the right of a panel."""
    low, high = span(heat)
    shades = np.linspace(high, low, int(height))[:, None]
    yield f'<g transform="translate({_n(width + 8)} 0)">{_image(heat, shades, 10.0, height)}</g>'
    for value, text in ticks:
        yield _text(width + 22, height * (high - value) / (high - low) + 4, text, "start")
    edge = width + 22 + _LETTER * _longest(text for _, text in ticks) + 17
    yield _text(edge, height / 2, heat.label, "middle", own="label", turn=-90)


def _image(heat: Heatmap, z: Floats, width: float, height: float) -> str:
    """Return numbers as an image of their colours, blank where there is none."""
    low, high = span(heat)
    scale: Scale = SIGNED[1] if heat.signed else PLAIN_COLOURS
    stops = np.array([stop for stop, _ in scale])
    inks = np.array([tuple(bytes.fromhex(colour[1:])) for _, colour in scale])
    share = np.nan_to_num((np.clip(z, low, high) - low) / (high - low))
    pixels = [np.interp(share, stops, inks[:, n]) for n in range(3)] + [255.0 * np.isfinite(z)]
    picture = base64.b64encode(_png(np.rint(np.stack(pixels, axis=-1)).astype(np.uint8)))
    return (
        f'<image width="{_n(width)}" height="{_n(height)}" preserveAspectRatio="none" '
        f'href="data:image/png;base64,{picture.decode("ascii")}"/>'
    )


def _png(pixels: "np.ndarray[tuple[int, int, int], np.dtype[np.uint8]]") -> bytes:
    """Return pixels of shape (rows, columns, 4) as a PNG (ISO/IEC 15948): RGBA, no filter."""
    rows, columns, _ = pixels.shape
    lines = b"".join(b"\0" + row.tobytes() for row in pixels)
    header = struct.pack(">IIBBBBB", columns, rows, 8, 6, 0, 0, 0)
    chunks = ((b"IHDR", header), (b"IDAT", zlib.compress(lines)), (b"IEND", b""))
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
        for name, data in chunks
    )
