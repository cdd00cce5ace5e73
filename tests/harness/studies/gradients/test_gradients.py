"""The study of gradients: exact derivatives, differences of runs, and an engine's own."""

from dataclasses import replace

import numpy as np
import pytest
from typer.testing import CliRunner

from harness.cli.commands import app
from harness.core.case import Case
from harness.core.errors import InvalidSettingError
from harness.core.report_model import Table
from harness.core.verdict import Status
from harness.engines.reference.truth import exact_motion
from harness.execution.worker import Loss, LostTaskError
from harness.metrics.bounces import bounces
from harness.metrics.motion import motion
from harness.metrics.quantities import QUANTITIES as REGISTRY
from harness.studies.gradients.derivatives import exact_derivatives, exact_numbers, own_derivatives
from harness.studies.gradients.design import (
    KEYS,
    QUANTITIES,
    SETTING_STEPS,
    SUITES,
    instants,
    keys_of,
    plan_gradients,
    setting_values,
    unit_of,
    value_of,
    with_setting,
)
from harness.studies.gradients.findings import AT_BOUND
from harness.studies.gradients.settings import SettingChange
from harness.studies.gradients.study import GradientsStudy
from harness.studies.study import Results, run_study
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


def test_what_samples_of_the_exact_motion_say_is_right_at_the_steps_of_an_engine(
    exact: dict[str, dict[str, float]],
) -> None:
    def sampled(key: str, change: float) -> dict[str, float | None]:
        scene = scene_at(GENTLE, {key: value_of(GENTLE, key) + change})
        run = exact_motion(scene)
        times = np.append(np.arange(0.0, run.ends - 1e-4, 3e-4), run.ends)
        (bounce,) = bounces(motion(run.at(times), scene), scene.can)
        return {quantity: REGISTRY[quantity].of_bounce(bounce) for quantity in QUANTITIES}

    for key in ("release.phi", "release.psi_dot", "release.theta_dot", "can.a", "can.h"):
        for relative in (1e-2, 1e-3, 1e-4):
            step = relative * unit_of(GENTLE, key)
            up, down = sampled(key, step), sampled(key, -step)
            for quantity in QUANTITIES:
                more, less = up[quantity], down[quantity]
                assert more is not None
                assert less is not None
                difference = (more - less) / (2.0 * step)
                assert difference == pytest.approx(exact[quantity][key], rel=1e-3), (key, quantity)


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


def test_steps_beyond_the_range_of_a_number_are_left_out() -> None:
    """Of a hoop `c` is near its bound, of a lamina at it, where no difference has two sides."""
    hoop = plan_gradients(load("hoop"), ("reference",), "quick")
    assert hoop.steps_of("can.h") == hoop.steps
    assert hoop.steps_of("can.c") == tuple(step for step in hoop.steps if step <= 1e-3)
    lamina = plan_gradients(load("lamina-moments"), ("reference",), "own")
    plan = replace(lamina, keys=("release.psi_dot", "can.c"))
    assert plan.steps_of("can.c") == ()
    study = GradientsStudy(plan=plan)
    done = run_study(study)
    verdicts = {each.key: each.verdict for each in study.differences(done)}
    assert verdicts["release.psi_dot"].status is Status.AGREES
    assert str(verdicts["can.c"]) == f"not judged: {AT_BOUND}"
    assert study.report(done)
    # the exponent of a linear spring is the least there is
    soft = plan_gradients(load("soft-rock"), ("reference",), "quick")
    assert soft.steps_of("effects.compliance.exponent") == ()


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
        f"gentle-rock-{part}"
        for part in ("gradients", "own", "settings", "timesteps", "differences")
    }
    settings = tables["gentle-rock-settings"].frame.set_index(["setting", "quantity"])
    assert {"timestep", "impratio", "solref[0]", "solimp[0]"} <= {
        name for name, _ in settings.index
    }
    # a timestep of 1 ms is felt in the turn, the accuracy of the solver is not
    decades = settings["per_decade"]
    assert abs(decades["tolerance", "angle_of_turn_deg"]) < 1e-6
    assert 1e-4 < abs(decades["timestep", "angle_of_turn_deg"]) < 0.1
    assert np.isfinite(tables["gentle-rock-gradients"].frame["relative_error"]).all()


