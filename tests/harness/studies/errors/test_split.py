"""The three errors of toy engines whose model, order and solver are known."""

import math

import pytest

from harness.core.case import Case
from harness.studies.errors.extrapolation import limit
from harness.studies.errors.split import ErrorStatus, Split
from models import load

RATE, END = 1.0, 1.0
TRUE = math.exp(-RATE * END)
CASE = Case(scene=load("gentle-rock"), engine="mujoco")
STEPS = tuple(0.05 / 2.0**k for k in range(5))


def implicit_decay(step: float, rate: float, iterations: int | None) -> float:
    """Decay by implicit Euler, each step solved by fixed-point iterations, None for exactly."""
    y = 1.0
    for _ in range(round(END / step)):
        if iterations is None:
            y /= 1.0 + rate * step
        else:
            guess = y
            for _ in range(iterations):
                guess = y - rate * step * guess
            y = guess
    return y


def midpoint_decay(step: float, rate: float) -> float:
    return float((1.0 - rate * step + (rate * step) ** 2 / 2.0) ** round(END / step))


def split_of(rate: float, iterations: int | None, band: float | None = None) -> Split:
    probe = STEPS[2]
    return Split(
        case=CASE,
        way="tied",
        quantity="turn_deg",
        true=TRUE,
        value=implicit_decay(probe, rate, iterations),
        converged=implicit_decay(probe, rate, None),
        limit=limit(STEPS, [implicit_decay(step, rate, None) for step in STEPS]),
        band=band,
    )


@pytest.mark.parametrize("rate", [1.0, 1.01, 0.7])
@pytest.mark.parametrize("iterations", [1, 2, 4])
def test_each_error_is_found_and_they_sum_to_the_whole(rate: float, iterations: int) -> None:
    found = split_of(rate, iterations)
    assert found.limit is not None
    assert found.model_form is not None
    assert found.discretisation is not None
    assert found.solver is not None
    assert found.total is not None
    own, probe = math.exp(-rate * END), STEPS[2]
    assert abs(found.limit.value - own) <= found.limit.uncertainty
    assert abs(found.model_form - (own - TRUE)) <= found.limit.uncertainty
    exact = implicit_decay(probe, rate, None)
    assert abs(found.discretisation - (exact - own)) <= found.limit.uncertainty
    assert found.solver == implicit_decay(probe, rate, iterations) - exact
    assert found.limit.order == pytest.approx(1.0, abs=0.05)
    parts = found.model_form + found.discretisation + found.solver
    # three differences and two sums of numbers below one
    assert parts == pytest.approx(found.total, rel=0, abs=8 * math.ulp(1.0))


def test_a_fixed_point_short_of_iterations_is_the_solver_s_fault_alone() -> None:
    one, four = split_of(RATE, 1), split_of(RATE, 4)
    assert one.model_form == four.model_form
    assert one.discretisation == four.discretisation
    assert one.solver is not None
    assert four.solver is not None
    # each iteration takes away a factor of the step, 0.0125
    assert abs(four.solver) < 1e-5 * abs(one.solver)


def test_a_method_of_second_order_is_seen_as_one() -> None:
    found = limit(STEPS, [midpoint_decay(step, 1.2) for step in STEPS])
    assert found is not None
    assert abs(found.value - math.exp(-1.2)) <= found.uncertainty
    assert found.order == pytest.approx(2.0, abs=0.05)


def test_verdicts() -> None:
    assert split_of(1.0, None).verdict is ErrorStatus.NO_MODEL_ERROR
    assert split_of(0.7, None).verdict is ErrorStatus.MODEL_ERROR
    assert split_of(0.7, None, band=1.0).verdict is ErrorStatus.UNDECIDABLE
    lost = Split(
        case=CASE,
        way="tied",
        quantity="turn_deg",
        true=TRUE,
        value=None,
        converged=None,
        limit=None,
        band=None,
    )
    assert lost.verdict is ErrorStatus.UNKNOWN
    assert lost.total is None


def test_without_a_converged_solve_the_solver_s_share_is_not_known() -> None:
    found = Split(
        case=CASE,
        way="tied",
        quantity="turn_deg",
        true=1.0,
        value=1.5,
        converged=None,
        limit=limit(STEPS, [1.0] * 5),
        band=0.0,
    )
    assert found.solver is None
    assert found.discretisation is None
    assert found.total == 0.5
