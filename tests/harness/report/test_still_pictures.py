"""Still pictures of panels: every point in its place, with axes that say which place it is."""

import base64
import math
import re
import struct
import zlib
from collections.abc import Sequence
from dataclasses import replace
from xml.etree.ElementTree import Element, fromstring

import numpy as np
import pytest

from harness.core.report_model import Figure, Heatmap, Panel, Series
from harness.report.style import SIGNED, palette
from harness.report.svg_renderer import stills
from tests.support.reports import everything, hostile_words

Points = np.ndarray[tuple[int, int], np.dtype[np.float64]]


def series(x: Sequence[float], y: Sequence[float], **fields: object) -> Series:
    given = {"label": "mujoco", "kind": "mujoco", **fields}
    return Series(x=np.array(x, dtype=float), y=np.array(y, dtype=float), **given)  # type: ignore[arg-type]


def panel(*curves: Series, **fields: object) -> Panel:
    return Panel(title="p", x_label="x [s]", y_label="y [m]", series=curves, **fields)  # type: ignore[arg-type]


def still(one: Panel) -> Element:
    figure = Figure(name="f", title="f", seen="", panels=(one,))
    inks = palette(["mujoco", *(s.kind for s in one.series)])
    (text,) = stills(figure, inks, {kind: f"--kind-{n}" for n, kind in enumerate(inks)})
    return fromstring(text)  # noqa: S314 - our own


def texts(root: Element) -> list[str]:
    return [text.text or "" for text in root.iter("text")]


def curves(root: Element) -> list[str]:
    return [path.attrib["d"] for path in root.iter("path") if "style" in path.attrib]


def points(path: str) -> list[Points]:
    """Return the corners of each line in a path, in the picture's units."""
    lines = []
    for line in filter(None, path.split("M")):
        numbers = [float(n) for n in re.findall(r"-?(?:\d+\.\d|\.\d|\d+)", line)]
        lines.append(np.cumsum(np.reshape(numbers, (-1, 2)), axis=0))
    return lines


def ticks(root: Element) -> tuple[dict[float, float], dict[float, float]]:
    """Return where each number on the two axes stands, by the number."""
    found: tuple[dict[float, float], dict[float, float]] = ({}, {})
    for text in root.iter("text"):
        if "class" in text.attrib or "x" not in text.attrib:
            continue
        words = (text.text or "").replace("\N{MINUS SIGN}", "-")
        words = words.translate(str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "0123456789-"))
        mantissa, times, power = words.rpartition("10") if "10" in words[1:] else (words, "", "")
        mantissa = mantissa.rstrip("\N{MULTIPLICATION SIGN}")
        if not times and re.fullmatch("10-?[0-9]+", words) and words not in {"100", "1000"}:
            mantissa, times, power = "1", "10", words[2:]
        value = float(mantissa or 1) * 10.0 ** float(power or 0) if times else float(words)
        if text.attrib["text-anchor"] == "middle":
            found[0][value] = float(text.attrib["x"])
        else:
            found[1][value] = float(text.attrib["y"]) - 4.0
    return found


def test_points_stand_where_the_ticks_say() -> None:
    x, y = [0.0, 1.0, 3.0, 4.0], [-2.0, 5.0, 1.0, 8.0]
    root = still(panel(series(x, y)))
    (line,) = points(curves(root)[0])
    for axis, (values, at) in enumerate(zip((x, y), ticks(root), strict=True)):
        assert len(at) >= 4
        slope, offset = np.polyfit(list(at), list(at.values()), 1)
        np.testing.assert_allclose(line[:, axis], slope * np.array(values) + offset, atol=0.11)


def test_a_logarithmic_axis_is_one() -> None:
    x, y = [1e-3, 1e-2, 1.0], [3e-7, 2e-4, 4e-2]
    root = still(panel(series(x, y), log_x=True, log_y=True))
    (line,) = points(curves(root)[0])
    place = line[:, 0]
    assert (place[1] - place[0]) / (place[2] - place[0]) == pytest.approx(1 / 3, abs=2e-3)
    assert "10⁻⁶" in texts(root)
    assert "0.01" in texts(root)


