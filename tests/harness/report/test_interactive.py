"""What plotly.js is told: valid, true to the data, with no text that it would read as HTML."""

import base64
import gzip
import json
from typing import Any

import numpy as np
import plotly.graph_objects as go
import pytest

from harness.core.report_model import Artefact, Figure, Panel, Series
from harness.report.plotly_renderer import description, plotly_packed
from harness.report.style import palette


def described(figure: Figure) -> list[dict[str, Any]]:
    return description(figure, palette(s.kind for panel in figure.panels for s in panel.series))


def figures(artefacts: tuple[Artefact, ...]) -> list[Figure]:
    return [artefact for artefact in artefacts if isinstance(artefact, Figure)]


def unpacked(packed: dict[str, Any]) -> np.ndarray:
    return np.frombuffer(base64.b64decode(packed["bdata"]), dtype=f"<{packed['dtype']}")


def one(x: np.ndarray, y: np.ndarray, **axes: Any) -> dict[str, Any]:
    panel = Panel(
        title="", x_label="", y_label="", series=(Series(label="a", kind="a", x=x, y=y),), **axes
    )
    return described(Figure(name="one", title="", seen="", panels=(panel,)))[0]


def test_plotly_accepts_what_it_is_told(artefacts: tuple[Artefact, ...]) -> None:
    for figure in figures(artefacts):
        for panel in described(figure):
            drawn = go.Figure(data=panel["data"], layout=panel["layout"])  # refuses unknown keys
            assert len(drawn.data) == len(panel["data"])
            json.dumps(panel, allow_nan=False)


def test_panels_over_the_same_times_are_zoomed_together(
    artefacts: tuple[Artefact, ...],
) -> None:
    assert [panel["linked"] for panel in described(figures(artefacts)[0])] == [0, 0, 2]


def test_a_label_is_one_legend_entry_in_all_panels(artefacts: tuple[Artefact, ...]) -> None:
    for panel in described(figures(artefacts)[0]):
        assert [trace["meta"]["entry"] for trace in panel["data"]] == [0, 1, 2]


def test_texts_are_escaped(hostile_artefacts: tuple[Artefact, ...]) -> None:
    def texts(told: object) -> list[str]:
        if isinstance(told, dict):
            return [t for key, v in told.items() if key != "meta" for t in texts(v)]
        if isinstance(told, list):
            return [t for value in told for t in texts(value)]
        return [told] if isinstance(told, str) else []

    for figure in figures(hostile_artefacts):
        for text in texts(described(figure)):
            plain = text.replace("<br>", "").replace("<extra>", "").replace("</extra>", "")
            assert "<" not in plain


@pytest.mark.parametrize("offset", [0.0, 1.0, 1e6])
def test_packing_moves_no_point_by_a_visible_distance(offset: float) -> None:
    x = offset + np.linspace(0.0, 1e-6 if offset == 1.0 else 1.0, 50)
    trace = one(x, x)["data"][0]
    # a thousandth of a pixel in a panel a thousand pixels wide
    assert np.abs(unpacked(trace["x"]) - x).max() <= 1e-6 * np.ptp(x)


def test_logarithmic_axes_leave_out_what_has_no_place() -> None:
    told = one(np.array([1.0, 10.0, 100.0]), np.array([0.0, 1.0, -1.0]), log_x=True, log_y=True)
    assert list(np.isnan(unpacked(told["data"][0]["y"]))) == [True, False, True]
    assert told["layout"]["xaxis"]["type"] == told["layout"]["yaxis"]["type"] == "log"


def test_equal_axes_are_tied() -> None:
    told = one(np.arange(3.0), np.arange(3.0), equal=True)
    assert told["layout"]["yaxis"]["scaleanchor"] == "x"


def test_plotly_comes_whole() -> None:
    source = gzip.decompress(base64.b64decode(plotly_packed())).decode("utf-8")
    assert "plotly.js v" in source[:200]
