"""The study end to end: integrators of the reference, and adaptive steps of an engine."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from harness.cli.commands import app
from harness.core.case import Case
from harness.core.errors import InvalidSettingError
from harness.core.report_model import Table
from harness.core.simulation import Outcome
from harness.core.verdict import Status
from harness.evaluation.evaluation import Record
from harness.execution.worker import Loss, LostTaskError
from harness.studies.study import run_study
from harness.studies.tolerance.delivered import DELIVERING, delivered
from harness.studies.tolerance.design import SUITES, knobs, planned_ladder, usable_scenes
from harness.studies.tolerance.figures import ladder_figures
from harness.studies.tolerance.ladder import ToleranceLadder, by_setting
from harness.studies.tolerance.study import ToleranceStudy

TINY = replace(SUITES["quick"], scenes=("gentle-rock", "free-axial", "steady-rolling"), stride=5)


def ran(steps: int, error: float | None = 1e-6) -> Record:
    """Return the record of a run."""
    return {"steps": steps, "error": error, "ending": Outcome.FINISHED.value}


def test_integrators_follow_what_is_asked_of_them_or_work_to_round_off() -> None:
    study = ToleranceStudy(suite=TINY, engines=("reference",))
    done = run_study(study)
    by_name = {(each.knob.name, each.scene.name): each for each in study.ladders(done)}
    assert {scene for _, scene in by_name} == {"gentle-rock", "steady-rolling"}
    steps = by_name["scipy DOP853", "gentle-rock"]
    assert [asked for asked, _ in steps.known] == [1e-3, 1e-8, 1e-13]
    coarse, _, fine = (error for _, error in steps.known)
    assert 1e-6 < coarse < 1e-2
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


def test_a_finer_value_waits_for_the_coarser_and_is_left_out_if_steps_grow_too_much() -> None:
    suite = replace(TINY, stride=1, most_steps=1000.0)
    scene = usable_scenes(suite)[0][0]
    knob = next(knob for knob in knobs(("reference",), suite) if knob.name == "scipy RK45")
    ladder, records = planned_ladder(knob, scene, suite, {}), {}
    assert tuple(ladder.cases) == (1e-3, 1e-4, 1e-5, 1e-6)
    assert ladder.unpaid == ()
    taken = {1e-3: 100, 1e-4: 120, 1e-5: 150, 1e-6: 200, 1e-7: 400, 1e-8: 800}
    for added in (1e-7, 1e-8):  # 800 steps, if they double again
        records = {case: ran(taken[asked]) for asked, case in ladder.cases.items()}
        ladder = planned_ladder(knob, scene, suite, records)
        assert tuple(ladder.cases)[-1] == added
    records = {case: ran(taken[asked]) for asked, case in ladder.cases.items()}
    ladder = planned_ladder(knob, scene, suite, records)  # 1600 steps
    assert tuple(ladder.cases) == tuple(taken)
    assert ladder.unpaid == (1e-9, 1e-10, 1e-11, 1e-12, 1e-13)
    assert ladder.because == "too many steps are expected"


def test_after_a_run_that_lost_its_process_no_finer_value_runs_and_the_rows_say_why() -> None:
    suite = replace(TINY, stride=1)
    scene = usable_scenes(suite)[0][0]
    knob = next(knob for knob in knobs(("reference",), suite) if knob.name == "scipy RK45")
    first = planned_ladder(knob, scene, suite, {})
    records = {case: ran(100) for case in first.cases.values()}
    lost = first.cases[1e-5]
    records[lost] = DELIVERING.lost(lost, LostTaskError(Loss.HUNG, "it took too long"))
    ladder = planned_ladder(knob, scene, suite, records)
    assert tuple(ladder.cases) == (1e-3, 1e-4, 1e-5)
    assert ladder.unpaid == tuple(float(f"1e-{power}") for power in range(6, 14))
    assert ladder.because == "the run of a coarser value was lost with its process"


def test_steps_of_runs_that_fell_soon_do_not_tell_those_of_finer_values() -> None:
    suite = replace(TINY, stride=1, most_steps=1000.0)
    scene = usable_scenes(suite)[0][0]
    knob = next(knob for knob in knobs(("reference",), suite) if knob.name == "scipy RK45")
    cases = planned_ladder(knob, scene, suite, {}).cases
    # at 1e-4 and 1e-5 the can fell after a few steps: from there to 1e-6 they would grow tenfold
    steps = {1e-3: ran(600), 1e-4: ran(5, None), 1e-5: ran(5, None), 1e-6: ran(700)}
    records = {case: steps[asked] for asked, case in cases.items()}
    assert 1e-7 in planned_ladder(knob, scene, suite, records).cases


def test_a_setting_that_cannot_be_run_or_paid_for_has_a_row_with_the_reason() -> None:
    suite = replace(TINY, scenes=("gentle-rock", "friction-below"))
    study = ToleranceStudy(suite=suite, engines=("reference",))
    done = run_study(study)
    told = {(each.knob.name, each.scene.name): each.verdict for each in study.ladders(done)}
    assert told["half-period", "friction-below"].status is Status.NOT_MEASURED
    assert "the rolling equations leave out" in told["half-period", "friction-below"].text
    assert told["general equations", "friction-below"].text.startswith("always to round-off")
    scene = usable_scenes(suite)[0][0]
    knob = knobs(("reference",), suite)[0]
    unpaid = ToleranceLadder(
        knob=knob, scene=scene, measure="", floor=0.0, records={}, unpaid=(1e-3,)
    )
    assert unpaid.verdict.text == "not judged: no value can be paid for"
    rows = next(a for a in study.report(done) if isinstance(a, Table) and a.name == "ladders")
    assert len(rows.frame) == len(told)


def test_an_error_of_exactly_zero_is_drawn_and_marked() -> None:
    knob = knobs(("reference",), TINY)[0]
    records = {v: {"error": e, "reason": ""} for v, e in ((1e-3, 1e-4), (1e-4, 0.0), (1e-5, None))}
    one = ToleranceLadder(
        knob=knob, scene=usable_scenes(TINY)[0][0], measure="", floor=1e-12, records=records
    )
    (figure,) = ladder_figures(by_setting([one]))
    line, zeros, _ = figure.panels[0].series
    assert line.y[:2].tolist() == [1e-4, 2.0**-52]
    assert np.isnan(line.y[2])
    assert (zeros.label, zeros.x.tolist()) == ("exactly zero", [1e-4])


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
    values = alone.values(TINY)
    assert values == tuple(sorted(values, reverse=True))
    ladder = planned_ladder(alone, scene, TINY, {})
    assert (*ladder.cases, *ladder.unpaid) == values
    assert ladder.cases
    assert ladder.unpaid
    record = delivered(alone.case(scene, values[0]))
    assert 0.0 < record["error"] < 1e-2
    expected = alone.expected_steps(scene, values[0], ())
    assert expected / 2.0 < record["steps"] < 2.0 * expected


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
