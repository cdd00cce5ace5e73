"""Figures for paper and for notebooks. Nothing else here knows matplotlib.

The same figure gives the same bytes: no date, no version, fixed names inside the SVG, and the only
fonts used are those that come with matplotlib.
"""

import io
import math
import re
import warnings
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any
from urllib.parse import quote

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure as Sheet
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from harness.core.report_model import Figure, Heatmap, Panel, Series
from harness.report.simplify_curves import bar_base, plottable
from harness.report.style import BAR_WIDTH, PLAIN, SIGNED, Entry, LineStyle, entries, limited, span

PIXELS = 1200  # of the PNG's width
_INCHES = 8.0
_ROW, _SQUARE_ROW = 0.62, 0.92  # height of a row in panel widths
_LETTERS, _KEY = 130, 6  # in the width of the page; what a key and its margins take of them
_MARKS = ("o", "D", "s", "^", "P", "X", "*")
_DRAWN = re.compile(r'(?<=\sd=")[^"]*(?=")')
_UNSPEAKABLE = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\ufffe\uffff]")  # XML has no word for them
_LONG = re.compile(r"-?\d+\.\d{3,}")
_STYLE: dict[Any, Any] = {
    "font.family": "sans-serif",
    # the first comes with matplotlib and measures every text; the others stand in for it in an SVG
    # opened where it is not installed
    "font.sans-serif": ["DejaVu Sans", "Verdana", "Helvetica", "Arial", "sans-serif"],
    "font.size": 9.0,
    "axes.titlesize": 9.5,
    "axes.titlelocation": "left",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.edgecolor": "#6b7078",
    "axes.labelcolor": "#30343a",
    "axes.grid": True,
    "grid.color": "#e6e4de",
    "grid.linewidth": 0.7,
    "xtick.color": "#50555c",
    "ytick.color": "#50555c",
    "svg.fonttype": "none",
    "svg.hashsalt": "rockingcan",
    "path.simplify": True,
}


@dataclass(frozen=True, slots=True, kw_only=True)
class RenderedFigure:
    """A figure as files."""

    png: bytes
    svg: str


def render(figure: Figure, inks: Mapping[str, LineStyle]) -> RenderedFigure:
    """Return a figure drawn on white.

    Parameters
    ----------
    figure : Figure
    inks : mapping of str to LineStyle
        For each kind of series in it.
    """
    with mpl.rc_context(), warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Glyph")  # a script DejaVu lacks becomes boxes
        mpl.rcdefaults()  # not what a matplotlibrc on this machine says
        mpl.rcParams.update(_STYLE)
        sheet = _sheet(figure, inks)
        # by the canvases and not by `savefig`, which draws everything twice
        vectors, pixels = io.BytesIO(), io.BytesIO()
        FigureCanvasAgg(sheet).print_png(pixels, metadata={"Software": None})  # type: ignore[no-untyped-call]
        # last, since it leaves the sheet at 72 dots per inch
        FigureCanvasSVG(sheet).print_svg(vectors, metadata={"Date": None, "Creator": None})  # type: ignore[no-untyped-call]
        text = vectors.getvalue().decode("utf-8")
        svg = _DRAWN.sub(_rounded, _UNSPEAKABLE.sub("\N{REPLACEMENT CHARACTER}", text))
        return RenderedFigure(png=pixels.getvalue(), svg=svg)


def _sheet(figure: Figure, inks: Mapping[str, LineStyle]) -> Sheet:
    columns = max(1, min(figure.columns, len(figure.panels)))
    lines = max(1, math.ceil(len(figure.panels) / columns))
    shape = _SQUARE_ROW if any(panel.equal for panel in figure.panels) else _ROW
    height = lines * min(shape * _INCHES / columns, 4.4) + 0.45
    sheet = Sheet(figsize=(_INCHES, height), dpi=PIXELS / _INCHES, layout="constrained")
    legend = {entry.label: entry for entry in entries(figure)}
    for number, panel in enumerate(figure.panels):
        axes = sheet.add_subplot(lines, columns, number + 1)
        for series in panel.series:
            _draw(axes, series, panel, legend[series.label], inks[series.kind])
        _label(axes, panel)
        if panel.heat is not None:
            _colour(sheet, axes, panel.heat)
    keys = [_key(entry, inks[entry.kind]) for entry in legend.values()]
    if keys:
        box = sheet.legend(
            handles=keys, loc="outside upper left", ncols=_columns(keys), frameon=False
        )
        for text in box.get_texts():
            text.set_parse_math(False)
    # laid out once, not again for each form
    FigureCanvasAgg(sheet)
    layout = sheet.get_layout_engine()
    if layout is not None:
        layout.execute(sheet)
    sheet.set_layout_engine("none")
    return sheet


