"""The comparison study: what it designs, and what it reads from real runs of two scenes."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest

from harness.core.report_model import Artefact, Figure, Prose, Table
from harness.engines.registry import missing_effects
from harness.evaluation.evaluation import Evaluation
from harness.studies.comparison.study import comparison_report
from harness.studies.comparison.suite import SUITES, suite_cases
from harness.studies.comparison.tables import results
from models import load, names
from models.catalogue import field_names
from tests.support.evaluations import evaluated
from tests.support.figures import assert_two_sentences

ENGINES = ("mujoco", "pybullet")
SCENES = ("gentle-rock", "steady-rolling")
Found = Mapping[str, Artefact]


@pytest.fixture(scope="module")
def runs() -> list[Evaluation]:
    """Return quick runs of a scene that bounces and of one that does not, and one that stops."""
    found = []
    for scene in SCENES:
        for name in ENGINES:
            found.append(evaluated(scene, name, None, "default"))
            found += [evaluated(scene, name, step) for step in (1e-3, 3e-4)]
    found.append(evaluated("gentle-rock", "pybullet", 1e-3, collisionMargin=0.001))
    return found


@pytest.fixture(scope="module")
def found(runs: list[Evaluation]) -> Found:
    """Return the artefacts by name."""
    artefacts = comparison_report(runs)
    named = {artefact.name: artefact for artefact in artefacts}
    assert len(named) == len(artefacts)
    return named


def figures(found: Found) -> list[Figure]:
    return [artefact for artefact in found.values() if isinstance(artefact, Figure)]


def tables(found: Found) -> list[Table]:
    return [artefact for artefact in found.values() if isinstance(artefact, Table)]


@pytest.mark.parametrize("suite", SUITES)
def test_a_suite_runs_every_scene_in_every_engine(suite: str) -> None:
    scenes = {name: load(name) for name in (field_names() if suite == "field" else names())}
    if suite == "quick":  # which leaves those with effects to the full one
        scenes = {name: one for name, one in scenes.items() if not one.effects.declared()}
    # a scene that no engine can represent is nothing to compare, and accepted results are of
    # rigid contacts that are kept: those that are not have a suite of their own
    scenes = {
        name: one
        for name, one in scenes.items()
        if (one.effects.restitution is None and one.effects.compliance is None)
        == (suite != "contact")
        and not missing_effects("pybullet", one)
    }
    assert set(SUITES[suite]) == set(scenes)
    cases = suite_cases(suite, ENGINES, scenes)
    assert len(set(cases)) == len(cases)
    for profile in ("default", "adaptive"):
        own = [case for case in cases if case.profile == profile]
        assert {(case.scene.name, case.engine) for case in own} == {
            (scene, engine) for scene in scenes for engine in ENGINES
        }
        assert len(own) == len(scenes) * len(ENGINES)
        assert all(case.timestep is None and case.options == () for case in own)
    matched = [case for case in cases if case.profile == "matched"]
    assert len(matched) == len(ENGINES) * sum(len(ladder) for ladder in SUITES[suite].values())
    for case in matched:
        assert case.timestep in SUITES[suite][case.scene.name]


@pytest.mark.parametrize("suite", SUITES)
def test_a_ladder_goes_down(suite: str) -> None:
    for ladder in SUITES[suite].values():
        assert list(ladder) == sorted(ladder, reverse=True)
        assert len(set(ladder)) == len(ladder)


def test_a_suite_of_one_engine_has_its_cases_only() -> None:
    scenes = {name: load(name) for name in names()}
    both, one = suite_cases("quick", ENGINES, scenes), suite_cases("quick", ("mujoco",), scenes)
    assert [case for case in both if case.engine == "mujoco"] == list(one)
    assert suite_cases("quick", (), scenes) == ()


def test_every_column_is_declared_and_described(found: Found) -> None:
    assert {table.name for table in tables(found)} >= {"results", "bounces", "parity", "orders"}
    for table in tables(found):
        assert list(table.frame.columns) == list(table.columns), table.name
        assert set(table.shown) <= set(table.columns)
        assert len(table.frame) > 0, table.name
        for column, meaning in table.columns.items():
            assert meaning.endswith("."), (table.name, column)


def test_numbers_with_a_unit_say_it_in_their_name(found: Found) -> None:
    units = ("_s", "_m", "_rad", "_deg", "_rad_s", "_m_s")
    # a row's own quantity has the unit of the value, and of what is allowed
    plain = {"steps", "constraint_rows", "bounce", "timesteps", "energy_drift", "declared", "found"}
    plain |= {"value", "allowed"}
    for table in tables(found):
        for column in table.frame.select_dtypes("number").columns:
            dimensionless = column in plain or any(
                word in column
                for word in ("ratio", "fraction", "order", "spread", "smallest_error")
            )
            assert dimensionless or column.endswith(units), (table.name, column)


def test_every_run_has_its_row(runs: list[Evaluation]) -> None:
    frame = results(runs).frame
    assert len(frame) == len(runs)
    row: Any
    for row, e in zip(frame.itertuples(), runs, strict=True):
        case = e.simulation.case
        assert (row.scene, row.engine, row.profile) == (case.scene.name, case.engine, case.profile)
        assert row.timestep_s == e.simulation.timestep
        assert row.command == case.command()
        assert row.digest == case.digest(e.simulation.engine_version)
        assert row.outcome.startswith(e.simulation.outcome.value)
        if e.errors is None:
            assert math.isnan(row.phi_rms_rad)
        else:
            assert row.phi_rms_rad == e.errors.phi_rms
    gentle = frame[(frame.scene == "gentle-rock") & (frame.profile == "matched")]
    finished = gentle[gentle.outcome.str.startswith("finished")]
    # truth: engine minus error, the same for all runs to the round-off of degrees
    true = finished.angle_of_turn_deg - finished.angle_of_turn_error_deg
    assert np.ptp(true) < 1e-10
    assert frame.digest.is_unique


def test_every_scene_has_its_figures(found: Found) -> None:
    for scene in SCENES:
        own = {figure.name for figure in figures(found) if figure.scene == scene}
        kinds = {"angles", "locus", "friction", "residuals", "convergence"}
        if scene == "gentle-rock":
            kinds.add("bounce")  # steady rolling has none
        assert {f"{scene}-{kind}" for kind in kinds} <= own
    for figure in figures(found):
        assert figure.panels, figure.name
        for panel in figure.panels:
            assert panel.series, (figure.name, panel.title)
            for series in panel.series:
                assert len(series.x) == len(series.y) > 0, (figure.name, series.label)
                assert len(series.hover) in {0, len(series.x)}
            assert "[" in panel.x_label
            assert "[" in panel.y_label


def test_figures_say_two_sentences(found: Found) -> None:
    assert_two_sentences(found.values())


def test_figures_hold_truth_and_both_engines(found: Found) -> None:
    for name in ("gentle-rock-angles", "gentle-rock-bounce", "steady-rolling-locus"):
        figure = found[name]
        assert isinstance(figure, Figure)
        for panel in figure.panels:
            assert {series.kind for series in panel.series} >= {"reference", *ENGINES}


def test_axes_that_are_logarithmic_hold_positive_numbers(found: Found) -> None:
    for figure in figures(found):
        for panel in figure.panels:
            for series in panel.series:
                for log, values in ((panel.log_x, series.x), (panel.log_y, series.y)):
                    known = values[np.isfinite(values)]
                    assert not log or (known > 0.0).all(), (figure.name, series.label)


def test_no_word_is_no_number(found: Found) -> None:
    texts = [a.text for a in found.values() if isinstance(a, Prose)]
    texts += [figure.seen for figure in figures(found)]
    texts += [figure.title for figure in figures(found)]
    for text in texts:
        assert text
        words = {word.strip(".,;:()").lower() for word in text.split()}
        assert words.isdisjoint({"nan", "inf", "-inf", "none", "null"}), text


def test_the_summary_tells_of_each_engine_and_of_the_run_that_stopped(found: Found) -> None:
    summary = found["summary"]
    assert isinstance(summary, Prose)
    for name in ENGINES:
        assert f"{name} as it ships" in summary.text
        assert f"{name} matched to the scene" in summary.text
    assert "mismatch" in summary.text


def test_a_mismatch_is_in_the_parity_table_once_for_each_quantity(found: Found) -> None:
    table = found["parity"]
    assert isinstance(table, Table)
    wrong = table.frame[table.frame.verdict == "mismatch"]
    assert sorted(wrong.quantity) == ["half height H", "radius R", "rim deviation"]
    mine = table.frame.query("scene == 'gentle-rock' and engine == 'mujoco'")
    assert not mine.duplicated(["profile", "quantity"]).any()  # one timestep stands for a ladder


def test_bounces_carry_the_truth_beside_them(found: Found) -> None:
    table = found["bounces"]
    assert isinstance(table, Table)
    frame = table.frame
    gentle, steady = (frame[frame.scene == scene] for scene in SCENES)
    assert len(gentle) == 6  # one for each run that was not stopped
    assert (gentle.bounce == 1).all()
    assert gentle.angle_of_turn_true_deg.nunique() == 1
    # what nods although it should roll steadily has no true bounce to be held against
    assert steady.angle_of_turn_true_deg.isna().all()


def test_orders_of_two_timesteps_are_the_slope_between_them(
    found: Found, runs: list[Evaluation]
) -> None:
    table = found["orders"]
    assert isinstance(table, Table)
    row = table.frame.query(
        "scene == 'gentle-rock' and engine == 'mujoco' and quantity == 'phi_rms_rad'"
    ).iloc[0]
    ladder = {
        e.simulation.timestep: e.errors.phi_rms
        for e in runs
        if e.simulation.case.engine == "mujoco"
        and e.simulation.case.profile == "matched"
        and e.simulation.case.scene.name == "gentle-rock"
        and e.errors is not None
    }
    slope = math.log(ladder[1e-3] / ladder[3e-4]) / math.log(1e-3 / 3e-4)
    assert row.observed_order == pytest.approx(slope, rel=1e-12, abs=0)
    assert row.timesteps == 2
    assert row.smallest_error == ladder[3e-4]


def test_nothing_but_failures_still_gives_tables_and_words(runs: list[Evaluation]) -> None:
    artefacts = comparison_report([runs[-1]])
    assert {a.name for a in artefacts if isinstance(a, Table)} >= {"results", "parity"}
    assert not [a for a in artefacts if isinstance(a, Figure)]
