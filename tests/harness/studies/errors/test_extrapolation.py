"""Limits and orders of ladders whose limit, order and noise are known."""

import math
from itertools import product

import numpy as np
import pytest

from harness.studies.errors.extrapolation import limit

STEPS = tuple(0.02 / 2.0**k for k in range(5))
LIMIT = -3.25


def power_ladder(order: float, first: float, second: float) -> list[float]:
    return [LIMIT + first * h**order + second * h ** (order + 1.0) for h in STEPS]


@pytest.mark.parametrize(
    ("order", "first", "second"),
    list(product((0.5, 1.0, 1.5, 2.0, 3.0), (1.0, -40.0), (0.0, 0.9, -3.0))),
)
def test_limit_is_within_its_uncertainty_and_order_within_a_twentieth(
    order: float, first: float, second: float
) -> None:
    found = limit(STEPS, power_ladder(order, first, second))
    assert found is not None
    assert abs(found.value - LIMIT) <= found.uncertainty
    assert found.order == pytest.approx(order, abs=0.05)
    # and the interval says something: it is narrower than the finest error is wide
    assert found.uncertainty < abs(first) * STEPS[-1] ** order


def test_an_exact_power_gives_the_limit_to_round_off() -> None:
    found = limit(STEPS, power_ladder(1.0, 2.0, 0.0))
    assert found is not None
    # nine times four roundings, the amplification at order one, of numbers of three
    assert found.value == pytest.approx(LIMIT, rel=0, abs=40 * math.ulp(LIMIT))
    assert found.uncertainty < 80 * math.ulp(abs(LIMIT))
    assert found.spread == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("seed", range(20))
def test_known_noise_widens_the_interval_enough(seed: int) -> None:
    noise = 2e-5
    wild = np.random.default_rng(seed).uniform(-noise, noise, len(STEPS))
    values = [value + off for value, off in zip(power_ladder(1.0, 2.0, 3.0), wild, strict=True)]
    found = limit(STEPS, values, noise)
    assert found is not None
    assert abs(found.value - LIMIT) <= found.uncertainty
    assert found.order == pytest.approx(1.0, abs=0.05)


def test_where_noise_drowns_the_finest_rungs_the_coarser_ones_give_the_order() -> None:
    steps = tuple(0.1 / 2.0**k for k in range(8))
    noise = 1e-8
    values = [LIMIT + h**3 + noise * math.sin(1e7 * h) for h in steps]
    found = limit(steps, values, noise)
    assert found is not None
    assert abs(found.value - LIMIT) <= found.uncertainty
    assert found.order == pytest.approx(3.0, abs=0.05)


def test_a_ladder_that_jumps_has_no_order_and_owns_to_its_range() -> None:
    values = [1.0, 1.3, 0.9, 1.2, 1.1]
    found = limit(STEPS, values)
    assert found is not None
    assert found.order is None
    assert found.value == 1.1
    assert found.uncertainty == pytest.approx(0.3)


def test_a_lucky_triple_at_the_end_is_not_believed() -> None:
    # as measured: a polygon that rolls on its corners
    values = [239.518965, 239.260447, 239.217910, 239.165507, 239.160167]
    found = limit(STEPS, values)
    assert found is not None
    assert found.order is None
    assert found.uncertainty == pytest.approx(239.217910 - 239.160167, rel=1e-6)


def test_a_ladder_that_takes_another_course_at_the_end_has_no_order() -> None:
    # as measured: below 0.1 ms a soft can touches with its far side too, and turns by less
    values = [236.440643, 236.218018, 236.106286, 236.050319, 235.652449]
    found = limit(STEPS, values)
    assert found is not None
    assert found.order is None
    assert found.value == values[-1]
    assert found.uncertainty == pytest.approx(236.106286 - 235.652449, rel=1e-6)


def test_a_ladder_that_does_not_change_is_its_own_limit() -> None:
    found = limit(STEPS, [2.0] * 5)
    assert found is not None
    assert (found.value, found.order) == (2.0, None)
    assert found.uncertainty <= 8 * math.ulp(2.0)


def test_few_values_say_less() -> None:
    values = power_ladder(1.0, 2.0, 0.5)
    three = limit(STEPS[:3], values[:3])
    two = limit(STEPS[:2], values[:2])
    one = limit(STEPS[:1], values[:1])
    assert three is not None
    assert two is not None
    assert one is not None
    assert abs(three.value - LIMIT) <= three.uncertainty
    assert three.spread is None
    assert two.value == values[1]
    assert two.order is None
    assert math.isinf(one.uncertainty)


def test_what_is_not_known_and_what_lies_before_it_is_left_out() -> None:
    values = power_ladder(1.0, 2.0, 0.5)
    known = limit(STEPS[1:], values[1:])
    assert limit(STEPS, [None, *values[1:]]) == known
    assert limit(STEPS, [*values[:4], None]) is None


def test_timesteps_that_are_no_ladder_are_refused() -> None:
    with pytest.raises(ValueError, match="constant ratio"):
        limit((0.1, 0.05, 0.02), (1.0, 2.0, 3.0))
    with pytest.raises(ValueError, match="constant ratio"):
        limit((0.1, 0.2), (1.0, 2.0))
