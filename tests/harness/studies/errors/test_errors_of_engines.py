"""The three errors of the real engines on the gentle release."""

import math

import pytest

from harness.core.report_model import Figure, Prose, Table
from harness.studies.errors.plan import ThreeErrors, plan_errors
from harness.studies.errors.split import ErrorStatus
from harness.studies.errors.study import ErrorsStudy, errors_report
from harness.studies.study import run_study
from models import Horizon, Scene, load
from tests.support.figures import assert_two_sentences

# the coarsest step: long enough for a ladder of seconds, short enough for it to have begun to fall
COARSEST = 4e-4


def found_of(scene: Scene, engine: str, timestep: float | None = COARSEST) -> ThreeErrors:
    study = ErrorsStudy(plan=plan_errors(scene, engine, timestep=timestep))
    return study.findings(run_study(study))


EACH = pytest.mark.parametrize("name", ["mujoco", "pybullet"])
"""Engines; the errors of each are found once, in some six seconds."""


@pytest.fixture(scope="module")
def mujoco(gentle: Scene) -> ThreeErrors:
    return found_of(gentle, "mujoco")


@pytest.fixture(scope="module")
def pybullet(gentle: Scene) -> ThreeErrors:
    return found_of(gentle, "pybullet")


@pytest.mark.slow
def test_the_truth_is_within_the_limit_s_uncertainty(
    mujoco: ThreeErrors, pybullet: ThreeErrors
) -> None:
    for found in (mujoco, pybullet):
        split = found.splits[found.plan.ways[0].name, "bounce_time_s"]
        assert split.limit is not None
        assert split.verdict is ErrorStatus.NO_MODEL_ERROR
        assert split.limit.order == pytest.approx(1.0, abs=0.05)


@pytest.mark.slow
def test_a_soft_contact_converges_neatly_to_another_can(mujoco: ThreeErrors) -> None:
    split = mujoco.splits["solref held", "turn_deg"]
    assert split.limit is not None
    assert split.model_form is not None
    assert split.verdict is ErrorStatus.MODEL_ERROR
    assert abs(split.model_form) > 1.0
    assert split.limit.uncertainty < 0.01
    assert split.limit.order == pytest.approx(1.0, abs=0.05)


@pytest.mark.slow
@EACH
def test_the_three_sum_to_the_whole(name: str, request: pytest.FixtureRequest) -> None:
    found: ThreeErrors = request.getfixturevalue(name)
    for split in found.splits.values():
        parts = (split.model_form, split.discretisation, split.solver)
        assert None not in parts
        assert split.total is not None
        assert split.value is not None
        # differences and sums, each rounded at the size of the value
        ulps = 8 * math.ulp(abs(split.value))
        assert sum(part or 0.0 for part in parts) == pytest.approx(split.total, rel=0, abs=ulps)


@pytest.mark.slow
def test_engine_and_truth_follow_a_perturbed_release_alike(mujoco: ThreeErrors) -> None:
    for size in (1e-7, 1e-6):
        spread = mujoco.spreads["turn_deg", size]
        assert spread.of_engine is not None
        assert spread.of_truth is not None
        # gentle: the turn is a smooth function of the release, and so it grows with the size
        assert spread.of_engine == pytest.approx(spread.of_truth, rel=0.05)
        assert 10.0 * size < spread.of_truth < 100.0 * size


@pytest.mark.slow
def test_more_sweeps_leave_less_solver_error(pybullet: ThreeErrors) -> None:
    (table,) = (
        a for a in errors_report(pybullet) if isinstance(a, Table) and a.name.endswith("-efforts")
    )
    turn = table.frame[table.frame["quantity"] == "turn_deg"].set_index("effort")["off_converged"]
    sweeps = turn[["1 sweep", "2 sweeps", "5 sweeps", "10 sweeps"]].abs().tolist()
    assert sweeps == sorted(sweeps, reverse=True)
    assert turn["converged"] == 0.0
    assert abs(turn["as set"]) < 1e-3 * abs(turn["1 sweep"])


@pytest.mark.slow
@EACH
def test_artefacts_are_whole(name: str, request: pytest.FixtureRequest) -> None:
    found: ThreeErrors = request.getfixturevalue(name)
    artefacts = errors_report(found)
    names = [artefact.name for artefact in artefacts]
    assert len(set(names)) == len(names)
    assert_two_sentences(artefacts)
    for artefact in artefacts:
        if isinstance(artefact, Table):
            assert set(artefact.frame.columns) == set(artefact.columns)
        if isinstance(artefact, Figure):
            assert len(artefact.panels) == 4
        if isinstance(artefact, Prose):
            assert "nan" not in artefact.text.lower()
            assert "unknown" not in artefact.text


def test_a_scene_without_a_bounce_is_judged_by_its_end() -> None:
    scene = load("straight-rolling")
    chosen = plan_errors(
        Scene(
            name=scene.name,
            gravity=scene.gravity,
            can=scene.can,
            release=scene.release,
            horizon=Horizon(seconds=0.05),
        ),
        "mujoco",
        timestep=1e-3,
    )
    study = ErrorsStudy(plan=chosen)
    found = study.findings(run_study(study))
    assert {quantity for _, quantity in found.splits} == {"psi_end_deg", "phi_end_deg"}
    assert "no motion" not in " ".join(found.sentences)


@pytest.mark.slow
@pytest.mark.parametrize("engine", ["mujoco", "pybullet"])
def test_the_paper_s_release_has_no_model_error_when_matched(engine: str) -> None:
    found = found_of(load("paper-release"), engine, None)
    split = found.splits[found.plan.ways[0].name, "turn_deg"]
    assert split.limit is not None
    assert split.verdict is ErrorStatus.NO_MODEL_ERROR
    assert split.limit.uncertainty < 0.01  # deg: the issue's own measure of a good turn
