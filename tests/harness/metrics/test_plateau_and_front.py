"""Plateaus, asymptotic orders and the Pareto front, on errors that are known exactly."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from harness.metrics.convergence import asymptotic_order, pareto_front, plateau

STEPS = tuple(10.0 ** -(rung / 2.0) for rung in range(9))


@given(st.floats(0.9, 4.0), st.floats(1e-5, 1e-2), st.sampled_from((1.0, -1.0)))
def test_a_level_is_found_within_a_tenth(power: float, level: float, sign: float) -> None:
    errors = [sign * (level + step**power) for step in STEPS]
    found = plateau(STEPS, errors)
    if STEPS[-1] ** power < level / 2.0:
        assert found is not None
        assert found.level == pytest.approx(sign * level, rel=0.1)
        if sum(step**power > level / 5.0 for step in STEPS) < 3:
            return  # too few rungs stand out of the level to have an order
        order = asymptotic_order(STEPS, errors, found.level)
        assert order is not None
        assert order.order == pytest.approx(power, abs=0.05)


@given(st.floats(0.5, 4.0), st.floats(1e-6, 1e3))
def test_an_error_that_falls_has_no_plateau(power: float, size: float) -> None:
    errors = [size * step**power for step in STEPS]
    assert plateau(STEPS, errors) is None
    order = asymptotic_order(STEPS, errors)
    assert order is not None
    assert order.points == len(STEPS)
    assert order.order == pytest.approx(power, abs=1e-9)


def test_coarse_rungs_of_another_order_are_left_out() -> None:
    errors = [step + 30.0 * step**3 for step in STEPS]
    order = asymptotic_order(STEPS, errors)
    assert order is not None
    assert order.coarsest < 0.2
    assert order.order == pytest.approx(1.0, abs=0.05)


def test_a_flat_and_noisy_ladder_is_flat_all_the_same() -> None:
    found = plateau((1e-2, 1e-3, 1e-4, 1e-5), (3.0, 1.1, 0.9, 1.0))
    assert found is not None
    assert found.level == pytest.approx(1.0, rel=0.1)


def test_noise_about_zero_is_no_plateau_and_has_no_order() -> None:
    errors = (1.0, -1.0, 0.2, -3.0, 0.01)
    assert plateau(STEPS[:5], errors) is None
    assert asymptotic_order(STEPS[:5], errors) is None


def test_an_unknown_error_breaks_the_range() -> None:
    order = asymptotic_order((1.0, 0.1, 0.01, 1e-3, 1e-4), (1.0, None, 1e-2, 1e-3, 1e-4))
    assert order is not None
    assert order.points == 3


numbers = st.floats(0.0, 10.0).map(lambda x: round(x, 1))


@given(st.lists(st.tuples(numbers, numbers), max_size=30))
def test_the_front_is_what_nothing_beats(points: list[tuple[float, float]]) -> None:
    costs, errors = [c for c, _ in points], [e for _, e in points]

    def beaten(place: int) -> bool:
        c, e = points[place]
        return any(x <= c and y <= e and (x < c or y < e) for x, y in points)

    found = pareto_front(costs, errors)
    assert sorted(found) == [place for place in range(len(points)) if not beaten(place)]
    assert [costs[place] for place in found] == sorted(costs[place] for place in found)


def test_what_is_not_finite_is_on_no_front() -> None:
    assert pareto_front((1.0, math.inf, 0.1), (1.0, 0.0, math.nan)) == (0,)
