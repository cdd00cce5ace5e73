"""Perturbed releases: small, even, the same each time; and how far their values spread."""

from dataclasses import replace

import numpy as np
import pytest

from harness.studies.errors.split import spread
from harness.studies.shared.perturbation import MEMBERS, SIZES, departure, perturbed
from models import Scene


def test_departures_fill_each_axis_evenly() -> None:
    points = np.array([departure(number) for number in range(64)])
    assert np.abs(points).max() <= 1.0
    # along each axis a quarter has 16 of 64; the worst of four random counts is off by 5
    for axis in points.T:
        counts, _ = np.histogram(axis, bins=4, range=(-1.0, 1.0))
        assert np.abs(counts - 16).max() <= 3
    assert len(np.unique(points, axis=0)) == 64


@pytest.mark.parametrize("size", SIZES)
def test_a_release_departs_by_no_more_than_its_size(gentle: Scene, size: float) -> None:
    for number in range(MEMBERS):
        other = perturbed(gentle, size, number)
        assert other == perturbed(gentle, size, number)
        assert replace(other, name=gentle.name, release=gentle.release) == gentle
        for name in ("phi", "psi_dot", "theta_dot"):
            nominal = getattr(gentle.release, name)
            off = abs(getattr(other.release, name) / nominal - 1.0)
            assert 0.0 < off <= size * (1.0 + 1e-6)  # the ratio is rounded at 1e-16


def test_long_names_stay_names(gentle: Scene) -> None:
    assert len(perturbed(replace(gentle, name="a" * 64), 1e-6, 3).name) <= 64


def test_spread_is_the_largest_departure() -> None:
    found = spread((1.0, 2.0), [(1.5, 2.5), (0.75, 1.75), (None, 2.0)])
    assert found.of_engine == 0.5
    assert found.of_truth == 0.5
    assert found.of_error == 0.0  # engine and truth follow the perturbation alike
    assert found.members == 2
    assert found.band == 0.5


def test_spread_about_nothing_is_not_known() -> None:
    found = spread((None, 2.0), [(1.0, 2.5)])
    assert found.of_engine is None
    assert found.of_error is None
    assert found.band == 0.5
