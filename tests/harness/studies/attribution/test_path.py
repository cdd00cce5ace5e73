"""The way from default to matched: what the engines declare, and that it leads there."""

from collections import Counter
from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import pytest

from harness.core.case import Case
from harness.core.errors import InvalidSettingError
from harness.engines.base import TIMESTEP, Engine, Setting, resolve
from harness.engines.registry import engine
from harness.studies.shared.ablation import ablation_path, all_gaps
from models import Effects, Scene, Slip

ENGINES = ("mujoco", "pybullet")


def in_force(chosen: Case) -> dict[str, Any]:
    found = engine(chosen.engine)
    return resolve(chosen, found.settings, found.timestep(chosen) or 0.0)


@pytest.mark.parametrize("name", ENGINES)
def test_all_gaps_closed_is_matched_setting_by_setting(name: str, gentle: Scene) -> None:
    way = ablation_path(gentle, name)
    named = {setting for gap in way.gaps for setting in gap.settings} - {TIMESTEP}
    built = Case(
        scene=gentle,
        engine=name,
        profile="default",
        timestep=way.matched_timestep,
        options=tuple(
            (s.name, s.matched(way.matched_timestep or 0.0) if callable(s.matched) else s.matched)
            for s in way.settings
            if s.name in named
        ),
    )
    matched = Case(scene=gentle, engine=name, profile="matched", timestep=way.matched_timestep)
    assert in_force(built) == in_force(matched)
    assert way.case(frozenset(way.names)) == matched


@pytest.mark.parametrize("name", ENGINES)
def test_an_engine_declares_each_difference_once_and_knows_each_name(name: str) -> None:
    chosen = engine(name)
    declared = [setting for gap in chosen.model_differences for setting in gap.settings]  # type: ignore[attr-defined]
    assert set(Counter(declared).values()) == {1}
    assert set(declared) <= {setting.name for setting in chosen.settings} | {TIMESTEP}
    assert all_gaps(chosen) == chosen.model_differences  # type: ignore[attr-defined]


@pytest.mark.parametrize("name", ENGINES)
def test_the_first_case_is_the_engine_as_it_ships(name: str, gentle: Scene) -> None:
    way = ablation_path(gentle, name)
    shipped = way.case(frozenset())
    assert shipped.profile == "default"
    assert shipped.options == ()
    assert shipped.timestep == engine(name).timestep(
        Case(scene=gentle, engine=name, profile="default")
    )


def test_each_place_closes_what_it_says(gentle: Scene) -> None:
    way = ablation_path(gentle, "mujoco")
    places = list(way.steps())
    assert len(places) == 1 + 3 * len(way.gaps)
    assert [len(stop.closed) for stop in places if stop.step == "in order"] == [1, 2, 3, 4]
    assert all(stop.closed == {stop.gap} for stop in places if stop.step == "alone")
    assert all(stop.gap not in stop.closed for stop in places if stop.step == "left open")
    # of 13 places, the first alone, the last left open and the end of the path are met twice
    assert len(way.cases()) == 11


def test_a_tied_setting_follows_the_timestep_in_force(gentle: Scene) -> None:
    way = ablation_path(gentle, "mujoco", 1e-5)
    long = dict(way.case(frozenset({"compliance"})).options)
    short = dict(way.case(frozenset({"compliance", "timestep"})).options)
    assert long["solref"] == (2.0 * (way.shipped_timestep or 0.0), 1.0)
    assert short["solref"] == (2e-5, 1.0)


def test_gaps_can_be_put_first(gentle: Scene) -> None:
    names = ablation_path(gentle, "mujoco", first=("timestep",)).names
    assert names == ("timestep", "compliance", "friction regularisation", "solver")
    with pytest.raises(InvalidSettingError) as caught:
        ablation_path(gentle, "mujoco", first=("softness",))
    assert "compliance" in caught.value.allowed


def test_what_has_no_truth_or_no_timestep_is_refused(gentle: Scene) -> None:
    sunk = replace(gentle, release=replace(gentle.release, height=-1e-3))
    for scene, name_of_engine, name, value in (
        (gentle, "reference", "--engine", "reference"),
        (sunk, "mujoco", "SCENE", gentle.name),
    ):
        with pytest.raises(InvalidSettingError) as caught:
            ablation_path(scene, name_of_engine)
        assert (caught.value.name, caught.value.value) == (name, value)


def test_a_scene_that_slips_has_a_way(gentle: Scene) -> None:
    slipping = replace(gentle, effects=Effects(slip=Slip(mu=0.3)))
    way = ablation_path(slipping, "mujoco")
    assert {case.scene for case in way.cases()} == {slipping}
    assert way.names == ablation_path(gentle, "mujoco").names


def test_an_engine_that_declares_no_gaps_has_one_for_each_difference() -> None:
    toy = SimpleNamespace(
        settings=(
            Setting(name="same", default=1, matched=1, meaning="Nothing."),
            Setting(name="other", default=1, matched=2, meaning="Something."),
            Setting(name="tied", default=0.1, matched=lambda step: step, meaning="Softness."),
        )
    )
    assert [gap.name for gap in all_gaps(cast("Engine", toy))] == ["other", "tied", "timestep"]
