"""Runs of both engines: where they end, what they are refused, and how they fail."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from harness.core.case import Case, Value
from harness.core.errors import (
    InvalidSettingError,
    RefusedModelError,
    UnknownSettingError,
    UnsupportedEffectError,
)
from harness.core.simulation import Outcome
from harness.engines.registry import description_of, engine
from harness.evaluation.evaluate import evaluate
from models import Can, Effects, Horizon, RoundedRim, Scene, load
from tests.support.engines import CONTACTS, DOUBLE, STEPPING, stepping_engine
from tests.support.evaluations import evaluated
from tests.support.trajectories import path_of

ENGINES = STEPPING
ALL = (*STEPPING, "reference")
EPS = np.finfo(np.float64).eps


@pytest.mark.parametrize("name", ENGINES)
@pytest.mark.parametrize(
    ("timestep", "seconds"), [(1e-3, 0.02), (1e-4, 0.0123), (1.0 / 3000.0, 0.01), (1e-3, 1.4e-3)]
)
def test_a_horizon_in_seconds_ends_at_the_last_whole_step(
    brief: Scene, name: str, timestep: float, seconds: float
) -> None:
    scene = replace(brief, horizon=Horizon(seconds=seconds))
    s = engine(name).simulate(Case(scene=scene, engine=name, timestep=timestep))
    assert s.outcome is Outcome.FINISHED
    assert s.trajectory is not None
    whole = int(seconds / timestep * (1.0 + 4 * EPS))
    assert s.trajectory.time[0] == 0.0
    assert s.trajectory.time[-1] == whole * timestep
    assert seconds - timestep < s.trajectory.time[-1] <= seconds * (1.0 + 4 * EPS)
    assert s.steps == whole + 1  # the state at each end, each with the contact solved in it


@pytest.mark.parametrize("name", ENGINES)
def test_samples_lie_on_the_grid_of_the_engine(gentle: Scene, name: str) -> None:
    s = evaluated(gentle, name, 1e-4).simulation
    assert s.trajectory is not None
    steps = np.rint(s.trajectory.time / 1e-4)
    np.testing.assert_array_equal(s.trajectory.time, steps * 1e-4)  # counted, so no drift at all
    assert len(s.trajectory) < s.steps
    assert (s.timestep, s.model, s.outcome) == (1e-4, name, Outcome.FINISHED)
    assert s.constraint_rows > 0
    assert s.settings == stepping_engine(name).resolve(s.case)


@pytest.mark.parametrize("name", ENGINES)
def test_a_horizon_in_bounces_ends_just_past_the_maximum_that_closes_the_last(
    gentle: Scene, name: str
) -> None:
    e = evaluated(gentle, name, 1e-4)
    assert e.motion is not None
    assert len(e.bounces) == 1
    phi = e.motion.angles.phi
    last = e.motion.time[-1]
    assert e.bounces[0].end < last
    # seen once phi has fallen by 1 % of the largest, which from rest takes a fraction of sqrt(R/g)
    peak = phi[int(phi.argmin()) :].max()  # of the rise: an engine may have lost energy
    assert peak - phi[-1] == pytest.approx(0.01 * phi.max(), rel=0.1)


@pytest.mark.parametrize("name", [name for name in CONTACTS if name in DOUBLE])
def test_a_timestep_longer_than_the_run_leaves_the_release(brief: Scene, name: str) -> None:
    e = evaluate(Case(scene=brief, engine=name, timestep=0.05))
    assert e.simulation.trajectory is not None
    assert len(e.simulation.trajectory) == 1
    assert e.bounces == ()
    assert e.errors is not None
    # one sample of zero duration, lowered by the static penetration: angles are exact
    assert e.errors.phi_rms < 8 * description_of(name).precision.epsilon


@pytest.mark.parametrize("name", ENGINES)
def test_without_gravity_the_can_flies_and_nothing_breaks(brief: Scene, name: str) -> None:
    e = evaluate(Case(scene=replace(brief, gravity=0.0), engine=name, timestep=1e-3))
    assert e.simulation.outcome is Outcome.FINISHED
    assert e.energy_drift is None
    assert e.errors is None


def test_without_gravity_the_reference_has_no_solution(brief: Scene) -> None:
    e = evaluate(Case(scene=replace(brief, gravity=0.0), engine="reference"))
    assert e.simulation.outcome is Outcome.NO_SOLUTION
    assert "gravity" in e.simulation.note


@pytest.mark.parametrize("name", ENGINES)
def test_a_can_that_tips_over_has_overturned(gentle: Scene, name: str) -> None:
    release = replace(gentle.release, phi=1.2, psi_dot=0.0, theta_dot=0.0)
    e = evaluate(Case(scene=replace(gentle, release=release), engine=name, timestep=1e-3))
    assert e.simulation.outcome is Outcome.OVERTURNED
    assert e.motion is not None
    assert e.motion.angles.phi[-1] >= np.pi / 2.0
    assert e.bounces == ()


@pytest.mark.parametrize(
    ("name", "scene", "timestep", "options"),
    [
        # twice the stiffness that an explicit step bears, which refsafe would have softened
        ("mujoco", "gentle-rock", 1e-3, {"solref": (1e-4, 1.0), "refsafe": "disable"}),
        # gives back a millimetre of penetration in a few steps of microseconds
        ("pybullet", "start-in-penetration", 5e-6, {}),
    ],
)
def test_a_run_that_blows_up_has_diverged_and_leaves_nothing_behind(  # noqa: PLR0917 - columns
    name: str,
    scene: str,
    timestep: float,
    options: dict[str, Value],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    chosen = tuple(options.items())
    e = evaluate(Case(scene=load(scene), engine=name, timestep=timestep, options=chosen))
    assert e.simulation.outcome is Outcome.DIVERGED
    assert e.simulation.trajectory is not None
    assert abs(e.energy_drift or 0.0) > 1.0  # m g R: more than rolling ever has to give
    assert list(tmp_path.iterdir()) == []  # no log file of an engine


def test_a_stage_whose_time_stops_has_diverged() -> None:
    # MuJoCo's rollout warns, repeats its state to the end of the stage, and goes on in the next one
    run = evaluate(Case(scene=load("cusps"), engine="mujoco", profile="adaptive")).simulation
    assert run.outcome is Outcome.DIVERGED
    assert run.trajectory is not None
    assert (np.diff(run.trajectory.time) > 0.0).all()
    assert 0.0 < run.trajectory.time[-1] < 0.1


@pytest.mark.parametrize(
    ("name", "options"),
    [("mujoco", {"margin": 1e300}), ("pybullet", {"collisionMargin": 1e300})],
)
def test_numbers_that_break_in_the_probes_are_an_outcome_too(
    gentle: Scene,
    name: str,
    options: dict[str, Value],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    s = engine(name).simulate(Case(scene=gentle, engine=name, options=tuple(options.items())))
    assert s.outcome is Outcome.DIVERGED
    assert "probes" in s.note
    assert s.trajectory is None
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", CONTACTS)
def test_a_timestep_longer_than_the_time_allowed_is_no_bounce(gentle: Scene, name: str) -> None:
    e = evaluate(Case(scene=gentle, engine=name, timestep=1e3))
    # Pinocchio's contact looks a step ahead, and no height is out of its reach; of a fast spin
    # Newton keeps nothing in such a step
    if name in {"pinocchio", "newton"}:
        assert e.simulation.outcome is Outcome.MISMATCH
        return
    assert (e.simulation.outcome, e.simulation.steps) == (Outcome.TIMED_OUT, 1)
    assert len(path_of(e.simulation).time) == 1  # the release
    assert e.bounces == ()


@pytest.mark.parametrize("name", ENGINES)
def test_a_timestep_that_is_far_too_long_finishes_and_is_told_by_its_error(
    gentle: Scene, name: str
) -> None:
    fine, coarse = (
        evaluate(Case(scene=gentle, engine=name, timestep=timestep)) for timestep in (1e-3, 1e-2)
    )
    assert fine.errors is not None
    assert coarse.errors is not None
    assert coarse.simulation.outcome is Outcome.FINISHED
    # of first order at best: with ten times the timestep no less than five times the error
    assert coarse.errors.phi_rms > 4.0 * fine.errors.phi_rms > 0.0


@pytest.mark.parametrize("name", ENGINES)
@pytest.mark.parametrize("profile", ["matched", "adaptive"])
def test_a_timestep_whose_steps_nobody_counts_is_refused(
    brief: Scene, name: str, profile: str
) -> None:
    with pytest.raises(InvalidSettingError) as caught:
        engine(name).timestep(Case(scene=brief, engine=name, profile=profile, timestep=1e-300))
    assert (caught.value.name, caught.value.value) == ("timestep", 1e-300)
    assert caught.value.allowed.startswith("at least")


@pytest.mark.parametrize("name", ALL)
def test_an_unknown_setting_is_refused_with_those_there_are(brief: Scene, name: str) -> None:
    case = Case(scene=brief, engine=name, options=(("viscosity", 1.0),))
    with pytest.raises(UnknownSettingError) as caught:
        evaluate(case)
    assert (caught.value.engine, caught.value.name) == (name, "viscosity")
    assert caught.value.available == tuple(sorted(one.name for one in engine(name).settings))


@pytest.mark.parametrize(
    ("name", "setting", "value", "allowed"),
    [
        ("mujoco", "cone", "round", "pyramidal, elliptic"),
        ("mujoco", "integrator", 4, "Euler, RK4"),
        ("mujoco", "iterations", 2.5, "an integer"),
        ("mujoco", "iterations", -1, "zero or greater"),
        ("mujoco", "iterations", True, "an integer"),
        ("mujoco", "impratio", "high", "a finite number"),
        ("mujoco", "impratio", float("nan"), "a finite number"),
        ("mujoco", "impratio", None, "a finite number"),
        ("mujoco", "solref", 0.02, "2 numbers with commas"),
        ("mujoco", "solref", (0.02,), "2 numbers with commas"),
        ("pybullet", "URDF_USE_IMPLICIT_CYLINDER", 1, "true or false"),
        ("pybullet", "collisionMargin", "thin", "a finite number"),
        ("pybullet", "contactERP", float("inf"), "a finite number"),
        ("pybullet", "enableConeFriction", 0.5, "an integer"),
        ("reference", "rtol", "fine", "a finite number"),
        ("reference", "rtol", -1.0, "greater than 0 and less than 1"),
        ("reference", "model", "wishful", "auto, pendulum"),
        ("reference", "method", "Euler1768", "auto, half-period"),
    ],
)
def test_a_setting_of_the_wrong_kind_is_refused_with_what_is_allowed(
    brief: Scene, name: str, setting: str, value: Value, allowed: str
) -> None:
    with pytest.raises(InvalidSettingError) as caught:
        evaluate(Case(scene=brief, engine=name, options=((setting, value),)))
    assert caught.value.name == setting
    assert allowed in caught.value.allowed


def test_numbers_within_a_tuple_must_be_numbers(brief: Scene) -> None:
    for value in (("a", "b"), (float("nan"), 1.0)):
        case = Case(scene=brief, engine="mujoco", options=(("solref", value),))  # type: ignore[arg-type]
        with pytest.raises(InvalidSettingError) as caught:
            evaluate(case)
        assert caught.value.name == "solref"


def test_what_mujoco_does_not_compile_is_wrong_use_with_its_reason(brief: Scene) -> None:
    case = Case(scene=brief, engine="mujoco", options=(("condim", 2),))
    with pytest.raises(RefusedModelError) as caught:
        evaluate(case)
    assert caught.value.case == case.label()
    assert "invalid condim" in caught.value.reason  # the words of MuJoCo


def test_a_can_too_light_for_mujoco_is_wrong_use_with_its_reason(brief: Scene) -> None:
    dust = Can.from_groups(mass=1e-17, radius=0.037, a=0.727, c=0.615, h=1.473)
    with pytest.raises(RefusedModelError) as caught:
        engine("mujoco").simulate(Case(scene=replace(brief, can=dust), engine="mujoco"))
    assert "mass and inertia" in caught.value.reason  # the words of MuJoCo


@pytest.mark.parametrize("name", ENGINES)
def test_every_setting_can_be_set_to_what_it_is(brief: Scene, name: str) -> None:
    case = Case(scene=brief, engine=name, timestep=1e-3)
    chosen = stepping_engine(name).resolve(case)
    explicit = tuple((key, value) for key, value in chosen.items() if value is not None)
    plain = engine(name).simulate(case)
    spelt = engine(name).simulate(replace(case, options=explicit))
    assert plain.settings == spelt.settings
    assert plain.trajectory is not None
    assert spelt.trajectory is not None
    np.testing.assert_array_equal(plain.trajectory.position, spelt.trajectory.position)


def test_the_reference_takes_no_timestep(brief: Scene) -> None:
    with pytest.raises(InvalidSettingError) as caught:
        evaluate(Case(scene=brief, engine="reference", timestep=1e-3))
    assert (caught.value.name, caught.value.value) == ("timestep", 1e-3)
    assert caught.value.allowed.startswith("none at all")


@pytest.mark.engine("pybullet")
def test_an_effect_that_an_engine_cannot_represent_is_refused_naming_those_that_can(
    brief: Scene,
) -> None:
    rounded = replace(brief, effects=Effects(rim=RoundedRim(radius=1e-3)))
    with pytest.raises(UnsupportedEffectError) as caught:
        evaluate(Case(scene=rounded, engine="mujoco"))
    assert (caught.value.engine, caught.value.effect) == ("mujoco", "rim")
    assert caught.value.able == ("pybullet", "reference")


def test_as_shipped_means_that_nothing_is_written_into_the_model() -> None:
    scene = load("gentle-rock")
    found = stepping_engine("mujoco").open(Case(scene=scene, engine="mujoco", profile="default"))
    defaults = {setting.name: setting.default for setting in engine("mujoco").settings}
    option = found.model.opt
    assert (option.impratio, option.tolerance) == (defaults["impratio"], defaults["tolerance"])
    assert option.iterations == defaults["iterations"]
    assert option.noslip_iterations == defaults["noslip_iterations"]
    np.testing.assert_array_equal(found.model.geom_solref[0], defaults["solref"])
    np.testing.assert_array_equal(found.model.geom_solimp[0], defaults["solimp"])


def test_a_pyramidal_case_counts_the_rows_of_its_pyramid(brief: Scene) -> None:
    # elliptic: the normal and two tangents; pyramidal: two edges for each tangent
    elliptic = evaluated(brief, "mujoco", 1e-3).simulation
    pyramidal = evaluated(brief, "mujoco", 1e-3, cone="pyramidal").simulation
    assert elliptic.constraint_rows == 3 * elliptic.steps
    assert pyramidal.constraint_rows == 4 * pyramidal.steps
