"""Minima that stand out: the same as scipy finds, without the import of its package of signals."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from scipy.signal import find_peaks

from harness.metrics.bounces import prominent_minima

_FEW_LEVELS = arrays.arrays(np.float64, st.integers(1, 40), elements=st.integers(0, 6).map(float))


@given(values=_FEW_LEVELS, prominence=st.integers(0, 5).map(float))
def test_they_are_those_of_scipy(values: np.ndarray, prominence: float) -> None:
    # few levels: flat bottoms, neighbours of one depth, and rises of just the prominence abound
    expected, _ = find_peaks(-values, prominence=prominence)
    assert prominent_minima(values, prominence) == expected.tolist()


def test_those_of_a_long_record_that_is_noise_are_scipy_s_too() -> None:
    """Of a can at rest a third of the samples are bottoms."""
    noise = np.random.default_rng(1).normal(size=50_000)
    expected, _ = find_peaks(-noise, prominence=6.0)
    assert expected.size > 0
    assert prominent_minima(noise, 6.0) == expected.tolist()


@pytest.mark.parametrize(
    ("values", "minima"),
    [
        ([1.0, 0.0, 1.0], [1]),
        ([1.0, 0.0, 0.5], []),  # rises too little before it ends
        ([1.0, 0.0, 0.0, 0.0, 1.0], [2]),
        ([3.0, 1.0, 3.0, 0.0, 3.0], [1, 3]),
        ([3.0, 1.0, 1.5, 0.0, 3.0], [3]),  # falls further before it rises enough
        ([1.0], []),
    ],
)
def test_a_minimum_is_followed_by_a_rise(values: list[float], minima: list[int]) -> None:
    assert prominent_minima(np.array(values), 1.0) == minima