def test_a_gap_stays_a_gap_and_what_has_no_logarithm_is_one() -> None:
    y = [1.0, 2.0, math.nan, 3.0, 0.0, 5.0, 6.0]
    root = still(panel(series(range(1, 8), y), log_y=True))
    assert [len(line) for line in points(curves(root)[0])] == [2, 2]


def test_equal_axes_have_one_scale() -> None:
    turn = np.linspace(0.0, 2.0 * np.pi, 200)
    root = still(panel(series(np.cos(turn).tolist(), np.sin(turn).tolist()), equal=True))
    (line,) = points(curves(root)[0])
    wide, high = np.ptp(line, axis=0)
    assert wide == pytest.approx(high, rel=2e-3)


def test_marks_and_bars_are_one_for_each_point() -> None:
    x, y = [0.0, 1.0, 2.0], [3.0, -2.0, 4.0]
    for mark in ("points", "both", "bars"):
        root = still(panel(series(x, y, mark=mark)))
        shapes = curves(root)[-1]
        assert shapes.count("M") == shapes.count("z") == 3
        assert len(curves(root)) == (2 if mark == "both" else 1)


def test_bars_reach_from_their_base_to_their_value() -> None:
    bars = series([0.0, 1.0], [3.0, 1.0], mark="bars", base=np.array([1.0, 2.0]))
    root = still(panel(bars, x_names=("first", "second <i>")))
    assert {"first", "second <i>"} <= set(texts(root))
    tops, heights = zip(
        *(
            map(float, found)
            for found in re.findall(r"M\S+ (\S+)h\S+?v(-?[\d.]+)", curves(root)[0])
        ),
        strict=True,
    )
    scale = heights[0] / 2.0  # units for each metre: downwards
    assert scale > 0.0
    assert heights[1] == pytest.approx(-scale, abs=0.2)
    assert tops[1] - tops[0] == pytest.approx(2.0 * scale, abs=0.2)


def test_bars_from_zero_stand_on_the_lower_end_of_a_logarithmic_axis() -> None:
    root = still(panel(series([0.0, 1.0], [1e-3, 10.0], mark="bars"), log_y=True))
    (frame,) = (path.attrib["d"] for path in root.iter("path") if path.get("class") == "frame")
    height = float(frame.partition("V")[2].partition("H")[0])
    bars = re.findall(r"M\S+ (\S+)h\S+?v([\d.]+)h", curves(root)[0])
    assert [float(top) + float(high) for top, high in bars] == pytest.approx([height] * 2, abs=0.11)


def test_the_truth_lies_below_and_colours_are_those_of_the_page() -> None:
    root = still(panel(series([0, 1], [0, 1]), series([0, 1], [1, 0], kind="reference", label="r")))
    styles = [path.attrib["style"] for path in root.iter("path") if "style" in path.attrib]
    assert styles == ["color:var(--kind-1)", "color:var(--kind-0)"]


def test_colours_of_cells_are_those_of_the_scale() -> None:
    z = np.array([[-1.0, 0.0, 1.0], [np.nan, 0.5, -0.5]])
    heat = Heatmap(label="h [m]", x=np.arange(4.0), y=np.arange(3.0), z=z, signed=True)
    root = still(panel(heat=heat))
    image, bar = (one.attrib["href"].partition(",")[2] for one in root.iter("image"))
    pixels = unpacked(base64.b64decode(image))
    rows, columns, _ = pixels.shape

    def at(row: int, column: int) -> tuple[str, int]:
        y, x = rows - 1 - int((row + 0.5) * rows / 2), int((column + 0.5) * columns / 3)
        red, green, blue, alpha = pixels[y, x].tolist()
        return f"#{red:02x}{green:02x}{blue:02x}", alpha

    ends = dict(SIGNED[1])
    assert at(0, 0) == (ends[0.0], 255)
    assert at(0, 1) == (ends[0.5], 255)
    assert at(0, 2) == (ends[1.0], 255)
    assert at(1, 1) == (ends[0.75], 255)
    assert at(1, 0)[1] == 0
    shades = unpacked(base64.b64decode(bar))
    assert f"#{bytes(shades[0, 0, :3]).hex()}" == ends[1.0]
    assert f"#{bytes(shades[-1, 0, :3]).hex()}" == ends[0.0]
    assert "h [m]" in texts(root)


