"""The study of headings: one answer where nothing prefers a direction, and what has several."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from harness.core.report_model import Prose, Table
from harness.core.simulation import Outcome
from harness.core.verdict import Status
from harness.engines.probes.heading import HEADINGS, spread
from harness.evaluation.evaluation import Evaluation
from harness.studies.comparison.headings import HeadingStudy, headings
from harness.studies.study import EVALUATION, Results, run_study


@pytest.fixture(scope="module")
def done() -> Results:
    """Return the results of the study in MuJoCo."""
    return run_study(HeadingStudy(engines=("mujoco",)))


@pytest.fixture(scope="module")
def runs(done: Results) -> list[Evaluation]:
    """Return the matched runs at all headings."""
    every = done.of(EVALUATION).items()
    return [e for case, e in every if case.profile == "matched"]


def row(runs: list[Evaluation]) -> Mapping[Any, Any]:
    """Return the row of these runs."""
    (own,) = headings([runs]).frame.to_dict("records")
    return own


def test_an_engine_without_a_direction_has_one_answer_in_each_profile(done: Results) -> None:
    words, table = HeadingStudy(engines=("mujoco",)).report(done)
    assert isinstance(words, Prose)
    assert isinstance(table, Table)
    assert words.text.endswith("every engine has one answer.")
    assert table.frame["profile"].tolist() == ["default", "matched", "adaptive"]
    assert (table.frame["turn_spread_deg"] < 1e-3).all()
    assert {v.status for v in table.frame["turn_spread_deg_verdict"]} == {Status.AGREES}


def test_runs_start_at_the_five_headings(runs: list[Evaluation]) -> None:
    assert len(runs) == len(HEADINGS)
    assert [e.simulation.case.scene.release.psi for e in runs] == list(HEADINGS)


def test_an_answer_that_depends_on_the_heading_is_told(runs: list[Evaluation]) -> None:
    one, other, *rest = runs  # the two headings are 72 degrees apart
    found = row([other, one, *rest])
    assert found["turn_spread_deg"] == pytest.approx(144.0, abs=1e-3)
    assert found["turn_spread_deg_verdict"].status is Status.DEVIATES


def test_a_run_that_breaks_is_a_failure_and_no_agreement(runs: list[Evaluation]) -> None:
    lost = replace(runs[1].simulation, outcome=Outcome.DIVERGED, trajectory=None)
    found = row([runs[0], replace(runs[1], simulation=lost), *runs[2:]])
    assert str(found["turn_spread_deg_verdict"]) == "failed: diverged"
    assert np.isnan(found["turn_spread_deg"])


def test_without_a_motion_there_is_no_spread(runs: list[Evaluation]) -> None:
    paths = [e.simulation.trajectory for e in runs]
    assert spread(paths)[0] == pytest.approx(np.radians(row(runs)["turn_spread_deg"]))
    assert np.isnan(spread([None, *paths[1:]])).all()
