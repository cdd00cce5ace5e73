"""Colours stand out from the page, and from each other in every kind of colour vision."""

import itertools

import numpy as np
import pytest

from harness.core.plain_json import Floats
from harness.engines.registry import our_names
from harness.report.style import REFERENCE, palette

CARDS = {"light": "#ffffff", "dark": "#1a1e24"}  # what curves lie on: --card of the style sheet

# Machado, Oliveira and Fernandes (2009), severity 1, on linear RGB
VISIONS = {
    "all three cones": np.eye(3),
    "no long cones": np.array(
        [
            [0.152286, 1.052583, -0.204868],
            [0.114503, 0.786281, 0.099216],
            [-0.003882, -0.048116, 1.051998],
        ]
    ),
    "no middle cones": np.array(
        [
            [0.367322, 0.860646, -0.227968],
            [0.280085, 0.672501, 0.047413],
            [-0.011820, 0.042940, 0.968881],
        ]
    ),
    "no short cones": np.array(
        [
            [1.255528, -0.076749, -0.178779],
            [-0.078411, 0.930809, 0.147602],
            [0.004733, 0.691367, 0.303900],
        ]
    ),
}
KINDS = our_names()
"""Every engine of this project, installed or not."""


def linear(colour: str) -> Floats:
    code = np.array([int(colour[n : n + 2], 16) for n in (1, 3, 5)]) / 255.0
    return np.where(code <= 0.04045, code / 12.92, ((code + 0.055) / 1.055) ** 2.4)


def luminance(colour: str) -> float:
    return float(linear(colour) @ [0.2126, 0.7152, 0.0722])


def lab(light: Floats) -> Floats:
    """Return CIELAB (D65) of linear RGB."""
    to_xyz = np.array(
        [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]
    )
    share = to_xyz @ np.clip(light, 0.0, 1.0) / np.array([0.9505, 1.0, 1.089])
    f = np.where(share > (6 / 29) ** 3, np.cbrt(share), share / (3 * (6 / 29) ** 2) + 4 / 29)
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


@pytest.mark.parametrize("face", ["light", "dark"])
def test_every_colour_stands_out_from_the_page(face: str) -> None:
    card = luminance(CARDS[face])
    for kind, ink in palette(KINDS).items():
        bright, dim = sorted((luminance(getattr(ink, face)), card), reverse=True)
        # WCAG 2.2, 1.4.11: graphical objects
        assert (bright + 0.05) / (dim + 0.05) >= 3.0, kind


@pytest.mark.parametrize("face", ["light", "dark"])
@pytest.mark.parametrize("vision", VISIONS)
def test_any_two_colours_stay_apart(face: str, vision: str) -> None:
    seen = {
        kind: lab(VISIONS[vision] @ linear(getattr(ink, face)))
        for kind, ink in palette(KINDS).items()
    }
    for one, other in itertools.combinations(seen, 2):
        # 2.3 is a just noticeable difference in CIELAB; thin lines need several of them
        assert np.linalg.norm(seen[one] - seen[other]) >= 6 * 2.3, (one, other)


def test_a_kind_keeps_its_colour_whatever_the_order() -> None:
    assert palette(KINDS) == palette(reversed(KINDS))
    assert palette(("reference",))["reference"] == REFERENCE


def test_more_kinds_than_colours_still_get_one() -> None:
    assert len(palette(str(n) for n in range(40))) == 40
