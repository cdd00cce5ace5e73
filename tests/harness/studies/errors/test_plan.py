"""What is run to tell the errors apart."""

from dataclasses import replace
from itertools import pairwise

import pytest

from harness.core.errors import InvalidSettingError
from harness.studies.errors.plan import plan_errors
from models import Compliance, Effects, Scene, Slip, load


def test_a_setting_tied_to_the_timestep_makes_two_ways(gentle: Scene) -> None:
    chosen = plan_errors(gentle, "mujoco")
    assert [way.options for way in chosen.ways] == [(), (("solref", (0.02, 1.0)),)]
    assert len(plan_errors(gentle, "pybullet").ways) == 1
    assert len(plan_errors(gentle, "mujoco", "default").ways) == 1
    held = plan_errors(gentle, "mujoco", options=(("solref", (0.005, 1.0)),))
    assert [way.name for way in held.ways] == ["matched with solref 0.005, 1"]


def test_the_ladder_halves_and_resolves_the_bounce(gentle: Scene) -> None:
    steps = plan_errors(gentle, "mujoco").rungs
    assert [coarse / fine for coarse, fine in pairwise(steps)] == [2.0] * 4
    assert steps[0] == 1e-4
    assert plan_errors(load("paper-release"), "mujoco").rungs[0] == pytest.approx(
        1.7e-6, rel=1e-9, abs=0
    )
    assert plan_errors(gentle, "mujoco", timestep=4e-4).rungs[0] == 4e-4


def test_ladders_are_run_with_the_solver_converged(gentle: Scene) -> None:
    chosen = plan_errors(gentle, "pybullet", options=(("contactERP", 0.2),))
    way = chosen.ways[0]
    options = dict(chosen.on_ladder(way, chosen.rungs[0]).options)
    assert options == {"contactERP": 0.2} | dict(chosen.efforts[-1].settings)
    assert dict(chosen.tried(way, None).options) == {"contactERP": 0.2}
    assert chosen.tried(way, chosen.efforts[-1]) == chosen.on_ladder(way, chosen.probe)
    cases = chosen.cases()
    assert len(set(cases)) == len(cases)


def test_what_has_no_limit_is_refused(gentle: Scene) -> None:
    sunk = replace(gentle, release=replace(gentle.release, height=-1e-3))
    for scene, name_of_engine, profile, name, value in (
        (gentle, "mujoco", "adaptive", "--profile", "adaptive"),
        (gentle, "reference", "matched", "--engine", "reference"),
        (sunk, "mujoco", "matched", "SCENE", gentle.name),
    ):
        with pytest.raises(InvalidSettingError) as caught:
            plan_errors(scene, name_of_engine, profile)
        assert (caught.value.name, caught.value.value) == (name, value)


def test_a_scene_that_slips_has_a_ladder(gentle: Scene) -> None:
    slipping = replace(gentle, effects=Effects(slip=Slip(mu=0.3)))
    assert {one.scene.effects for one in plan_errors(slipping, "mujoco").cases()} == {
        slipping.effects
    }


def test_what_a_declared_contact_gives_way_by_is_told_apart(gentle: Scene) -> None:
    soft = replace(gentle, effects=Effects(compliance=Compliance(stiffness=1e4, damping=10.0)))
    plan = plan_errors(soft, "mujoco")
    assert len(plan.ways) == 1
    assert plan.rigid is not None
    assert plan.rigid.scene == gentle
    assert plan.rigid in plan.cases()
    assert plan_errors(gentle, "mujoco").rigid is None
