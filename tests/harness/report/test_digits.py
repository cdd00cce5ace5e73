"""Numbers and names as a person reads them."""

import numpy as np
import pandas as pd
import pytest

from harness.report.number_format import NOTHING, heading, readable, slug, slugs


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (209.3634004625, "209.4"),
        (-0.13041, "\N{MINUS SIGN}0.1304"),
        (0.002, "0.002"),
        (0.0370000001, "0.03700"),
        (1e-5, "1\N{MULTIPLICATION SIGN}10⁻⁵"),
        (-1.23456e-7, "\N{MINUS SIGN}1.235\N{MULTIPLICATION SIGN}10⁻⁷"),
        (99_999.6, "100000"),
        (123_456.0, "1.235\N{MULTIPLICATION SIGN}10⁵"),
        (0.0, "0"),
        (np.float64(0.5), "0.5"),
        (np.float32(0.25), "0.25"),
        (np.int64(123_456), "123\N{NARROW NO-BREAK SPACE}456"),
        (-42, "\N{MINUS SIGN}42"),
        (np.inf, "∞"),
        (-np.inf, "\N{MINUS SIGN}∞"),
        (np.nan, NOTHING),
        (None, NOTHING),
        (pd.NA, NOTHING),
        (pd.NaT, NOTHING),
        (True, "yes"),
        (np.False_, "no"),
        ("matched", "matched"),
    ],
)
def test_cells(value: object, text: str) -> None:
    assert readable(value) == text


@pytest.mark.parametrize(
    ("column", "words", "unit"),
    [
        ("angle_of_turn_deg", "angle of turn", "°"),
        ("max_slip_m_s", "max slip", "m/s"),
        ("t_s", "t", "s"),
        ("phi_rms_rad", "phi rms", "rad"),
        ("steps", "steps", ""),
        ("s", "s", ""),
    ],
)
def test_headings(column: str, words: str, unit: str) -> None:
    assert heading(column) == (words, unit)


@pytest.mark.parametrize("text", ["../../etc/passwd", "a/b", "..", "", "Ü \0\n", "<b>", "x" * 500])
def test_a_slug_is_a_safe_file_name(text: str) -> None:
    name = slug(text)
    assert 0 < len(name) <= 80
    assert set(name) <= set("abcdefghijklmnopqrstuvwxyz0123456789-")


def test_slugs_do_not_repeat() -> None:
    assert slugs(["a b", "a-b", "a-b-2", "a_b"]) == ["a-b", "a-b-2", "a-b-2-2", "a-b-3"]
