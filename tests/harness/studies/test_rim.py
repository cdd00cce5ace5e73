"""The study under the rim: a record for each collider, told in a table, a map and JSON."""

import json
import re
from pathlib import Path
from typing import Any

import pytest

from harness.core.errors import InvalidSettingError
from harness.core.report_model import Figure, Prose, Table
from harness.core.verdict import Status
from harness.engines.base import features_of
from harness.engines.probes import rim_contact
from harness.engines.registry import engine
from harness.execution.worker import Loss, LostTaskError
from harness.studies.comparison.rim import PROBING, RimStudy
from harness.studies.study import Results, run_study
from tests.support.command_line import Command

STUDY = RimStudy(engines=("mujoco",))


@pytest.fixture(scope="module")
def done() -> Results:
    """Return the results of every collider of MuJoCo."""
    return run_study(STUDY)


def artefacts(study: RimStudy, done: Results) -> tuple[Prose, Figure, Table]:
    """Return what a report has of the study."""
    words, figure, table = study.report(done)
    assert isinstance(words, Prose)
    assert isinstance(figure, Figure)
    assert isinstance(table, Table)
    return words, figure, table


def test_every_collider_is_a_row_of_the_map_and_of_the_table(done: Results) -> None:
    _, figure, table = artefacts(STUDY, done)
    colliders = [each.name for each in features_of(engine("mujoco")).colliders]
    (panel,) = figure.panels
    assert panel.y_names == tuple(reversed(colliders))
    assert panel.heat is not None
    assert panel.heat.z.shape == (len(colliders), len(panel.heat.x) - 1)
    assert list(dict.fromkeys(table.frame["variant"])) == colliders


def test_the_first_finding_is_told_in_words(done: Results) -> None:
    words, _, table = artefacts(STUDY, done)
    assert table.frame["finding"][0] in words.text


def test_json_has_rows_and_findings_by_variant(done: Results) -> None:
    answer: dict[str, Any] = json.loads(json.dumps(dict(STUDY.answer(done))))
    assert set(answer) == {"engine", "version", "rows", "findings"}
    assert set(answer["rows"][0]) == {
        *("variant", "tilt_rad", "count", "place_error_m", "depth_error_m"),
        *("normal_error_rad", "verdict"),
    }
    finding = {"variant", "kind", "sentence", "below_tilt_rad", "place_error_m"}
    assert {frozenset(each) for each in answer["findings"]} == {frozenset(finding)}
    verdicts = {row["verdict"] for row in answer["rows"]}
    assert {"at the rim", "off the rim", "lost at some turns"} <= verdicts


def test_settings_make_one_collider(done: Results) -> None:
    study = RimStudy(engines=("mujoco",), settings={"mujoco": {"shapes": "mesh-plane"}})
    (job,) = study.next_jobs(done)
    assert job.task.options == (("shapes", "mesh-plane"),)
    assert set(artefacts(study, run_study(study))[2].frame["variant"]) == {"shapes=mesh-plane"}


def test_settings_of_no_collider_are_on_top_of_every_one() -> None:
    study = RimStudy(engines=("mujoco",), settings={"mujoco": {"cone": "pyramidal"}})
    options = [dict(job.task.options) for job in study.next_jobs(Results())]
    assert [each["cone"] for each in options] == ["pyramidal"] * len(options)
    assert len(options) == len(features_of(engine("mujoco")).colliders)


def test_a_setting_that_the_engine_does_not_have_is_refused_before_anything_runs() -> None:
    study = RimStudy(engines=("mujoco",), settings={"mujoco": {"shapes": "a ball"}})
    with pytest.raises(InvalidSettingError, match="mesh-plane"):
        run_study(study)


@pytest.mark.engine("pybullet")
def test_a_collider_without_findings_agrees() -> None:
    study = RimStudy(engines=("pybullet",), settings={"pybullet": {"collisionMargin": 0.0}})
    _, _, table = artefacts(study, run_study(study))
    assert [verdict.status for verdict in table.frame["verdict"]] == [Status.AGREES]


def test_a_question_that_the_engine_does_not_survive_is_a_finding(done: Results) -> None:
    first, *rest = (job.task for job in STUDY.next_jobs(done))
    crash = PROBING.lost(first, LostTaskError(Loss.CRASHED, "killed: SIGSEGV, segmentation fault"))
    broken = Results({PROBING: {**done.of(PROBING), first: crash}})
    words, figure, table = artefacts(STUDY, broken)
    assert "does not survive the question: killed: SIGSEGV" in words.text
    assert table.frame["verdict"][0].status is Status.DEVIATES
    (panel,) = figure.panels
    assert len(panel.y_names) == len(rest)


def test_a_collider_that_raises_is_a_finding(monkeypatch: pytest.MonkeyPatch) -> None:
    def asked(_: object) -> None:
        message = "mujoco has no answer"
        raise RuntimeError(message)

    monkeypatch.setattr(rim_contact, "collision", asked)
    study = RimStudy(engines=("mujoco",), settings={"mujoco": {"shapes": "mesh-plane"}})
    words, figure, table = artefacts(study, run_study(study))
    said = "does not survive the question: `collision` raised RuntimeError: mujoco has no answer"
    assert said in table.frame["finding"][0]
    assert "The rim is seen: nowhere" in words.text
    assert figure.panels == ()


def test_an_error_of_the_machine_is_no_finding(monkeypatch: pytest.MonkeyPatch) -> None:
    def asked(_: object) -> None:
        raise MemoryError

    monkeypatch.setattr(rim_contact, "collision", asked)
    study = RimStudy(engines=("mujoco",), settings={"mujoco": {"shapes": "mesh-plane"}})
    with pytest.raises(MemoryError):
        run_study(study)


def test_engines_without_contacts_are_left_out_of_many() -> None:
    study = RimStudy(engines=("mujoco", "reference"))
    assert {job.task.engine for job in study.next_jobs(Results())} == {"mujoco"}


@pytest.mark.slow
def test_every_report_has_what_is_kept_and_asks_nothing(
    rockingcan: Command, tmp_path: Path
) -> None:
    store = ("--store", str(tmp_path / "kept"), "--jobs", "1")
    errors = ("errors", "gentle-rock", "--engine", "mujoco", "--timestep", "1e-3", *store)
    assert rockingcan(*errors, "--out", str(tmp_path / "before")).code == 0
    assert not (tmp_path / "before" / "tables" / "rim-findings.csv").exists()
    assert rockingcan("probe", "mujoco", *store).code == 0
    assert rockingcan(*errors, "--out", str(tmp_path / "after")).code == 0
    assert (tmp_path / "after" / "tables" / "rim-findings.csv").exists()


def test_the_smallest_tilt_at_which_the_rim_is_seen_is_told(done: Results) -> None:
    words, _, _ = artefacts(STUDY, done)
    assert re.search(
        r"The rim is seen: cylinder-plane from \d\.\de-0[78] rad on; mesh-plane at no tilt, or not",
        words.text,
    )