def _columns(keys: Sequence[Line2D | Patch]) -> int:
    """Return how many legend entries fit into a row."""
    longest = max(len(str(key.get_label())) for key in keys)
    return max(1, min(4, len(keys), _LETTERS // (longest + _KEY)))


def _rounded(match: re.Match[str]) -> str:
    """Return path data with two decimals: a hundredth of a point, a quarter of the size."""
    return _LONG.sub(lambda number: f"{float(number[0]):.2f}", match[0])


def _look(entry: Entry, ink: LineStyle) -> dict[str, object]:
    points = 0.75 * ink.width  # CSS pixels to points; dashes count in line widths
    return {
        "color": ink.light,
        "linewidth": points,
        "linestyle": (0, tuple(n / ink.width for n in entry.dashes)) if entry.dashes else "-",
        "marker": _MARKS[entry.rank % len(_MARKS)],
        "markersize": 4.5,
        "alpha": entry.opacity,
    }


def _draw(axes: Axes, series: Series, panel: Panel, entry: Entry, ink: LineStyle) -> None:
    x, y = plottable(series, panel)
    if series.mark == "bars":
        base = bar_base(series)
        axes.use_sticky_edges = False  # bars, too, keep their distance from the frame
        look = {"color": ink.light, "alpha": entry.opacity, "linewidth": 1.0}  # seen at no height
        axes.bar(x, y - base, bottom=base, width=BAR_WIDTH, zorder=2.0, **look)  # type: ignore[arg-type]
        return
    look = _look(entry, ink)
    if series.mark == "line":
        look["marker"] = ""
    if series.mark == "points":
        look["linestyle"] = ""
    below = 2.0 if series.kind == "reference" else 2.1  # the truth lies below
    axes.add_line(Line2D(x, y, zorder=below, **look))  # type: ignore[arg-type]


def _colour(sheet: Sheet, axes: Axes, heat: Heatmap) -> None:
    """Draw cells below the curves, and a colour bar next to the axes."""
    low, high = span(heat)
    x, y = limited(heat.x), limited(heat.y)
    cells = axes.pcolormesh(
        x,
        y,
        np.ma.masked_invalid(heat.z),
        cmap=SIGNED[0] if heat.signed else PLAIN[0],
        vmin=low,
        vmax=high,
        rasterized=True,  # in an SVG one picture, not a path for each cell
        zorder=0.5,
    )
    axes.grid(visible=False)
    axes.set_xlim(x[0], x[-1])
    axes.set_ylim(y[0], y[-1])
    there = heat.z[np.isfinite(heat.z)]
    beyond = (bool((there < low).any()), bool((there > high).any()))
    ends = {(False, False): "neither", (True, False): "min", (False, True): "max"}
    bar = sheet.colorbar(cells, ax=axes, extend=ends.get(beyond, "both"))
    bar.set_label(heat.label, parse_math=False)
    bar.outline.set_visible(False)


def _label(axes: Axes, panel: Panel) -> None:
    """Write the labels, and scale the axes to the data."""
    if panel.log_x:
        axes.set_xscale("log")
    if panel.log_y:
        axes.set_yscale("log")
    axes.set_title(panel.title, parse_math=False)
    axes.set_xlabel(panel.x_label, parse_math=False)
    axes.set_ylabel(panel.y_label, parse_math=False)
    if panel.equal:
        axes.set_aspect("equal", adjustable="datalim")
    axes.relim()
    axes.autoscale_view()
    if panel.x_range is not None:
        axes.set_xlim(panel.x_range)
    if panel.y_range is not None:
        axes.set_ylim(panel.y_range)
    if panel.x_names:
        axes.set_xticks(range(len(panel.x_names)))
        axes.set_xticklabels(
            panel.x_names, rotation=30, ha="right", rotation_mode="anchor", parse_math=False
        )
        axes.set_xlim(-BAR_WIDTH, len(panel.x_names) - 1 + BAR_WIDTH)
        axes.grid(visible=False, axis="x")
    if panel.y_names:
        axes.set_yticks(range(len(panel.y_names)), panel.y_names, parse_math=False)
    drawn = panel.heat is not None and np.isfinite(panel.heat.z).any()
    if not drawn and not any(np.isfinite(plottable(s, panel)[1]).any() for s in panel.series):
        axes.text(0.5, 0.5, "nothing to draw", ha="center", va="center", transform=axes.transAxes)


def _key(entry: Entry, ink: LineStyle) -> Line2D | Patch:
    # matplotlib leaves out a label that starts with an underscore
    label = f"\N{ZERO WIDTH SPACE}{entry.label}" if entry.label.startswith("_") else entry.label
    if entry.bars:
        return Patch(label=label, color=ink.light, alpha=entry.opacity)
    look = _look(entry, ink)
    if not entry.points:
        look["marker"] = ""
    if not entry.line:
        look["linestyle"] = ""
    return Line2D([], [], label=label, **look)  # type: ignore[arg-type]


_HEADER = re.compile(r"<\?xml.*?\?>|<!DOCTYPE.*?>|<metadata>.*?</metadata>|<!--.*?-->", re.DOTALL)
_TAG = re.compile("<[^<>]*>")
_BETWEEN = re.compile(r">\s*\n\s*<")
_PATH = re.compile(r'(?<= d=")[^"]*')
_LETTER = re.compile(r"\s*([A-Za-z])\s*")
_STYLES = re.compile(r'(?<= style=")[^"]*')
_STYLE_SIGN = re.compile(r"([:;])\s+")
_NAME = re.compile(r' id="([^"]*)"')
_LINK = re.compile(r'((?:href="|url\()#)([\w-]+)')
_WHOLE_STYLES = re.compile(r' style="([^"<>&]*)"')

_PLAIN = " !$()*+,-./:;=?@[]_|~"
"""Signs that need no escape, neither in an address nor in an attribute of HTML."""


def address(svg: str) -> str:
    """Return an SVG picture as the address of an image that holds all of it.

    Percent signs take the place of base64, which makes a text a third longer. Of the picture itself
    nothing is lost: line ends, names that nothing refers to, and what is said several times of how
    things look are not seen.
    """
    return f"data:image/svg+xml,{quote(_short(svg), safe=_PLAIN)}"


def _short(svg: str) -> str:
    """Return the same picture in fewer letters."""
    text = _BETWEEN.sub("><", _HEADER.sub("", svg).strip())
    text = _in_tags(_PATH, lambda match: _LETTER.sub(r"\1", match[0]).strip(), text)
    text = _in_tags(_STYLES, lambda match: _STYLE_SIGN.sub(r"\1", match[0]), text)
    named = {name for _, name in _LINK.findall(text)}
    text = _in_tags(_NAME, lambda match: match[0] if match[1] in named else "", text)
    return _classed(text)


def _in_tags(pattern: re.Pattern[str], change: Callable[[re.Match[str]], str], text: str) -> str:
    """Return a text with its tags changed: the words of a figure may look like attributes."""
    return _TAG.sub(lambda tag: pattern.sub(change, tag[0]), text)


def _classed(text: str) -> str:
    """Return a picture whose repeated styles are classes."""
    styles = Counter(_WHOLE_STYLES.findall("".join(_TAG.findall(text))))
    classes = {style: f"c{n}" for n, style in enumerate(s for s, k in styles.items() if k > 1)}
    rules = "".join(f".{name}{{{style}}}" for style, name in classes.items())
    text = _in_tags(
        _WHOLE_STYLES,
        lambda match: f' class="{classes[match[1]]}"' if match[1] in classes else match[0],
        text,
    )
    return text.replace("</style>", f"{rules}</style>", 1)
