"""Bars: on paper and on the page they reach from their base to their value."""

import base64

import numpy as np
import plotly.graph_objects as go

from harness.core.report_model import Figure, Panel, Series
from harness.report.matplotlib_renderer import render
from harness.report.plotly_renderer import description
from harness.report.simplify_curves import PAPER, simplify
from harness.report.style import entries, palette

BARS = Series(
    label="bars",
    kind="mujoco",
    x=np.array((0.0, 1.0, 2.0)),
    y=np.array((3.0, -2.0, np.nan)),
    base=np.array((0.0, 1.0, 0.5)),
    mark="bars",
    hover=("first", "second", "<b>third</b>"),
)
FIGURE = Figure(
    name="bars",
    title="Bars",
    seen="Three places.",
    panels=(
        Panel(
            title="Bars", x_label="x", y_label="y", x_names=("one", "two", "<i>"), series=(BARS,)
        ),
    ),
)


def test_bars_reach_from_base_to_value_on_the_page() -> None:
    panel = description(FIGURE, palette(["mujoco"]))[0]
    bar = panel["data"][0]
    height = np.frombuffer(base64.b64decode(bar["y"]["bdata"]), f"<{bar['y']['dtype']}")
    np.testing.assert_array_equal(height, (3.0, -3.0, np.nan))
    assert panel["layout"]["xaxis"]["ticktext"] == ["one", "two", "&lt;i&gt;"]
    assert bar["hovertext"][2] == "&lt;b&gt;third&lt;/b&gt;"
    go.Figure(data=panel["data"], layout=panel["layout"])  # refuses unknown keys


def test_bars_have_a_legend_entry_of_their_own_and_are_not_thinned() -> None:
    (entry,) = entries(FIGURE)
    assert (entry.bars, entry.line, entry.points) == (True, False, False)
    assert simplify(FIGURE, PAPER).panels[0].series[0].base is BARS.base


def test_bars_are_drawn_on_paper_with_names_below() -> None:
    once = render(FIGURE, palette(["mujoco"]))
    empty = Panel(title="Bars", x_label="x", y_label="y", x_names=("one", "two", "<i>"), series=())
    without = render(Figure(name="b", title="B", seen="", panels=(empty,)), palette([]))
    assert once.png != without.png
    for name in ("one", "two", "&lt;i&gt;"):
        assert f">{name}<" in once.svg
