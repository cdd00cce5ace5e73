"""A report of `validate` is read as scores; what is none is refused with the reason."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pandas as pd
import pytest

from harness.core.case import Case
from harness.core.provenance import provenance
from harness.core.simulation import Outcome
from harness.report.atomic_folder import FORMAT, MANIFEST
from harness.results.errors import Fault, ResultsError
from harness.results.files import RESULTS, manifest_keys, read_scores
from harness.results.scores import Division
from models.catalogue import load

Report = Callable[..., Path]

DIGEST = "0123456789abcdef"

GENTLE = Case(scene=load("gentle-rock"), engine="mujoco", timestep=1e-3)


@pytest.fixture
def report(tmp_path: Path) -> Report:
    """Return a function that writes a report with one case, of which fields are replaced."""

    def write(*, results: bool = True, case: bool = True, **replaced: object) -> Path:
        record = manifest_keys(GENTLE, "quick", {"mujoco.impratio": "1"})
        entry = {
            "digest": DIGEST,
            "outcome": Outcome.FLAT.value,
            "engine_version": "4.0.0",
            **record,
        }
        row = {"digest": DIGEST, "truth_pulls": False, "turn_resolved": True}
        manifest = {
            "format": FORMAT,
            "cases": [entry] if case else [{"digest": DIGEST}],
            "provenance": provenance().to_dict() | {"rockingcan": "0.1.0"},
            **replaced,
        }
        (tmp_path / MANIFEST).write_text(json.dumps(manifest), encoding="utf-8")
        if results:
            (tmp_path / RESULTS).parent.mkdir()
            frame = pd.DataFrame([row | {"phi_rms_rad": 1e-3, "angle_of_turn_error_deg": 2.0}])
            frame.to_parquet(tmp_path / RESULTS)
        return tmp_path

    return write


def test_a_report_is_read_as_the_scores_of_its_cases(report: Report) -> None:
    scores = read_scores(report())
    (score,) = scores.scores.values()
    assert (score.identity.scene, score.identity.engine) == ("gentle-rock", "mujoco")
    assert (score.outcome, score.digest, score.truth_pulls) == (Outcome.FLAT.name, DIGEST, False)
    assert dict(score.values) == {"phi_rms_rad": 1e-3, "angle_of_turn_error_deg": 2.0}
    assert scores.versions == {"rockingcan": "0.1.0", "mujoco": "4.0.0"}
    assert scores.settings == {"mujoco.impratio": "1"}
    assert scores.suite == "quick"
    assert score.division is Division.OPEN


@pytest.mark.parametrize(
    ("wrong", "fault"),
    [
        ({"format": "another"}, Fault.FOREIGN_REPORT),
        ({"results": False}, Fault.OTHER_REPORT),
        ({"case": False}, Fault.OTHER_REPORT),
        ({"provenance": None}, Fault.DAMAGED_REPORT),
    ],
)
def test_another_report_is_refused(report: Report, wrong: dict[str, Any], fault: Fault) -> None:
    folder = report(**wrong)
    with pytest.raises(ResultsError) as caught:
        read_scores(folder)
    assert (caught.value.place, caught.value.fault) == (folder, fault)


def test_a_folder_that_is_none_and_one_without_a_report(tmp_path: Path) -> None:
    for place, fault in ((tmp_path / "nowhere", Fault.NO_FOLDER), (tmp_path, Fault.NEITHER)):
        with pytest.raises(ResultsError) as caught:
            read_scores(place)
        assert (caught.value.place, caught.value.fault) == (place, fault)
