"""The study end to end: integrators of the reference, and adaptive steps of an engine."""

import json
from dataclasses import replace
from pathlib import Path

import pytest
from typer.testing import CliRunner

from harness.cli.commands import app
from harness.core.case import Case
from harness.core.errors import InvalidSettingError
from harness.core.report_model import Table
from harness.studies.study import run_study
from harness.studies.tolerance.delivered import delivered
from harness.studies.tolerance.design import SUITES, knobs, usable_scenes
from harness.studies.tolerance.study import ToleranceStudy

TINY = replace(SUITES["quick"], scenes=("gentle-rock", "free-axial", "steady-rolling"), stride=5)


def test_integrators_follow_what_is_asked_of_them_or_work_to_round_off() -> None:
    study = ToleranceStudy(suite=TINY, engines=("reference",))
    done = run_study(study)
    by_name = {(each.knob.name, each.scene.name): each for each in study.ladders(done)}
    assert {scene for _, scene in by_name} == {"gentle-rock", "steady-rolling"}
    steps = by_name["scipy DOP853", "gentle-rock"]
    assert [asked for asked, _ in steps.known] == [1e-2, 1e-7, 1e-12]
    coarse, _, fine = (error for _, error in steps.known)
    assert 1e-5 < coarse < 1e-1
    assert fine < 1e-11
    own = by_name["half-period", "gentle-rock"]
    assert own.verdict.text.startswith("always to round-off")
    assert by_name["scipy DOP853", "steady-rolling"].measure == "largest error of phi"
    tables = {a.name: a for a in study.report(done) if isinstance(a, Table)}
    assert set(tables["settings"].frame["setting"]) == {name for name, _ in by_name}
    assert len(tables["delivered"].frame) == sum(len(e.records) for e in by_name.values())


def test_a_scene_without_an_exact_motion_is_left_out_with_its_reason() -> None:
    scenes, left_out = usable_scenes(TINY)
    assert [scene.name for scene in scenes] == ["gentle-rock", "steady-rolling"]
    assert left_out == {"free-axial": "it has no exact motion"}


def test_a_motion_that_ends_otherwise_has_no_error() -> None:
    scene = usable_scenes(replace(TINY, scenes=("epsilon-1e-24",)))[0][0]
    settings = (("model", "rolling"), ("method", "DOP853"), ("rtol", 1e-2))
    record = delivered(Case(scene=scene, engine="reference", options=settings))
    assert record["error"] is None
    assert record["reason"]


@pytest.mark.engine("mujoco")
def test_adaptive_steps_have_two_settings_and_the_error_is_that_of_the_turn() -> None:
    alone, together = (knob for knob in knobs(("mujoco",), TINY))
    scene = usable_scenes(TINY)[0][0]
    assert alone.case(scene, 0.01).timestep is None
    fine, coarse = (together.case(scene, eta).timestep for eta in (0.01, 0.1))
    assert fine is not None
    assert coarse == pytest.approx(10.0 * fine)
    values = alone.values(scene, TINY)
    assert values == tuple(sorted(values, reverse=True))
    record = delivered(alone.case(scene, values[0]))
    assert 0.0 < record["error"] < 1e-2


def test_the_command_prints_its_tables_and_refuses_another_suite(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(SUITES, "quick", replace(TINY, scenes=("gentle-rock",)))
    out = str(tmp_path / "report")
    words = ["tolerance", "--engine", "reference", "--jobs", "1", "--out", out]
    done = CliRunner().invoke(app, [*words, "--json"])
    assert done.exit_code == 0, done.output
    tables = json.loads(done.stdout)
    assert set(tables) == {"settings", "ladders", "delivered"}
    refused = CliRunner().invoke(app, ["tolerance", "--suite", "huge"])
    assert isinstance(refused.exception, InvalidSettingError)
