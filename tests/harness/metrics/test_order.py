"""Observed order, on errors that are exact powers of the timestep."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from harness.metrics.convergence import observed_order

STEPS = (1e-3, 3e-4, 1e-4, 3e-5)


@given(st.floats(0.25, 8.0), st.floats(1e-6, 1e3), st.sampled_from((1.0, -1.0)))
def test_a_power_law_has_its_power(power: float, size: float, sign: float) -> None:
    found = observed_order(STEPS, [sign * size * step**power for step in STEPS])
    # logarithms of numbers down to 1e-36 hold 14 digits of a slope over a decade and a half
    assert found.order == pytest.approx(power, abs=1e-12)
    assert found.spread == pytest.approx(0.0, abs=1e-12)
    assert found.points == 4


def test_the_order_of_the_steps_does_not_matter() -> None:
    errors = [step**2 + 0.1 * step for step in STEPS]
    forward = observed_order(STEPS, errors)
    assert observed_order(STEPS[::-1], errors[::-1]) == forward
    assert 1.0 < forward.order < 2.0
    assert forward.spread > 0.0


def test_a_plateau_shows_in_the_spread() -> None:
    found = observed_order((1e-2, 1e-3, 1e-4), (1e-2, 1e-3, 1e-3))
    assert found.spread == pytest.approx(0.5, abs=1e-12)  # slopes 1 and 0
    assert found.order == pytest.approx(0.5, abs=1e-12)


def test_what_is_no_number_or_zero_is_left_out() -> None:
    found = observed_order(STEPS, (1e-3, math.nan, 0.0, 3e-5))
    assert found.points == 2
    assert found.order == pytest.approx(1.0, abs=1e-12)
    assert math.isnan(found.spread)


@pytest.mark.parametrize("errors", [(1.0,), (math.nan,), ()])
def test_one_error_has_no_order(errors: tuple[float, ...]) -> None:
    found = observed_order(STEPS[: len(errors)], errors)
    assert math.isnan(found.order)
    assert found.points == int(np.isfinite(errors).sum())
