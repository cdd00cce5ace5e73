"""Figures that answer to the hand: zoom, hover and a legend that switches curves on and off.

A panel becomes a description that plotly.js draws in the page: one graph a panel, so that a narrow
screen can put the panels below each other. Colours are not in it: the page gives them by the kind
of each curve, for its light or its dark face. A notebook gets the same curves as one figure of
plotly, in the colours of the light face. Nothing else here knows plotly.
"""

import base64
import gzip
import html
import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from plotly.offline import get_plotlyjs

from harness.core.report_model import Figure, Heatmap, Panel, Series
from harness.core.trajectory import Floats
from harness.report.simplify_curves import bar_base, plottable
from harness.report.style import (
    BAR_WIDTH,
    PAPER_LIGHT,
    PLAIN,
    SIGNED,
    Entry,
    LineStyle,
    entries,
    limited,
    palette,
    span,
)

if TYPE_CHECKING:
    from plotly.graph_objects import Figure as PlotlyFigure

SYMBOLS = ("circle", "diamond", "square", "triangle-up", "cross", "x", "star")

# a single has 24 bits: while the largest number is at most 16 times the panel's width, rounding to
# it moves a point by at most 1e-6 of the panel, a thousandth of a pixel
_SINGLE_REACH = 16.0
_LEVEL = 6  # of gzip: the highest takes twice as long for a hundredth less
_SAME_RANGE = 0.01  # of the range: axes of one quantity that differ by less are zoomed together


def plotly_packed() -> str:
    """Return plotly.js, packed, to be put once in a page: a third of its plain size."""
    return packed(get_plotlyjs())


def packed(text: str) -> str:
    """Return a text as gzip in base64, which needs no escape in a page."""
    return base64.b64encode(gzip.compress(text.encode("utf-8"), _LEVEL, mtime=0)).decode("ascii")


def description(figure: Figure, inks: Mapping[str, LineStyle]) -> list[dict[str, Any]]:
    """Return a description of each panel: `data` and `layout` for plotly.js, `linked` for the page.

    Parameters
    ----------
    figure : Figure
        Thinned already.
    inks : mapping of str to LineStyle
        Gives the widths; the page gives the colours.

    Returns
    -------
    list of dict
        `linked` is the same number in panels that share their horizontal axis. A trace's `meta`
        holds its kind and the number of its legend entry. Texts are escaped for plotly's own HTML.
    """
    linked = _linked(figure.panels)
    return [
        {
            "data": [
                {key: _packed(v) if isinstance(v, np.ndarray) else v for key, v in trace.items()}
                for trace in traces
            ],
            "layout": _layout(panel),
            "linked": group,
        }
        for panel, traces, group in zip(figure.panels, _traces(figure, inks), linked, strict=True)
    ]


