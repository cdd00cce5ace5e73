"""Numbers that docstrings cite of extrapolation and of what is run, just inside and just outside.

They are written out here and not imported: whoever changes one in the code is told which sentence
no longer holds.
"""

import pytest

from harness.studies.errors.extrapolation import ExtrapolatedLimit, limit
from harness.studies.errors.plan import plan_errors
from harness.studies.shared.perturbation import departure, member, perturbed
from models import Scene

HALVED = (1.0, 0.5, 0.25)


def extrapolated(
    *values: float, steps: tuple[float, ...] = HALVED, noise: float = 0.0
) -> ExtrapolatedLimit:
    found = limit(steps, values, noise)
    assert found is not None
    return found


@pytest.mark.parametrize(("order", "counts"), [(0.251, True), (0.249, False)])
def test_an_order_is_a_quarter_at_least(order: float, *, counts: bool) -> None:
    values = [5.0 + step**order for step in HALVED]
    found = extrapolated(*values)
    assert found.order == (pytest.approx(order) if counts else None)
    # without an order the finest value is the limit, and the range of all is its uncertainty
    assert found.value == pytest.approx(5.0 if counts else values[-1])
    assert counts or found.uncertainty == pytest.approx(values[0] - values[-1])


@pytest.mark.parametrize(("times", "clear"), [(100.1, True), (99.9, False)])
def test_a_difference_is_clear_that_is_a_hundred_times_the_noise(
    times: float, *, clear: bool
) -> None:
    found = extrapolated(3.0 * times, times, 0.0, noise=1.0)
    assert (found.order is not None) is clear


@pytest.mark.parametrize(("off", "falls"), [(0.99e-9, True), (1.01e-9, False)])
def test_round_off_of_a_ratio_of_timesteps_is_a_billionth(off: float, *, falls: bool) -> None:
    steps = (1.0, 0.5, 0.25 / (1.0 + off))
    if falls:
        assert extrapolated(4.0, 2.0, 1.0, steps=steps).order == pytest.approx(1.0)
    else:
        with pytest.raises(ValueError, match="constant ratio"):
            limit(steps, (4.0, 2.0, 1.0))


def test_of_four_values_two_neighbouring_triples_have_an_order() -> None:
    steps = (*HALVED, 0.125)
    # the finest three shrink by luck, after a jump
    lucky = extrapolated(1.0, 4.0, 2.0, 1.0, steps=steps)
    assert (lucky.order, lucky.value) == (None, 1.0)
    assert lucky.uncertainty == pytest.approx(3.0)
    both = extrapolated(8.0, 4.0, 2.0, 1.0, steps=steps)
    assert both.order == pytest.approx(1.0)
    assert both.value == pytest.approx(0.0, abs=1e-12)


def test_solver_and_ensemble_are_looked_at_on_the_middle_of_five_rungs(gentle: Scene) -> None:
    plan = plan_errors(gentle, "mujoco")
    assert len(plan.rungs) == 5
    assert plan.probe == plan.rungs[0] / 4.0 == plan.rungs[2]


def test_the_ensemble_has_six_releases_of_each_size_from_1e_9_to_1e_6(gentle: Scene) -> None:
    cases = plan_errors(gentle, "mujoco").cases()
    others = {case.scene.name for case in cases} - {gentle.name}
    expected = {
        perturbed(gentle, size, number).name
        for size in (1e-9, 1e-8, 1e-7, 1e-6)
        for number in range(6)
    }
    assert others == expected


@pytest.mark.parametrize("number", range(1, 9))
def test_members_of_a_hard_case_differ_by_a_thousandth(gentle: Scene, number: int) -> None:
    other = member(gentle, number).release
    phi, psi, theta = departure(number)
    own = gentle.release
    assert other.psi_dot / own.psi_dot - 1.0 == pytest.approx(1e-3 * psi, rel=1e-9, abs=0)
    assert other.theta_dot / own.theta_dot - 1.0 == pytest.approx(1e-3 * theta, rel=1e-9, abs=0)
    # phi as far as it is from flat or from balance, whichever is nearer
    room = min(own.phi, gentle.can.balancing_angle - own.phi)
    assert other.phi - own.phi == pytest.approx(1e-3 * phi * room, rel=1e-9, abs=0)
    assert other.psi == own.psi + number
