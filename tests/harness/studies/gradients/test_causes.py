"""Causes of wrong differences, on functions of which the cause is known."""

import math
from collections.abc import Callable
from functools import partial

import numpy as np
import pytest

from harness.studies.gradients.causes import (
    Cause,
    Takeover,
    long_cause,
    own_causes,
    short_cause,
)

STEPS = tuple(10.0**-power for power in range(1, 10))


def causes(
    of: Callable[[float], float],
    exact: float,
    *,
    size: float = 1.0,
    steps: tuple[float, ...] = STEPS,
    chaotic: bool = False,
) -> tuple[Cause | None, Cause | None]:
    """Return what goes wrong at short and at long steps of a function about 0."""
    values = [(of(s) - of(-s)) / (2.0 * s) for s in steps]
    scale = abs(exact)
    return (
        short_cause(steps, values, exact=exact, scale=scale, right=0.01, unit=1.0, size=size),
        long_cause(
            steps,
            values,
            exact=exact,
            scale=scale,
            right=0.01,
            growth=abs(exact) / size,
            chaotic=chaotic,
        ),
    )


def noisy(size: float) -> Callable[[float], float]:
    """Return a smooth function with noise of a size, the same at the same place."""

    def of(x: float) -> float:
        chance = np.random.default_rng(hash(abs(x)))
        # odd, so that a central difference sees all of it, and never next to nothing
        rough = chance.choice((-1.0, 1.0)) * chance.uniform(0.5, 1.0)
        return math.sin(x) + math.copysign(1.0, x) * size * float(rough)

    return of


def test_a_smooth_function_is_right_at_every_short_step() -> None:
    short, long = causes(lambda x: math.sin(5.0 * x), 5.0)
    assert short is None
    assert long == Cause(takeover=Takeover.TRUNCATION, step=0.1)


@pytest.mark.parametrize(
    ("size", "takeover"), [(1e-13, Takeover.ROUND_OFF), (1e-7, Takeover.DISCONTINUITY)]
)
def test_noise_takes_over_where_it_is_a_hundredth_of_the_change(
    size: float, takeover: Takeover
) -> None:
    steps = tuple(10.0**-power for power in range(1, 13))
    short, _ = causes(noisy(size), 1.0, steps=steps)
    assert short is not None
    assert short.takeover is takeover
    # noise of this size over the step is 0.01 at a hundred times the size
    assert 0.05 < short.step / (100.0 * size) < 1.1


def test_steps_between_two_jumps_settle_on_another_derivative() -> None:
    # stairs of slope 1, of which each tread rises by 0.3 only
    width = 1e-5
    short, _ = causes(lambda x: 0.3 * x + 0.7 * width * math.floor(x / width + 0.5), 1.0)
    assert short is not None
    # stairs and a smooth ripple look alike to differences within a tread
    assert short.takeover is Takeover.RIPPLE
    assert short.step == pytest.approx(1e-6)


def test_a_jump_at_the_release_is_as_large_at_every_step() -> None:
    short, _ = causes(lambda x: x + 1e-6 * (x > 0.0), 1.0)
    assert short is not None
    assert short.takeover is Takeover.DISCONTINUITY
    assert short.step == pytest.approx(1e-5)


def test_a_smooth_ripple_is_no_discontinuity() -> None:
    width = 1e-6
    short, _ = causes(lambda x: x + 0.5 * width * math.sin(x / width), 1.0)
    assert short is not None
    assert short.takeover is Takeover.RIPPLE


def test_a_motion_of_another_derivative_is_wrong_at_all_steps() -> None:
    short, long = causes(lambda x: 1.2 * x, 1.0)
    assert short == Cause(takeover=Takeover.RIPPLE, step=0.1)
    assert long is None


def logistic(x: float) -> float:
    """Return the logistic map of 0.3 + x after sixteen times: chaos."""
    value = 0.3 + x
    for _ in range(16):
        value = 4.0 * value * (1.0 - value)
    return value


def test_a_derivative_that_grew_exponentially_holds_for_short_steps_alone() -> None:
    value, slope = 0.3, 1.0
    for _ in range(16):
        value, slope = 4.0 * value * (1.0 - value), slope * 4.0 * (1.0 - 2.0 * value)
    assert abs(slope) > 1e4
    _, long = causes(logistic, slope, chaotic=True)
    assert long is not None
    assert long.takeover is Takeover.CHAOS
    # the linear range ends about where the change predicted is a tenth
    assert 1e-3 < long.step * abs(slope) < 10.0
    _, same = causes(logistic, slope, chaotic=False)
    assert same is not None
    assert same.takeover is Takeover.SATURATION
    # where nothing has grown yet a chaotic motion bends like any other
    _, bend = causes(lambda x: math.sin(5.0 * x), 5.0, chaotic=True)
    assert bend == Cause(takeover=Takeover.TRUNCATION, step=0.1)


def clipped(edge: float, x: float) -> float:
    """Return x between minus and plus an edge."""
    return max(-edge, min(edge, x))


def test_what_is_bounded_saturates_however_few_steps_are_too_long() -> None:
    halves = tuple(10.0 ** (-power / 2.0) for power in range(9))
    for count in (1, 2, 3):  # long steps at which the change is level
        edge = halves[count - 1] / 3.0
        _, long = causes(partial(clipped, edge), 1.0, steps=halves)
        assert long == Cause(takeover=Takeover.SATURATION, step=halves[count - 1])


def test_what_bends_but_goes_on_is_truncation() -> None:
    _, cube = causes(lambda x: x + 30.0 * x**3, 1.0)
    assert cube == Cause(takeover=Takeover.TRUNCATION, step=0.1)


def test_causes_of_an_engine_s_own_steps_follow_from_their_errors() -> None:
    stiff, off, right = Takeover.STIFFNESS, Takeover.ROUND_OFF, None
    assert own_causes([9.0, 0.5, 0.001], right=0.01) == [stiff, stiff, right]
    assert own_causes([0.3, 0.004, 0.2], right=0.01) == [stiff, right, off]
    assert own_causes([0.31, None, 0.3], right=0.01) == [Takeover.RIPPLE, None, Takeover.RIPPLE]


def test_without_numbers_there_is_no_cause() -> None:
    assert (
        short_cause(STEPS, [None] * 9, exact=1.0, scale=1.0, right=0.01, unit=1.0, size=1.0) is None
    )
    assert (
        long_cause(STEPS, [np.nan] * 9, exact=1.0, scale=1.0, right=0.01, growth=1.0, chaotic=True)
        is None
    )