def plotly_figure(figure: Figure) -> "PlotlyFigure":
    """Return a figure of plotly with all panels and a legend."""
    from plotly.subplots import make_subplots  # noqa: PLC0415 - the page needs no figure objects

    inks = palette(series.kind for panel in figure.panels for series in panel.series)
    columns = max(1, min(figure.columns, len(figure.panels)))
    rows = max(1, math.ceil(len(figure.panels) / columns))
    titles = [_text(panel.title) for panel in figure.panels]
    drawn = make_subplots(rows=rows, cols=columns, subplot_titles=titles)
    listed: set[str] = set()
    for number, (panel, traces) in enumerate(
        zip(figure.panels, _traces(figure, inks), strict=True)
    ):
        place = {"row": number // columns + 1, "col": number % columns + 1}
        for trace in traces:
            kind = trace.pop("meta", {}).get("kind")
            if kind is not None:  # cells have a colour bar instead
                colour = {"color": inks[kind].light}
                trace |= {"marker": {**trace.get("marker", {}), **colour}}
                if "line" in trace:
                    trace["line"] = {**trace["line"], **colour}
                trace["showlegend"] = trace["name"] not in listed
                listed.add(trace["name"])
            drawn.add_trace(trace, **place)
        layout = _layout(panel)
        y_axis = layout["yaxis"]
        if "scaleanchor" in y_axis:
            y_axis["scaleanchor"] = f"x{number + 1}" if number else "x"
        drawn.update_xaxes(layout["xaxis"], **place)
        drawn.update_yaxes({**y_axis, "automargin": True}, **place)
    return drawn.update_layout(
        title={"text": _text(figure.title)},
        template="plotly_white",
        paper_bgcolor=PAPER_LIGHT,
        plot_bgcolor=PAPER_LIGHT,
        barmode="overlay",
        height=_HEAD + rows * _ROW,
        legend={"orientation": "h", "yanchor": "top", "y": -0.2 / rows},
    )


_HEAD, _ROW = 150, 300  # pixels: of title and legend, and of a row of panels


def _traces(figure: Figure, inks: Mapping[str, LineStyle]) -> list[list[dict[str, Any]]]:
    """Return the traces of each panel, without colours; numbers are arrays."""
    legend = {entry.label: (number, entry) for number, entry in enumerate(entries(figure))}
    return [
        [
            *(() if panel.heat is None else (_cells(panel.heat),)),
            *(
                _trace(series, panel, *legend[series.label], inks[series.kind])
                # the truth lies below
                for series in sorted(panel.series, key=lambda series: series.kind != "reference")
            ),
        ]
        for panel in figure.panels
    ]


def _trace(
    series: Series, panel: Panel, number: int, entry: Entry, ink: LineStyle
) -> dict[str, Any]:
    x, y = plottable(series, panel)
    label = _text(series.label)
    trace: dict[str, Any] = {
        "name": label,
        "legendgroup": label,
        "showlegend": False,  # the legend is the page's: buttons that a keyboard reaches
        "meta": {"kind": series.kind, "entry": number},
        "opacity": entry.opacity,
        "x": x,
    }
    if series.mark == "bars":
        base = bar_base(series)
        trace |= {
            "type": "bar",
            "width": BAR_WIDTH,
            "y": y - base,
            "base": base,
            "customdata": y,
        }
        numbers, texts = "%{customdata:.6g}", "hovertext"
    else:
        trace |= {
            "type": "scatter",
            "mode": {"line": "lines", "points": "markers", "both": "lines+markers"}[series.mark],
            "line": {
                "width": ink.width,
                "dash": ",".join(f"{length}px" for length in entry.dashes) or "solid",
            },
            "marker": {"size": 8, "symbol": SYMBOLS[entry.rank % len(SYMBOLS)]},
            "y": y,
        }
        numbers, texts = "%{x:.6g}, %{y:.6g}", "text"
    if series.hover:
        trace[texts] = [_text(text) for text in series.hover]
        numbers = f"%{{{texts}}}<br>{numbers}"
    return trace | {"hovertemplate": f"{numbers}<extra>{label}</extra>"}


def _cells(heat: Heatmap) -> dict[str, Any]:
    low, high = span(heat)
    return {
        "type": "heatmap",
        "x": heat.x,
        "y": heat.y,
        "z": heat.z,
        "zmin": low,
        "zmax": high,
        "colorscale": SIGNED[1] if heat.signed else PLAIN[1],
        "colorbar": {"title": {"text": _text(heat.label), "side": "right"}, "thickness": 12},
        "hovertemplate": "%{x:.6g}, %{y:.6g}: %{z:.6g}<extra></extra>",
    }


def _layout(panel: Panel) -> dict[str, Any]:
    x_axis = _axis(panel, "x", panel.x_label, panel.x_range, log=panel.log_x)
    y_axis = _axis(panel, "y", panel.y_label, panel.y_range, log=panel.log_y)
    y_axis["automargin"] = False  # one margin for all panels: axes below each other stay aligned
    if panel.x_names:
        x_axis |= {
            "tickvals": list(range(len(panel.x_names))),
            "ticktext": [_text(name) for name in panel.x_names],
            "tickangle": -30,
            "range": [-BAR_WIDTH, len(panel.x_names) - 1 + BAR_WIDTH],
        }
    if panel.y_names:
        y_axis |= {
            "tickvals": list(range(len(panel.y_names))),
            "ticktext": [_text(name) for name in panel.y_names],
            "automargin": True,
        }
    if panel.equal:
        x_axis["constrain"] = y_axis["constrain"] = "domain"
        y_axis |= {"scaleanchor": "x", "scaleratio": 1}
    return {
        "xaxis": x_axis,
        "yaxis": y_axis,
        "margin": {"l": 68, "r": 14, "t": 10, "b": 48},
        "hovermode": "closest",
        "showlegend": False,
        "dragmode": "zoom",
        "barmode": "overlay",  # side by side they would leave their places
    }


_MANY_DECADES = 8.0  # more powers of ten than that crowd the axis; plotly then leaves some out


def _axis(
    panel: Panel, name: str, label: str, ends: tuple[float, float] | None, *, log: bool
) -> dict[str, Any]:
    axis: dict[str, Any] = {
        "title": {"text": _text(label), "standoff": 8 if name == "x" else 6},
        "type": "log" if log else "linear",
        "exponentformat": "power",
        "automargin": True,
        "zeroline": False,
    }
    if log:
        axis["minor"] = {"ticks": "inside", "ticklen": 3, "dtick": "D1"}
        data = _together(panel, name) if ends is None else np.array(ends)
        positive = data[data > 0.0]
        if not positive.size or positive.max() / 10.0**_MANY_DECADES <= positive.min():
            axis["dtick"] = 1  # powers of ten
    if ends is not None:
        axis["range"] = [math.log10(end) if log else end for end in ends]
    return axis


def _together(panel: Panel, axis: str) -> Floats:
    """Return the finite numbers on one axis, of all series together."""
    data = [plottable(series, panel)[0 if axis == "x" else 1] for series in panel.series]
    numbers: Floats = np.concatenate([*data, np.empty(0)])
    finite: Floats = numbers[np.isfinite(numbers)]
    return finite


def _linked(panels: tuple[Panel, ...]) -> list[int]:
    """Return a number for each panel; equal ones show one quantity over the same range."""
    seen: list[tuple[str, bool, float, float]] = []
    groups = []
    for panel in panels:
        data = _together(panel, "x")
        low, high = (float(data.min()), float(data.max())) if data.size else (0.0, 0.0)
        room = _SAME_RANGE * (high - low)
        for group, (label, log, other_low, other_high) in enumerate(seen):
            same = (label, log) == (panel.x_label, panel.log_x)
            near = abs(low - other_low) <= room and abs(high - other_high) <= room
            if same and near and not panel.equal:
                groups.append(group)
                break
        else:
            groups.append(len(seen))
        seen.append((panel.x_label, panel.log_x, low, high))
    return groups


def _packed(values: Floats) -> dict[str, str]:
    """Return an array as plotly.js reads it, in half the space where that loses nothing visible."""
    finite = limited(values[np.isfinite(values)])
    width = float(np.ptp(finite)) if finite.size else 0.0
    largest = float(np.abs(finite).max()) if finite.size else 0.0
    single = largest <= _SINGLE_REACH * width and 1e-30 < width < 1e30  # noqa: PLR2004 # its exponents
    kind = "f4" if single else "f8"
    shape = {"shape": ",".join(map(str, values.shape))} if values.ndim > 1 else {}
    return {**packed_array(values.ravel(), kind), **shape}


def packed_array(values: Floats, kind: str) -> dict[str, str]:
    """Return an array of a type such as "f4" as plotly.js and our own scripts read it."""
    data = base64.b64encode(np.asarray(values).astype(f"<{kind}").tobytes()).decode("ascii")
    return {"dtype": kind, "bdata": data}


def _text(text: str) -> str:
    return html.escape(text, quote=False)  # plotly.js reads no quotes in attributes here
