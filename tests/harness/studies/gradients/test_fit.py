"""Errors of differences of known truncation, floor and noise, and the verdicts on them."""

import math

import numpy as np
import pytest

from harness.core.case import Case
from harness.core.verdict import Status
from harness.studies.gradients.findings import Differences, OwnDerivative, judge
from harness.studies.gradients.fit import fit_errors
from models import load

STEPS = tuple(10.0**-power for power in range(1, 10))


def differences(error: dict[float, float], exact: float = 2.0) -> Differences:
    """Return differences whose relative errors are these, by step."""
    return Differences(
        base=Case(scene=load("gentle-rock"), engine="mujoco", timestep=1e-3),
        key="release.psi_dot",
        quantity="period_s",
        exact=exact,
        size=1.0,
        values={step: exact * (1.0 + off) for step, off in error.items()},
    )


@pytest.mark.parametrize(
    ("truncation", "floor", "noise"), [(3.0, 1e-5, 1e-12), (0.1, 1e-3, 1e-9), (50.0, 1e-7, 1e-14)]
)
def test_three_parts_are_found_and_where_each_takes_over(
    truncation: float, floor: float, noise: float
) -> None:
    s = np.array(STEPS)
    found = fit_errors(STEPS, tuple(truncation * s**2 + floor + noise / s))
    assert found is not None
    parts = found.truncation, found.floor, found.noise
    assert parts == pytest.approx((truncation, floor, noise), rel=0.02, abs=0)
    assert found.noise_below == pytest.approx(noise / floor, rel=0.05, abs=0)
    assert found.truncation_above == pytest.approx(math.sqrt(floor / truncation), rel=0.05, abs=0)
    assert found.at(s) == pytest.approx(truncation * s**2 + floor + noise / s, rel=0.02, abs=0)


def test_without_a_floor_noise_and_truncation_meet() -> None:
    s = np.array(STEPS)
    found = fit_errors(STEPS, tuple(2.0 * s**2 + 1e-15 / s))
    assert found is not None
    assert found.noise_below == found.truncation_above
    assert found.noise_below == pytest.approx((1e-15 / 2.0) ** (1 / 3), rel=0.05, abs=0)
    assert fit_errors(STEPS[:4], (1.0, None, 1.0, 0.0)) is None


def test_the_best_step_needs_the_truth_and_the_settled_one_does_not() -> None:
    judged = differences({1e-1: 1e-6, 1e-2: 2.1e-3, 1e-3: 2e-3, 1e-4: 2e-3, 1e-5: 5e-1})
    assert judged.best == pytest.approx((1e-1, 1e-6), rel=1e-3)
    assert judged.settled == pytest.approx((1e-3, 2e-3), rel=1e-3)
    assert judged.usable == (1e-4, 1e-1)
    assert judged.verdict.status is Status.AGREES
    assert "with steps from 1e-04 to 1e-01" in judged.verdict.text


def test_a_step_that_is_right_by_chance_makes_no_derivative_right() -> None:
    # an error that crosses zero, and two differences of zero
    judged = differences({1e-1: 0.5, 1e-2: 1e-6, 1e-3: 0.3, 1e-4: 0.28, 1e-5: -1.0, 1e-6: -1.0})
    assert judged.best == pytest.approx((1e-2, 1e-6), rel=1e-3)
    assert judged.usable is None
    assert judged.settled == pytest.approx((1e-3, 0.3), rel=1e-3)
    assert judged.verdict.status is Status.DEVIATES
    assert judged.verdict.text.startswith("wrong, off by 30 %")


def test_steps_that_are_right_are_told_without_a_hole() -> None:
    judged = differences({1e-1: 1e-3, 1e-2: 1e-3, 1e-3: 0.5, 1e-4: 1e-3, 1e-5: 1e-3, 1e-6: 1e-3})
    assert judged.usable == (1e-6, 1e-4)


def test_a_wrong_sign_is_told() -> None:
    judged = differences(dict.fromkeys(STEPS, -3.0))
    assert judged.verdict.status is Status.DEVIATES
    assert judged.verdict.text.startswith("wrong sign, off by 3e+02 %")
    assert judge(0.0099, wrong_sign=False).status is Status.AGREES
    assert judge(0.0101, wrong_sign=False).text.startswith("near")
    assert judge(0.11, wrong_sign=False).text.startswith("wrong")


def test_what_has_no_number_is_not_judged_and_says_why() -> None:
    none = Differences(
        base=Case(scene=load("gentle-rock"), engine="mujoco", timestep=1e-3),
        key="release.psi_dot",
        quantity="peak_friction_ratio",
        exact=None,
        size=1.0,
        values=dict.fromkeys(STEPS, 1.0),
        why="the plane would have to pull",
    )
    assert none.verdict.status is Status.NOT_JUDGED
    assert str(none.verdict) == "not judged: the plane would have to pull"
    assert (none.best, none.parts, none.short, none.long) == (None, None, None, None)
    own = OwnDerivative(
        base=none.base,
        settings="",
        key=none.key,
        quantity=none.quantity,
        step="program",
        value=None,
        exact=1.0,
        scale=1.0,
        why="a root of zero",
    )
    assert own.error is None
    assert str(own.verdict) == "not judged: a root of zero"


def test_a_derivative_next_to_nothing_is_compared_with_quantity_over_key() -> None:
    judged = differences(dict.fromkeys(STEPS, 0.5), exact=1e-5)
    assert judged.insensitive
    assert "of quantity over key" in judged.verdict.text
    assert not differences(dict.fromkeys(STEPS, 0.5)).insensitive


def test_without_a_step_there_is_no_derivative() -> None:
    lost = differences({})
    assert lost.verdict.status is Status.NOT_JUDGED
    assert lost.parts is None
    assert lost.settled is None