@pytest.mark.parametrize("signed", [False, True])
@pytest.mark.parametrize("number", [7e20, -7e20, 1.7e308, 5e-324, 0.0])
def test_a_map_of_one_number_has_a_scale_about_it(number: float, *, signed: bool) -> None:
    heat = Heatmap(label="h [m]", x=np.arange(3.0), y=np.arange(2.0), z=np.full((1, 2), number))
    root = still(panel(heat=replace(heat, signed=signed)))
    scale = [text.text for text in root.iter("text") if text.attrib["text-anchor"] == "start"]
    assert len(set(scale)) == len(scale) >= 2


def unpacked(png: bytes) -> "np.ndarray[tuple[int, int, int], np.dtype[np.uint8]]":
    """Return the pixels of a PNG without filters; refuses one whose sums are wrong."""
    assert png[:8] == b"\x89PNG\r\n\x1a\n"
    place, chunks = 8, {}
    while place < len(png):
        (size,) = struct.unpack(">I", png[place : place + 4])
        name, data = png[place + 4 : place + 8], png[place + 8 : place + 8 + size]
        assert struct.pack(">I", zlib.crc32(name + data)) == png[place + 8 + size :][:4]
        chunks[name], place = data, place + 12 + size
    columns, rows = struct.unpack(">II", chunks[b"IHDR"][:8])
    lines = np.frombuffer(zlib.decompress(chunks[b"IDAT"]), dtype=np.uint8)
    lines = lines.reshape(rows, 1 + 4 * columns)
    assert not lines[:, 0].any()
    return lines[:, 1:].reshape(rows, columns, 4)


@pytest.mark.parametrize("log", [False, True])
@pytest.mark.parametrize("y", [[], [math.nan, math.nan], [-1.0, -2.0]])
def test_a_panel_with_nothing_to_draw_says_so(y: list[float], *, log: bool) -> None:
    root = still(panel(series(range(1, 1 + len(y)), y), log_y=log))
    drawable = bool(y) and not log and not math.isnan(y[0])
    assert ("nothing to draw" in texts(root)) != drawable
    assert bool(curves(root)) == drawable


RANGES = (
    *((0.0, 0.0), (1.0, 1.0), (1.0, 1.0 + 1e-9), (123456.0, 123457.0), (-0.3, 0.1)),
    *((-5.2e-7, 3.1e-7), (1e-300, 2e-300), (-8e307, 8e307), (0.0, 1.7e308), (5e-324, 1.0)),
)


@pytest.mark.parametrize(
    ("low", "high", "log"),
    [(*ends, log) for ends in RANGES for log in (False, True) if ends[0] > 0.0 or not log],
)
def test_ticks_tell_numbers_apart(low: float, high: float, *, log: bool) -> None:
    root = still(panel(series([0.0, 1.0], [low, high]), log_y=log))
    at = [text for text in root.iter("text") if text.attrib["text-anchor"] == "end"]
    assert 2 <= len(at) <= 8
    assert len({text.text for text in at}) == len(at)
    assert all("nan" not in text and "inf" not in text for text in texts(root))
    assert np.isfinite(np.concatenate(points(curves(root)[0]))).all()


def test_every_text_stays_a_text() -> None:
    figures = [a for a in everything(hostile_words) if isinstance(a, Figure)]
    assert figures
    for figure in figures:
        for one in figure.panels:
            root = still(one)
            assert {element.tag for element in root.iter()} <= {"svg", "g", "path", "text", "image"}
            assert {one.x_label, one.y_label} <= set(texts(root))
            assert root.attrib["aria-label"].startswith(one.title)


def test_a_picture_is_small_and_the_same_each_time() -> None:
    x = np.linspace(0.0, 1.0, 200_000)
    noise = np.random.default_rng(0).normal(size=x.size)
    one = panel(series(x.tolist(), noise.tolist()))
    figure = Figure(name="f", title="f", seen="", panels=(one,))
    first, again = (stills(figure, palette(["mujoco"]), {"mujoco": "--kind-0"}) for _ in range(2))
    assert first == again
    assert len(first[0]) < 40_000
    smooth = replace(one, series=(series(x.tolist(), np.sin(9.0 * x).tolist()),))
    (path,) = curves(still(smooth))
    assert 30 < len(points(path)[0]) < 300
