"""Real runs: an unchanged engine raises no alarm, a worsened one is caught and named."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import pytest

from harness.core.case import Case, Value
from harness.evaluation.run_cases import run_cases
from harness.execution.isolated_pool import SerialExecutor
from harness.gate.comparison import Difference, differences
from harness.gate.report import GATE, regressions, sentences
from harness.gate.spread import MOST, SIZES, measured, member
from harness.results.result import Result
from harness.results.scores import Score, scored
from models import load
from tests.support.examples import examples
from tests.support.gate_scores import make_scores

Held = Callable[[Sequence[Case]], tuple[Difference, ...]]

REPEATS = 10


def gathered(own: Sequence[Score]) -> Result:
    """Return scores as a run of a suite has them."""
    return make_scores(*own, suite="coarse")


@pytest.fixture(scope="module")
def coarse() -> tuple[Case, ...]:
    """Return cases that cost little and amplify much, one of them too coarse for its bounce."""
    return tuple(
        Case(scene=load(scene), engine=engine, profile=profile, timestep=timestep)
        for scene, profile, timestep in (
            ("gentle-rock", "matched", 1e-3),
            ("paper-release", "default", None),
        )
        for engine in ("mujoco", "pybullet")
    )


@pytest.fixture(scope="module")
def accepted(coarse: tuple[Case, ...]) -> Result:
    """Return the coarse cases with their spread."""
    return gathered(measured(coarse, scored(coarse, run_cases(coarse)), SerialExecutor()))


@pytest.fixture
def held(accepted: Result, coarse: tuple[Case, ...]) -> Held:
    """Return a function that runs cases and holds them against the accepted ones."""

    def hold(cases: Sequence[Case]) -> tuple[Difference, ...]:
        return differences(accepted, gathered(scored(coarse, run_cases(cases))))

    return hold


@pytest.mark.slow
def test_a_repeat_is_equal_to_the_last_bit(
    accepted: Result, held: Held, coarse: tuple[Case, ...]
) -> None:
    for _ in range(examples(REPEATS / 100)):
        found = held(coarse)
        assert regressions(found) == ()
        judged = [one for one in found if one.quantity not in {"wall_s", "cpu_s"}]
        assert all(one.first == one.second for one in judged)
    assert {one.identity for one in found} == set(accepted.scores)


@pytest.mark.slow
def test_what_no_one_can_tell_apart_raises_no_alarm(held: Held, coarse: tuple[Case, ...]) -> None:
    for number in range(MOST, MOST + REPEATS):  # none of them among the members that were measured
        found = held([member(case, number) for case in coarse])
        assert regressions(found) == (), number


@pytest.mark.slow
def test_the_spread_is_that_of_an_amplifier(accepted: Result) -> None:
    # a run that follows its bounce passes a perturbation on; one that steps over it scrambles it
    for one in accepted.scores.values():
        phi, spread = one.values["phi_rms_rad"], one.spread["phi_rms_rad"]
        assert spread is not None
        if one.identity.scene == "gentle-rock":
            assert spread < 1e3 * max(SIZES) * phi
        assert one.members == MOST


@pytest.mark.slow
@pytest.mark.parametrize(
    "worsened",
    [
        ("mujoco", "impratio", 1.0, "phi_rms_rad"),
        ("mujoco", "iterations", 2, "phi_rms_rad"),
        ("pybullet", "contactERP", 0.02, "phi_rms_rad"),
        ("pybullet", "numSolverIterations", 1, "max_slip_m_s"),
    ],
)
def test_a_worsened_engine_is_caught_and_named(
    worsened: tuple[str, str, Value, str], held: Held, accepted: Result, coarse: tuple[Case, ...]
) -> None:
    engine, setting, value, quantity = worsened
    worse = [
        replace(case, options=((setting, value),)) if case.engine == engine else case
        for case in coarse
    ]
    found = held(worse)
    caught = regressions(found)
    assert quantity in {one.quantity for one in caught}
    assert {one.identity.engine for one in caught} == {engine}
    text = " ".join(sentences(found, accepted, accepted, GATE))
    assert f"Worse: gentle-rock in {engine} (matched, 0.001 s)" in text
