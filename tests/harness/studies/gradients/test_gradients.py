"""The study of gradients: exact derivatives, differences of runs, and an engine's own."""

from dataclasses import replace

import numpy as np
import pytest
from typer.testing import CliRunner

from harness.cli.commands import app
from harness.core.case import Case
from harness.core.errors import InvalidSettingError
from harness.core.report_model import Table
from harness.studies.gradients.derivatives import exact_derivatives, exact_numbers, own_derivatives
from harness.studies.gradients.design import (
    KEYS,
    QUANTITIES,
    SUITES,
    keys_of,
    plan_gradients,
    unit_of,
    value_of,
)
from harness.studies.gradients.study import GradientsStudy
from harness.studies.study import run_study
from harness.sweep.parameters import scene_at
from models import Effects, Slip, load

GENTLE = load("gentle-rock")
TRUTH = Case(scene=GENTLE, engine="reference")


@pytest.fixture(scope="module")
def exact() -> dict[str, dict[str, float]]:
    slopes: dict[str, dict[str, float]] = exact_derivatives(TRUTH)["slopes"]
    return slopes


def test_exact_derivatives_are_those_of_the_exact_motion(
    exact: dict[str, dict[str, float]],
) -> None:
    for key in keys_of(GENTLE, KEYS):
        step = 1e-4 * unit_of(GENTLE, key)
        up, down = (
            exact_numbers(scene_at(GENTLE, {key: value_of(GENTLE, key) + sign * step}))
            for sign in (1.0, -1.0)
        )
        for quantity in QUANTITIES:
            more, less = up[quantity], down[quantity]
            assert more is not None
            assert less is not None
            difference = (more - less) / (2.0 * step)
            scale = abs(more) / unit_of(GENTLE, key)
            assert exact[quantity][key] == pytest.approx(difference, rel=1e-5, abs=1e-6 * scale)


def test_what_is_changed_is_changed_by_its_unit() -> None:
    plan = plan_gradients(GENTLE, ("reference", "mujoco"), "quick")
    base = plan.bases[-1]
    moved = plan.changed(base, "release.psi_dot", 1e-3).scene
    assert moved.release.psi_dot == pytest.approx(1.001 * GENTLE.release.psi_dot, rel=1e-15)
    assert moved.name != plan.changed(base, "release.psi_dot", -1e-3).scene.name
    still = replace(GENTLE, release=replace(GENTLE.release, theta_dot=0.0))
    assert unit_of(still, "release.theta_dot") == pytest.approx((9.81 / 0.037) ** 0.5, rel=0.1)
    assert "release.phi_dot" not in keys_of(GENTLE, SUITES["full"].keys)
    slipping = replace(GENTLE, effects=Effects(slip=Slip(mu=0.3)))
    assert keys_of(slipping, ()) == ("effects.slip.mu",)
    assert plan.steps == tuple(float(f"1e-{power}") for power in range(1, 10))


def test_a_scene_without_a_bounce_is_refused() -> None:
    with pytest.raises(InvalidSettingError):
        plan_gradients(load("steady-rolling"), ("reference",), "quick")
    refused = CliRunner().invoke(app, ["gradients", "gentle-rock", "--suite", "huge"])
    assert isinstance(refused.exception, InvalidSettingError)


@pytest.mark.engine("mujoco")
def test_own_derivatives_are_right_where_their_step_stays_inside_the_contact(
    exact: dict[str, dict[str, float]],
) -> None:
    case = Case(scene=GENTLE, engine="mujoco", timestep=1e-3)
    own = {entry["step"]: entry["values"] for entry in own_derivatives(case)["own"]}
    for key in ("release.phi", "release.psi_dot", "release.theta_dot"):
        true = exact["angle_of_turn_deg"][key]
        # the timestep leaves a percent or two
        assert own["1e-08"]["angle_of_turn_deg"][key] == pytest.approx(true, rel=0.03)
    assert own["1e-08"]["peak_friction_ratio"]["release.phi"] is None
    far = own["0.0001"]["angle_of_turn_deg"]["release.phi"]
    assert abs(far / exact["angle_of_turn_deg"]["release.phi"] - 1.0) > 1.0
    assert own_derivatives(TRUTH) == {"own": []}


@pytest.mark.engine("mujoco")
def test_the_study_finds_differences_of_both(monkeypatch: pytest.MonkeyPatch) -> None:
    tiny = replace(SUITES["quick"], keys=("release.psi_dot",), count=1)
    monkeypatch.setitem(SUITES, "quick", tiny)
    study = GradientsStudy(plan=plan_gradients(GENTLE, ("reference", "mujoco"), "quick"))
    done = run_study(study)
    turn = [d for d in study.differences(done) if d.quantity == "angle_of_turn_deg"]
    truth, engine, adaptive = turn
    assert adaptive.base.profile == "adaptive"
    assert adaptive.settled is not None
    assert truth.best is not None
    assert truth.best[1] < 1e-8
    assert truth.parts is not None
    assert 1e-7 < truth.parts.noise_below < 1e-3
    assert engine.settled is not None
    assert 1e-4 < engine.settled[1] < 0.05
    tables = {a.name: a for a in study.report(done) if isinstance(a, Table)}
    assert set(tables) == {
        f"gentle-rock-{part}" for part in ("gradients", "own", "timesteps", "differences")
    }
    assert np.isfinite(tables["gentle-rock-gradients"].frame["relative_error"]).all()


def test_a_scene_moves_where_its_key_says() -> None:
    for key in SUITES["full"].keys:
        value = value_of(GENTLE, key)
        assert value_of(scene_at(GENTLE, {key: 1.01 * value}), key) == pytest.approx(1.01 * value)