def test_phi_of_a_chaotic_motion_has_an_exact_derivative_at_every_instant() -> None:
    scene = load("tilted-plane")
    times = instants(scene)
    assert list(times.values()) == pytest.approx([0.15, 0.3, 0.45, 0.6, 0.75, 0.9])
    slopes = exact_derivatives(Case(scene=scene, engine="reference"))["slopes"]
    for key in ("release.psi_dot", "effects.tilt.angle", "can.radius"):
        step = 1e-5 * unit_of(scene, key)
        up, down = (
            exact_numbers(scene_at(scene, {key: value_of(scene, key) + sign * step}))
            for sign in (1.0, -1.0)
        )
        for name in times:
            more, less = up[name], down[name]
            assert more is not None
            assert less is not None
            # the third derivative times the step squared, and the digits of the difference
            assert slopes[name][key] == pytest.approx((more - less) / (2.0 * step), rel=1e-6)


def test_a_chaotic_scene_is_followed_as_long_as_an_engine_can_follow_it() -> None:
    plan = plan_gradients(load("chaotic-can"), ("reference",), "quick")
    assert plan.chaotic
    # 0.43 s is the time of growth, and nine of them lie between 1e-5 and 0.1 rad
    assert plan.scene.horizon.seconds == pytest.approx(9.2 * 0.4258, rel=0.05)
    assert plan.keys == ("release.phi", "release.psi_dot", "release.theta_dot")
    assert not plan_gradients(GENTLE, ("reference",), "quick").chaotic
    assert not instants(GENTLE)


def test_numbers_among_settings_are_changed_one_by_one() -> None:
    base = Case(scene=GENTLE, engine="mujoco", timestep=1e-3, options=(("impratio", 100.0),))
    force = {"solref": (0.002, 1.0), "impratio": 100.0, "cone": "elliptic", "warmstart": True}
    assert setting_values(force) == {"solref[0]": 0.002, "solref[1]": 1.0, "impratio": 100.0}
    changed = with_setting(base, force, "solref[1]", 1.01)
    assert dict(changed.options) == {"impratio": 100.0, "solref": (0.002, 1.01)}
    assert dict(with_setting(base, force, "impratio", 0.5).options) == {"impratio": 50.0}
    assert with_setting(base, force, "timestep", 0.5).timestep == pytest.approx(5e-4)


def test_a_scene_moves_where_its_key_says() -> None:
    for key in SUITES["full"].keys:
        value = value_of(GENTLE, key)
        assert value_of(scene_at(GENTLE, {key: 1.01 * value}), key) == pytest.approx(1.01 * value)


def test_a_setting_is_told_by_a_percent_and_judged_where_its_steps_agree() -> None:
    def change(*values: float) -> SettingChange:
        return SettingChange(
            base=TRUTH,
            setting="timestep",
            quantity="period_s",
            value=1.0,
            size=2.0,
            values=dict(zip(SETTING_STEPS, values, strict=True)),
        )

    even = change(0.5, 0.6, 0.4)
    assert even.per_percent == pytest.approx(0.005)
    assert even.verdict.status is Status.DEVIATES
    # steps that see the jumps of a run agree on no derivative
    assert change(0.5, 0.6, 40.0).verdict.status is Status.NOT_JUDGED
    assert change(0.0, 0.6, 0.4).verdict.status is Status.NOT_JUDGED
    # unless there is next to none
    assert change(1e-6, -1e-3, 1e-4).verdict.status is Status.AGREES


def test_without_the_exact_task_the_report_says_why() -> None:
    study = GradientsStudy(plan=plan_gradients(GENTLE, ("reference",), "own"))
    lost = LostTaskError(Loss.STOPPED, "it was killed")
    done = Results()
    for job in study.next_jobs(done):
        done = done.joined(job.work, {job.task: job.work.lost(job.task, lost)})
    assert all(job in done for job in study.next_jobs(done))
    differences = study.differences(done)
    assert {str(each.verdict) for each in differences} == {f"not judged: {lost.reason}"}
    assert study.report(done)
