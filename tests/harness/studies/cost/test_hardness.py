"""Scenes of a wanted hardness, and exponents."""

import math

import pytest

from harness.studies.cost.design import epsilon, hardened
from harness.studies.cost.prices import exponent
from models import load


def test_the_paper_s_epsilon() -> None:
    # 1.43e-10 in the paper, from the leading order in phi: the largest phi is 0.03
    assert epsilon(load("paper-release")) == pytest.approx(1.43e-10, rel=0.06)


@pytest.mark.parametrize("wanted", [1e-5, 1e-7, 1e-10])
def test_a_scene_has_the_hardness_that_is_wanted(wanted: float) -> None:
    made = hardened(load("paper-release"), wanted)
    assert made is not None
    assert epsilon(made) == pytest.approx(wanted, rel=0.02)
    assert made.release.phi == load("paper-release").release.phi


def test_a_can_that_rolls_on_a_straight_line_is_not_hardened() -> None:
    assert hardened(load("straight-rolling"), 1e-6) is None


def test_an_exact_power_has_its_exponent() -> None:
    sizes = (1e-4, 1e-6, 1e-8, 1e-10)
    found = exponent(sizes, [3.0 * e**-0.5 for e in sizes])
    assert found is not None
    assert found.exponent == pytest.approx(-0.5, abs=1e-12)
    assert found.confidence < 1e-9
    two = exponent(sizes[:2], (1.0, 10.0))
    assert two is not None
    assert math.isinf(two.confidence)
    assert exponent((1e-4,), (1.0,)) is None
